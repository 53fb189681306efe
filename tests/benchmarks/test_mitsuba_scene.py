"""Environments as Mitsuba reads them: its rows end at the poles, ours lie half a row away."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.mitsuba_scene import for_mitsuba, from_mitsuba

MAP = np.random.default_rng(0).gamma(0.5, 2.0, (12, 6, 3)).astype(np.float32)
V = np.linspace(0, 1, 1001)


def ours(radiance: np.ndarray) -> np.ndarray:
    """Down a column at `V`, the height from the top: texels have their centres half a row in, clamped at the poles."""
    return _between(radiance[:, 2, 1], V * len(radiance) - 0.5)


def mitsubas(radiance: np.ndarray) -> np.ndarray:
    return _between(radiance[:, 2, 1], V * (len(radiance) - 1))


def _between(column: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.interp(y, np.arange(len(column)), column)


def test_mitsuba_sees_what_we_see():
    assert mitsubas(for_mitsuba(MAP)) == pytest.approx(ours(MAP), abs=1e-5)


def test_we_see_what_mitsuba_sees_but_for_the_tips():
    difference = np.abs(ours(from_mitsuba(MAP)) - mitsubas(MAP))
    assert np.median(difference) < 1e-5
    assert difference.max() < 0.13 * MAP.max()
    assert np.abs(ours(from_mitsuba(MAP, 64)) - mitsubas(MAP)).max() < 0.01 * MAP.max()
    assert ours(from_mitsuba(MAP)).mean() == pytest.approx(mitsubas(MAP).mean(), rel=2e-3)
