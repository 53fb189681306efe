"""shaders/trace/camera.glsl against the framing of viewer/scene/frame.py in float64."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate

from viewer.gpu.programs import set_uniform
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.scene import Scene
from viewer.trace.paths.camera_rays import camera_uniforms

SIZE = (640, 480)
SCENE = Scene("empty")  # its bounds are a unit cube around the origin
PIXELS = np.random.default_rng(3).uniform(0, SIZE, (2000, 2)).astype(np.float32)


def uniforms(camera: Camera, size=SIZE):
    def bind(program) -> None:
        for name, value in camera_uniforms(SCENE, camera, size).items():
            set_uniform(program, name, value)
    return bind


def rays(context, tmp_path, camera: Camera, pixels: np.ndarray = PIXELS, size=SIZE) -> tuple[np.ndarray, np.ndarray]:
    found = evaluate(context, tmp_path, "trace/camera.glsl", "vec3 p, d; camera_ray(f0.xy, p, d);"
                     "o0 = vec4(p, 0.0); o1 = vec4(d, 0.0);", pixels, 2, {"HAS_FOG": 0},
                     uniforms(camera, size))
    return found[:, 0, :3], found[:, 1, :3]


def pixel_of(camera: Camera, points: np.ndarray, size=SIZE) -> np.ndarray:
    """The pixel coordinates of points in tracer space, float64."""
    frame = Frame(SCENE, camera, size)
    relative = points - (camera.eye - SCENE.center) / SCENE.radius
    across = relative @ camera.pose[:3, :2] * SCENE.radius
    if camera.height is None:
        across /= (relative @ camera.forward * SCENE.radius)[:, None] * np.tan(camera.fov_y / 2)
    else:
        across /= camera.height / 2
    return (across / (frame.aspect, 1) + 1) / 2 * size


@pytest.mark.parametrize("distance", [1e-3, 0.5, 3.0, 10.0, 1e3, 1e6])
@pytest.mark.parametrize("is_flat", [False, True])
def test_rays_are_in_their_pixels(context, tmp_path, distance, is_flat):
    """Points 1/4 to 4 units along each ray (5 to 8 for near eyes) project to within 1e-3 pixel of the ray's pixel."""
    fov = 2 * np.arctan(1.2 / max(distance, 2.0))
    camera = Camera.orbit((0.01, 0.02, -0.03), distance, 0.7, 0.4, fov)
    if is_flat:
        camera = Camera(camera.pose, height=2.2)
    o, d = rays(context, tmp_path, camera)
    assert np.abs(np.linalg.norm(d, axis=1) - 1).max() < 1e-6
    assert (np.linalg.norm(o, axis=1) < 4).all()
    for t in (0.25, 2.0, 4.0):
        assert np.abs(pixel_of(camera, o + t * d) - PIXELS).max() < 1e-3
    # No point with |p| <= 1 that is in front of the eye is behind the ray's origin.
    entry = -(o * d).sum(axis=1) - np.sqrt(np.maximum((o * d).sum(axis=1) ** 2 - (o * o).sum(axis=1) + 1, 0))
    eye = (camera.eye - SCENE.center) / SCENE.radius
    at_eye = np.linalg.norm(o - eye, axis=1) < 1e-6
    assert ((entry > 0) | at_eye).all()
    if not is_flat:
        assert ((o - eye) @ camera.forward > -1e-6).all()


def test_turned_away(context, tmp_path):
    """The rays of a far eye that looks away from the scene miss the scene, and their directions are exact."""
    camera = Camera.look_at((1e6, 0, 0), (2e6, 1e5, 0))
    o, d = rays(context, tmp_path, camera)
    assert (np.linalg.norm(o, axis=1) > 1e5).all() and ((o * d).sum(axis=1) > 0).all()


@pytest.mark.parametrize("is_flat", [False, True])
def test_same_framing_as_raster(context, tmp_path, is_flat):
    """The picture's corners, upright: x to the right, y up."""
    camera = Camera.look_at((0, 0, 5), (0, 0, 0))
    if is_flat:
        camera = Camera(camera.pose, height=4.0)
    corners = np.array([[0, 0], [SIZE[0], 0], [0, SIZE[1]], SIZE], np.float32)
    o, d = rays(context, tmp_path, camera, corners)
    ndc = corners / SIZE * 2 - 1
    expected = np.c_[ndc, np.ones(4)] @ Frame(SCENE, camera, SIZE).ray.T
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.abs(d - expected).max() < 1e-6
    if is_flat:
        assert np.allclose(o[:, :2] * SCENE.radius, ndc * (2 * SIZE[0] / SIZE[1], 2), atol=1e-5)


@pytest.mark.parametrize("distance", [0.5, 30.0, 1e6])
def test_distance(context, tmp_path, distance):
    """camera_distance in world units, to a part in 1e6."""
    camera = Camera.orbit((0, 0, 0), distance, 0.7, 0.4)
    points = np.random.default_rng(1).normal(size=(100, 3)).astype(np.float32)
    for chosen in (camera, Camera(camera.pose, height=2.0)):
        found = evaluate(context, tmp_path, "trace/camera.glsl", "o0 = vec4(camera_distance(f0.xyz));", points,
                         switches={"HAS_FOG": 0},
                         bind=uniforms(chosen))[:, 0, 0]
        relative = points * SCENE.radius - camera.eye
        expected = np.linalg.norm(relative, axis=1) if chosen.height is None else relative @ camera.forward
        assert np.abs(found - expected).max() < 1e-6 * max(distance, 3.0)
