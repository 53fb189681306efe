"""The orbit camera: what stays where, at the poles and at every size of scene."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapes import moved, scene, sphere

from viewer.interact.orbit import FARTHEST, NEAREST, QUARTER, OrbitController
from viewer.scene.camera import Camera, framing_distance
from viewer.scene.framing import MARGIN
from viewer.scene.scene import Scene

ASPECT = 4 / 3
SCALES = [1e-6, 1.0, 1e6]


def project(camera: Camera, point) -> np.ndarray:
    """Normalised device coordinates (x, y) of a world point."""
    clip = camera.projection(ASPECT, 1e-9, 1e12) @ camera.view() @ np.append(point, 1.0)
    return clip[:2] / clip[3]


@pytest.fixture(params=SCALES)
def orbit(request) -> OrbitController:
    return OrbitController(ball(request.param), ASPECT)


def ball(scale: float) -> Scene:
    return scene((sphere(segments=24), moved(np.array([3.0, -2.0, 5.0]) * scale, scale)))


@pytest.mark.parametrize("scale", SCALES)
def test_starts_as_the_camera_that_the_scene_fills(scale):
    model = ball(scale)
    orbit, expected = OrbitController(model, ASPECT), model.framing_camera(ASPECT)
    assert np.allclose(orbit.camera.pose[:3, :3], expected.pose[:3, :3], atol=1e-14)
    assert np.allclose(orbit.camera.eye, expected.eye, rtol=0, atol=1e-12 * orbit.distance)


@pytest.mark.parametrize("orthographic", [False, True])
def test_frame_all_fills_the_view_from_where_it_looks(orbit, orthographic):
    orbit.is_orthographic = orthographic
    orbit.orbit(0.3, 0.2)
    orbit.pan(0.4, 0.3)
    orbit.dolly(0.01)
    back = orbit.camera.pose[:3, 2]
    orbit.frame_all(ASPECT)
    assert np.allclose(orbit.camera.pose[:3, 2], back, atol=1e-12)
    assert abs((orbit.target - orbit.center) @ back) < 1e-9 * orbit.radius  # as deep as the centre: turns about it
    half = orbit.distance * math.tan(orbit.fov_y / 2)
    seen = orbit.radius / half if orthographic else math.tan(math.asin(orbit.radius / orbit.distance)) / half \
        * orbit.distance
    assert seen == pytest.approx(1 - 2 * MARGIN, rel=0.01)  # the ball has facets


def test_elevation_ends_at_the_poles_and_the_pose_stays_rigid(orbit):
    for dy in (0.3, 5.0, -0.01, -40.0):
        orbit.orbit(0.1, dy)
        rotation = orbit.camera.pose[:3, :3]
        assert abs(orbit.elevation) <= QUARTER
        assert np.allclose(rotation.T @ rotation, np.eye(3), atol=1e-14)
        assert np.linalg.det(rotation) == pytest.approx(1, abs=1e-13)
    assert orbit.elevation == -QUARTER


def test_right_stays_level_through_the_pole(orbit):
    orbit.orbit(0, 10)
    before = orbit.camera.pose[:3, 0].copy()
    orbit.orbit(0, -1e-3)
    assert np.allclose(orbit.camera.pose[:3, 0], before, atol=1e-12)


def test_orbit_keeps_target_and_distance(orbit):
    orbit.orbit(0.37, 0.21)
    assert np.allclose(project(orbit.camera, orbit.target), 0, atol=1e-6)
    assert np.linalg.norm(orbit.camera.eye - orbit.target) == pytest.approx(orbit.distance, rel=1e-12)


def test_the_scene_follows_the_hand(orbit):
    front = orbit.target + 0.5 * orbit.radius * orbit.camera.pose[:3, 2]
    orbit.orbit(0.05, 0.0)
    assert project(orbit.camera, front)[0] > 0.01
    orbit.orbit(-0.05, 0.05)
    assert project(orbit.camera, front)[1] < -0.01


@pytest.mark.parametrize("orthographic", [False, True])
def test_pan_keeps_what_is_under_the_hand(orbit, orthographic):
    orbit.is_orthographic = orthographic
    camera = orbit.camera
    depth = 0.7 * orbit.distance
    point = camera.eye + depth * camera.forward
    orbit.pan(0.1, 0.2, depth)
    # A window height is 2 in y and 2 / aspect in x.
    assert np.allclose(project(orbit.camera, point), [0.2 / ASPECT, -0.4], atol=1e-6)


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("factor", [0.5, 1.7])
def test_dolly_keeps_the_point_under_the_cursor(orbit, factor, orthographic):
    orbit.is_orthographic = orthographic
    point = orbit.target + orbit.radius * np.array([0.3, 0.5, -0.2])
    before, distance = project(orbit.camera, point), np.linalg.norm(orbit.camera.eye - point)
    orbit.dolly(factor, point)
    assert np.allclose(project(orbit.camera, point), before, atol=1e-6)
    assert np.linalg.norm(orbit.camera.eye - point) == pytest.approx(factor * distance, rel=1e-9)


def test_distance_is_bounded_relative_to_the_scene(orbit):
    framing = framing_distance(orbit.radius, 1.0, orbit.fov_y)
    orbit.dolly(1e-30)
    assert orbit.distance == pytest.approx(NEAREST * framing, rel=1e-12)
    orbit.dolly(1e30)
    assert orbit.distance == pytest.approx(FARTHEST * framing, rel=1e-12)
    for _ in range(50):
        orbit.pan(10, 10)
    assert np.linalg.norm(orbit.target - orbit.center) <= FARTHEST * framing * (1 + 1e-12)


def test_a_distance_beyond_the_bounds_is_not_pulled_in(orbit):
    orbit.follow(Camera.orbit(orbit.center, 1e3 * FARTHEST * orbit.radius), 1e3 * FARTHEST * orbit.radius)
    before = orbit.distance
    orbit.dolly(1.1)
    assert orbit.distance == before


@pytest.mark.parametrize("elevation", [-QUARTER, -0.4, 0.0, 1.2, QUARTER])
@pytest.mark.parametrize("roll", [0.0, 0.6, -2.5])
@pytest.mark.parametrize("height", [None, 3.0])
def test_follow_takes_a_camera_as_it_is(elevation, roll, height):
    pose = Camera.orbit([1, 2, 3], 4.0, 2.2, elevation).pose.copy()
    c, s = math.cos(roll), math.sin(roll)
    pose[:3, :2] = pose[:3, :2] @ np.array([[c, -s], [s, c]])
    orbit = OrbitController(ball(1.0), ASPECT)
    orbit.follow(Camera(pose, 0.6, height), depth=2.5)
    camera = orbit.camera
    assert np.allclose(camera.pose[:3, :3], pose[:3, :3], atol=1e-9)
    assert camera.fov_y == 0.6
    if height is None:
        assert np.allclose(camera.eye, pose[:3, 3], atol=1e-9) and camera.height is None
    else:
        assert camera.height == pytest.approx(height)
        across = np.cross(camera.eye - pose[:3, 3], camera.forward)  # along the view it may stand anywhere
        assert np.allclose(across, 0, atol=1e-9)


def test_orthographic_shows_the_target_at_the_same_size(orbit):
    point = orbit.target + 0.3 * orbit.radius * orbit.camera.pose[:3, 1]
    before = project(orbit.camera, point)
    orbit.is_orthographic = True
    assert np.allclose(project(orbit.camera, point), before, atol=1e-6)


def test_center_on_brings_the_point_to_the_middle_at_its_depth(orbit):
    point = orbit.target + orbit.radius * np.array([0.3, 0.5, -0.2])
    depth = (point - orbit.camera.eye) @ orbit.camera.forward
    forward = orbit.camera.forward
    orbit.center_on(point)
    assert np.allclose(project(orbit.camera, point), 0, atol=1e-6)
    assert orbit.distance == pytest.approx(depth, rel=1e-9)
    assert np.allclose(orbit.camera.forward, forward, atol=1e-12)


def test_inertia_dies_down(orbit):
    orbit.velocity = np.array([1.0, 0.0])
    azimuth, steps = orbit.azimuth, 0
    while orbit.coast(1 / 60):
        steps += 1
        assert steps < 200
    assert steps > 30
    # The integral of the speed is its time constant, in heights, up to the Euler steps.
    assert azimuth - orbit.azimuth == pytest.approx(math.pi * 0.35, rel=0.1)
    assert not orbit.velocity.any()
