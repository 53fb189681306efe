"""Traced rays of the raster in scenes whose media scatter: they know extinction alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, moved, orthographic, plate, scene, sphere

from viewer.gpu.context import Context
from viewer.raster.renderer import Renderer
from viewer.scene.material import Material
from viewer.settings import Settings


@pytest.mark.parametrize("ior", [1.0, 1.4])
@pytest.mark.parametrize("effect", ["refraction", "reflections"])
def test_traced_rays_take_scattering_for_absorption(context: Context, effect: str, ior: float) -> None:
    wax = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=ior,
                   attenuation_distance=0.5, attenuation_color=(0.8, 0.5, 0.3), scatter_color=(0.9, 0.8, 0.7))
    mirror = Material(perceptual_roughness=0.1)
    model = scene(sphere(0, 12), (plate(1, half=2.0), moved((0, 0, -1.5))), materials=[wax, mirror],
                  environment=constant())
    absorbing = replace(model, materials=(replace(wax, scatter_color=(0.0, 0.0, 0.0)), mirror))
    renderer = Renderer(context)
    settings = Settings.of(subsurface="off", **{effect: "traced"})
    # The light that reflections see is baked at vertices, by paths that do know scattering, and so is another.
    pictures = [renderer.render(shown, orthographic(0.4, 0.3, height=3.0), settings, (32, 32)).linear
                for shown in (model, absorbing)[: 1 if effect == "reflections" else 2]]
    renderer.release()
    assert np.isfinite(pictures).all() and np.ptp(pictures[0][..., :3]) > 0.05
    assert np.array_equal(pictures[0], pictures[-1])
