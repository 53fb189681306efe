"""Reports of volumes: which pixels are compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, moved, orthographic, plate, scene

from viewer.measure.report.bench import Bench
from viewer.scene.volume import Volume
from viewer.settings import Settings

CUBE = Volume.in_box(np.ones((2, 2, 2), np.float32), [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]])


@pytest.mark.parametrize("density, expected", [(1e4, 1.0), (1.0, 1.0), (0.0, 0.0)])
def test_pixels_of_volumes_and_surfaces_are_compared(context, density, expected):
    """In a medium of optical depth 1, 16 paths of a pixel pass once in ten million times."""
    model = replace(scene((plate(half=0.25), moved((-0.75, 0.75, 0))), environment=constant()), volumes=(CUBE,))
    bench = Bench(context, model, orthographic(), Settings.of(volume_density=density), (16, 16))
    mask = bench.coverage()
    bench.release()
    expected_mask = np.zeros((16, 16))
    expected_mask[4:12, 4:12], expected_mask[:4, :4] = expected, 1.0
    assert np.array_equal(mask, expected_mask)
