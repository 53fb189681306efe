"""Pictures by calibrated and by orthographic cameras: where an edge lies, in both renderers, against float64."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import plate, scene

from viewer.scene.camera import Camera
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings

SIZE = (48, 32)
CALIBRATED = Camera.from_intrinsics(Camera.look_at((0.5, -0.6, 3.0), (0.1, 0.3, 0.0), (0.3, 1.0, 0.0)).pose,
                                    50.0, 36.0, 17.3, 20.6, SIZE)
LENSES = {"calibrated": CALIBRATED,
          "principal point outside": Camera.from_intrinsics(Camera.look_at((0.0, 0.0, 3.0), (-1.8, 0.0, 0.0)).pose,
                                                            40.0, 40.0, -6.4, 15.2, SIZE),
          "orthographic": replace(CALIBRATED, height=3.1),
          "orthographic, seen from exactly above": replace(Camera.look_at((0, 5, 0), (0, 0, 0)), height=2.9,
                                                           principal=(0.4, 0.6))}


def placed(camera: Camera, scale: float) -> tuple[Scene, Camera]:
    """A plate before the camera, `scale` times as large, and far from the origin."""
    turn = np.eye(4)
    if abs(camera.forward[1]) > 0.9:  # the plate faces +Z; lay it down
        turn[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    grow, offset = np.diag([scale, scale, scale, 1.0]), np.eye(4)
    offset[:3, 3] = scale * np.array([30.0, -20.0, 10.0])
    model = scene(plate())
    model = replace(model, instances=(Instance(0, offset @ grow @ turn),))
    pose = camera.pose.copy()
    pose[:3, 3] = offset[:3, 3] + scale * camera.eye
    return model, replace(camera, pose=pose, height=None if camera.height is None else scale * camera.height)


def inside(model: Scene, camera: Camera, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Whether the pixel coordinates (x, y), from the upper left corner, see the plate: the pinhole equations, inverted,
    and the ray's meeting with the plate in the plate's own coordinates."""
    fx, fy, cx, cy = camera.intrinsics(SIZE)
    right, up, back, eye = camera.pose[:3].T
    across = ((x - cx) / fx)[..., None] * right - ((y - cy) / fy)[..., None] * up
    origin, along = (eye, across - back) if camera.height is None else (eye + across, -back + 0 * across)
    inverse = np.linalg.inv(model.instances[0].transform)
    origin, along = origin @ inverse[:3, :3].T + inverse[:3, 3], along @ inverse[:3, :3].T
    met = origin - (origin[..., 2] / along[..., 2])[..., None] * along
    return (np.abs(met[..., :2]) < 1).all(axis=-1)


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("name", LENSES)
def test_edges_are_where_the_pinhole_equations_say(renderer, tracer, name, scale):
    model, camera = placed(LENSES[name], scale)
    y, x = np.mgrid[0:SIZE[1] + 1, 0:SIZE[0] + 1].astype(float)
    corners = inside(model, camera, x, y)
    near = np.stack([inside(model, camera, x[:-1, :-1] + 0.5 + dx, y[:-1, :-1] + 0.5 + dy)
                     for dx in (-1e-3, 1e-3) for dy in (-1e-3, 1e-3)])
    certain, seen = (near == near[0]).all(axis=0), near[0]
    assert 0.1 < seen.mean() < 0.9 and (~certain).sum() < 5

    raster = renderer.render(model, camera, Settings.of(background="none", antialias="none"), SIZE).linear[..., 3]
    np.testing.assert_array_equal(raster[certain] == 1, seen[certain])
    if scale == 1.0:
        path = tracer.render(model, camera, Settings.of(mode="path", background="none", spp=4), SIZE).linear[..., 3]
        four = np.stack([corners[:-1, :-1], corners[1:, :-1], corners[:-1, 1:], corners[1:, 1:]])
        assert (path[four.all(axis=0)] == 1).all() and (path[~four.any(axis=0)] == 0).all()
        assert ((path > 0) & (path < 1)).any()
