"""Why pictures differ from the references: what is measured in them, of pictures whose differences are known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import fidelity_causes
from benchmarks.encodings import coded_as, shown


def disc(x: float, y: float, radius: float, size: int = 96) -> np.ndarray:
    """The coverage of a disc, blurred over eight pixels. (0, 0) is the middle of the picture."""
    at = np.arange(size) - (size - 1) / 2
    return np.clip((radius - np.hypot(at[None] - x, at[:, None] - y)) / 8 + 0.5, 0, 1).astype(np.float32)


def test_shift_is_that_of_the_silhouette() -> None:
    rgb = np.zeros((96, 96, 3))
    ours, moved = disc(0, 0, 30), disc(0.2, -0.1, 30 * 1.004)
    assert fidelity_causes._shift((rgb, moved), (rgb, ours)) == pytest.approx([0.2, -0.1, 0.4], abs=0.03)


@pytest.mark.parametrize("engine", ["vray", "dspbr-pt", "three-gpu-pathtracer"])
def test_light_of_another_encoding_is_the_same_multiple_at_all_levels(engine: str) -> None:
    ours = np.tile(np.geomspace(0.01, 0.6, 64)[None, :, None], (8, 1, 3)), np.ones((8, 64))
    theirs = coded_as(shown(ours[0] * 0.9, ours[1]), engine)
    assert fidelity_causes._multiple(theirs, engine, ours) == pytest.approx(0.9, abs=0.01)
