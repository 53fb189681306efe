"""What shaders read of the albedos of stretched lobes, by viewer/bake/stretched.py."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.dfg import dfg_albedos
from viewer.bake.stretched import SIZE, correlated_albedo, interpolated, seen_slopes, stretched_levels
from viewer.gpu.call import call_glsl

ALBEDOS, MEANS = stretched_levels("smith")


def read(function: str, **arrays: np.ndarray) -> np.ndarray:
    return call_glsl("light/stretched_dfg.glsl", function, table=(dfg_albedos("ggx", "smith"), ALBEDOS, MEANS),
                     **arrays)


def views(count: int) -> tuple[np.ndarray, ...]:
    """alpha_t, alpha_b, azimuth and NoV as glTF has them: any roughness, strength and view from 1 degree on."""
    rng = np.random.default_rng(4)
    alpha_b = rng.uniform(0.045, 1, count) ** 2
    alpha_t = alpha_b + (1 - alpha_b) * rng.uniform(0, 1, count) ** 2
    return alpha_t, alpha_b, rng.uniform(0, np.pi, count), np.sin(rng.uniform(np.pi / 180, np.pi / 2, count))


def test_the_albedo_of_any_stretched_lobe():
    """And nearly never more than there is, or a white furnace gained."""
    alpha_t, alpha_b, azimuth, NoV = views(1500)
    exact = correlated_albedo("smith", *seen_slopes(alpha_t, alpha_b, azimuth), NoV, 40)
    w = np.stack([np.sqrt(1 - NoV**2) * np.cos(azimuth), np.sqrt(1 - NoV**2) * np.sin(azimuth), NoV], axis=-1)
    found = read("stretched_albedo", alpha=np.stack([alpha_t, alpha_b], axis=-1), w=w)
    assert np.abs(found.sum(axis=1) - exact.sum(axis=1)).max() < 4e-3
    assert np.abs(found - exact).max() < 6e-3
    assert found.min() >= 0 and found.sum(axis=1).max() < 1.001


def test_the_means_are_those_of_what_shaders_read():
    """Over azimuths and cosines, for lobes between the nodes."""
    alpha_t, alpha_b = (kind[:40] for kind in views(40)[:2])
    x, weight = np.polynomial.legendre.leggauss(64)
    mu, phi = ((x + 1) / 2)[:, None], (np.arange(24) + 0.5) / 24 * np.pi / 2
    s = np.sqrt(1 - mu**2)
    w = np.stack([s * np.cos(phi), s * np.sin(phi), mu + 0 * phi], axis=-1)
    alphas = np.stack([alpha_t, alpha_b], axis=-1)
    read_all = read("stretched_albedo", alpha=alphas[:, None, None], w=w[None])
    expected = np.einsum("i,nijc->nc", weight * mu[:, 0], read_all) / len(phi)
    assert read("stretched_mean", alpha=alphas) == pytest.approx(expected, abs=1e-3)


def test_the_lookup_that_means_are_made_with():
    alpha_t, alpha_b, azimuth, NoV = views(200)
    w = np.stack([np.sqrt(1 - NoV**2) * np.cos(azimuth), np.sqrt(1 - NoV**2) * np.sin(azimuth), NoV], axis=-1)
    cube = ALBEDOS.reshape(SIZE // 2, SIZE, 2, SIZE, 4).swapaxes(1, 2).reshape(SIZE, SIZE, SIZE, 4)
    by_python = interpolated("smith", cube, *seen_slopes(alpha_t, alpha_b, azimuth), NoV)
    found = read("stretched_albedo", alpha=np.stack([alpha_t, alpha_b], axis=-1), w=w)
    assert found == pytest.approx(by_python, abs=1e-3)
