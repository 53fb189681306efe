"""The path tracer gives the same picture with all its code compiled in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import lopsided

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.settings import Settings

SIZE = (16, 16)
SUN = Light.from_angles(0.5, 0.7, 2.0)
LIGHTS = {"environment": (lopsided, ()), "sun": (lambda: None, (SUN,)), "dark": (lambda: None, ())}
NAMES = ["unlit", "specular-ior", "two-sided", "emissive", "glass", "alpha", "textures"]


@pytest.mark.parametrize(("name", "light"), [(name, list(LIGHTS)[k % 3]) for k, name in enumerate(NAMES)])
def test_same_samples(tracer, name, light):
    """Each scene under one of the lights in turn. The random numbers are the same, so the pictures are equal except for
    rounding, which may redirect paths in a few pixels. An environment is seen behind one scene alone: behind the others
    it would make all programs of everything once more, which are the largest that there are."""
    environment, lights = LIGHTS[light]
    scene = viewer.load(resource_folder("assets") / "scenes" / f"{name}.glb", environment=None)
    scene = scene.relit(environment=environment(), lights=(*scene.lights, *lights))
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    settings = Settings(mode="path", spp=4, bounces=4, background="env" if name == "emissive" else "none")
    needed, all_on = (tracer.render(scene, camera, replace(settings, plan=plan), SIZE)
                      for plan in ("needed", "everything"))
    assert all_on.stats["plan"]["left_out"] == ["nothing, as requested"]
    difference = np.abs(needed.linear - all_on.linear) / (np.abs(needed.linear) + 1e-2)
    assert np.isfinite(all_on.linear).all() and (difference.max(axis=2) > 1e-3).mean() <= 0.02
    assert abs(needed.linear.mean() - all_on.linear.mean()) <= 0.01 * needed.linear.mean()
