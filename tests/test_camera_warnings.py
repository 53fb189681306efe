"""Warnings that follow from where the camera is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import scene, sphere

from viewer.plan.warnings import camera_warnings
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.settings import Settings


@pytest.mark.parametrize("scatters", [True, False])
def test_a_camera_inside_of_a_solid_that_scatters_is_warned_of(scatters):
    """Its box is not enough, nor is a pose without a place, and mode path shows the medium."""
    wax = Material("wax", metallic=0.0, transmission=1.0, thickness=1.0, attenuation_color=(0.5, 0.5, 0.5),
                   attenuation_distance=1.0, scatter_color=(0.8, 0.8, 0.8) if scatters else (0.0, 0.0, 0.0))
    place = np.diag([2.0, 2.0, -2.0, 1.0])
    place[:3, 3] = 5, 0, 0
    model = scene((sphere(segments=16), place), materials=[wax])

    def told(eye, settings: Settings, **more: float) -> list[str]:
        return camera_warnings(model, settings, replace(Camera.look_at(eye, (5, 0, -9)), **more))

    inside, corner = (5, 0, 1.5), (6.7, 1.7, 1.7)
    assert ["of material 'wax'" in line for line in told(inside, Settings())] == [True] * scatters
    assert told(corner, Settings()) == told((9, 0, 0), Settings()) == told(inside, Settings(mode="path")) == []
    assert told(inside, Settings(), height=1.0) == []
