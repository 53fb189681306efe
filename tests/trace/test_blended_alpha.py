"""The alpha of blended surfaces that stand behind each other, in a path-traced picture without a background."""

from __future__ import annotations

import numpy as np
import pytest
from shapes import moved, orthographic, plate, scene

from viewer.scene.material import Material
from viewer.settings import Settings


@pytest.mark.parametrize("count", [1, 3])
def test_alpha_has_no_more_noise_of_several_surfaces(tracer, count):
    """One number of a sample decides at all of them, and is spread evenly over the samples. Independent numbers would
    have five times the noise."""
    material = Material(unlit=True, alpha_mode="blend", base_color=(1, 1, 1, 0.4))
    model = scene(*[(plate(), moved((0, 0, -0.3 * k))) for k in range(count)], materials=[material])
    settings = Settings.of(mode="path", spp=64, background="none")
    picture = tracer.render(model, orthographic(height=1.8), settings, (16, 16))
    noise = picture.linear[..., 3] - (1 - 0.6**count)
    assert abs(noise.mean()) < 2e-3
    assert np.sqrt(np.mean(noise**2)) < 0.012
