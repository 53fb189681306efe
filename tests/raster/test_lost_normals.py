"""Normals of length 0 at vertices, and such as cancel between them: the triangle's own stands in for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, facing_floor, moved, orthographic, plate, scene

from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene

SMOOTH = Material(metallic=0.0, perceptual_roughness=0.4, double_sided=True)
LAMPS = (Light("directional", intensity=2.0, direction=(-0.3, -1, -0.4)),
         Light("point", intensity=3.0, position=(-0.5, 1.0, 1.0)))
CAMERA = Camera.look_at((0.3, 1.5, 2.5), (0, 0, 0), fov_y=0.8)


def standing(mesh: Mesh) -> Scene:
    """On the floor, seen from the front; mirrored and seen from the front; and seen from behind."""
    return scene((mesh, facing_floor(0.6, -0.3)), (mesh, moved((-0.6, 0.4, 0), (-0.3, 0.3, 1))),
                 (mesh, moved((0.6, 0.4, 0), (0.3, 0.3, -1)) @ np.diag([-1.0, 1, 1, 1])), materials=[SMOOTH],
                 lights=LAMPS, environment=constant(0.3))


@pytest.mark.parametrize("antialias", ["none", "deferred-4"])
@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_normals_of_no_length_are_those_of_the_triangles(radiance, mode, antialias):
    flat = plate()
    lost = replace(flat, normals=np.zeros_like(flat.normals))
    right, picture = (radiance(standing(mesh), CAMERA, mode=mode, antialias=antialias) for mesh in (flat, lost))
    assert np.abs(picture - right).max() < 1e-3 * right.max()


@pytest.mark.parametrize("antialias", ["none", "deferred-4"])
def test_normals_that_cancel_are_those_of_the_triangles(radiance, antialias):
    """Between upper and lower vertices they are exactly 0 in the row of pixels at the middle, or tiny by rounding."""
    flat = plate()
    opposite = replace(flat, normals=flat.normals * np.float32([1, 1, -1, -1])[:, None])
    row, right = (radiance(scene(mesh, lights=LAMPS), orthographic(), (33, 33), antialias=antialias)[16]
                  for mesh in (opposite, flat))
    error = np.abs(row - right).max(axis=-1)
    assert (error < 1e-4 * right.max()).any(), error  # elsewhere the tiny ones face away from the lamps
