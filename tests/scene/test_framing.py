"""The camera that a model fills, against the projection of every vertex."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shapes import moved, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.framing import MARGIN, NEAREST, fit
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene

FREE = 1 - 2 * MARGIN
VIEWS = [(0.0, 0.0), (0.5, 0.26), (-2.0, -1.2), (1.0, math.pi / 2)]


def points(array) -> Mesh:
    return Mesh("points", np.float32(array), 0, topology="points")


def projected(model: Scene, camera: Camera, aspect: float) -> np.ndarray:
    """The lowest and highest x and y of all drawn vertices, (2, 2) in normalised device coordinates."""
    found = []
    for instance in model.instances:
        mesh, matrix = model.meshes[instance.mesh], instance.transform
        drawn = mesh.positions[slice(None) if mesh.indices is None else mesh.indices].astype(float)
        local = (drawn @ matrix[:3, :3].T + matrix[:3, 3] - camera.eye) @ camera.pose[:3, :3]
        half = (-local[:, 2] * math.tan(camera.fov_y / 2) if camera.height is None
                else np.full(len(local), camera.height / 2))
        assert (half > 0).all(), "a vertex lies behind the eye"
        found.append(local[:, :2] / (half[:, None] * (aspect, 1)))
    return np.stack([np.concatenate(found).min(axis=0), np.concatenate(found).max(axis=0)])


def crowd(scale: float = 1.0, offset=(0.0, 0.0, 0.0)) -> Scene:
    """A cloud, and a turned and mirrored copy of it."""
    cloud = points(np.random.default_rng(5).normal(size=(300, 3)) * (3, 1, 0.4))
    turned = np.array([[0, 0, 2, 4], [0, -1, 0, 1], [1, 0, 0, -1], [0, 0, 0, 1]], float)
    place = moved(offset, scale)
    return scene((cloud, place), (cloud, place @ turned))


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("aspect", [0.4, 1.0, 16 / 9])
def test_the_model_fills_the_picture_in_one_axis_and_is_centred_in_the_other(view, aspect):
    model = crowd()
    low, high = projected(model, model.framing_camera(aspect, *view, fov_y=0.7), aspect)
    np.testing.assert_allclose(low, -high, atol=1e-6)
    assert high.max() == pytest.approx(FREE, abs=1e-6)


@pytest.mark.parametrize("scale, offset", [(1e-6, (0, 0, 0)), (1e6, (0, 0, 0)), (1.0, (4e5, 5e6, -300)),
                                           (1e-6, (1, 1, 1))])
def test_its_size_and_place_do_not_matter(scale, offset):
    seen = [projected(model, model.framing_camera(1.5), 1.5) for model in (crowd(), crowd(scale, offset))]
    np.testing.assert_allclose(*seen, atol=1e-5)


def test_only_what_is_drawn_counts():
    """Neither vertices that no triangle has, nor the box of a mesh, nor what a scale of 0 shrinks to a point."""
    ball = sphere(segments=24)
    stray = Mesh("stray", np.concatenate([ball.positions, [[90, 0, 0]]]), 0, indices=ball.indices)
    turned = Camera.orbit((0, 0, 0), 1.0, 0.7, 0.4).pose.copy()
    turned[:3, 3] = 0
    expected = scene(ball).framing_camera(1.0)
    model = scene((stray, turned), (plate(0), moved((0, 50, 0), 0.0)))
    np.testing.assert_allclose(model.framing_camera(1.0).eye, expected.eye, atol=0.02)


@pytest.mark.parametrize("view", VIEWS)
def test_a_target_stays_in_the_middle(view):
    model, target = crowd(), np.array([2.0, 1.0, -0.5])
    camera = model.framing_camera(1.3, *view, target=target)
    low, high = projected(model, camera, 1.3)
    assert max(-low.min(), high.max()) == pytest.approx(FREE, abs=1e-9)
    np.testing.assert_allclose(np.cross(target - camera.eye, camera.forward), 0, atol=1e-9)


@pytest.mark.parametrize("aspect", [0.4, 1.8])
def test_an_orthographic_view_is_filled_too(aspect):
    model = crowd()
    pose = model.framing_camera(aspect).pose.copy()
    target, distance = fit(model, pose[:3, :3], aspect, 0.9, is_orthographic=True)
    pose[:3, 3] = target + 100 * pose[:3, 2]
    low, high = projected(model, Camera(pose, height=2 * distance * math.tan(0.45)), aspect)
    np.testing.assert_allclose(low, -high, atol=1e-9)
    assert high.max() == pytest.approx(FREE, abs=1e-9)


@pytest.mark.parametrize("mesh", [
    points([[3, 2, 1]]), points([[0, 0, -1], [0, 0, 1]]), points([[-1, 0, 0], [1, 0, 0]]), plate(0),
    points([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
], ids=["point", "line along the view", "line across", "plane", "triangle"])
@pytest.mark.parametrize("view", [(0.0, 0.0), (math.pi / 2, 0.0), (math.pi / 4, 0.6155)])
def test_what_has_no_width_is_seen_from_a_distance(mesh, view):
    model = scene(mesh)
    camera = model.framing_camera(1.0, *view)
    high = projected(model, camera, 1.0)[1]
    depths = (mesh.positions - camera.eye) @ camera.forward
    assert high.max() <= FREE + 1e-9 and depths.min() >= NEAREST * model.radius * (1 - 1e-6)
    is_near = depths.min() == pytest.approx(NEAREST * model.radius, rel=1e-6)
    assert high.max() == pytest.approx(FREE, abs=1e-6) or is_near


def test_instances_that_only_a_translation_tells_apart_are_looked_at_once(monkeypatch):
    """Their boxes all promise more than their vertices keep, so that no box rules out another."""
    rng = np.random.default_rng(7)
    cloud = points(rng.normal(size=(50, 3)))
    places = [moved(offset, scale) @ turn for offset in rng.uniform(-1e-3, 1e-3, (40, 3)) for scale in (1.0, 0.99)
              for turn in (np.eye(4), np.diag([-1.0, 1.0, 1.0, 1.0]))]
    many = replace(scene(cloud), instances=tuple(Instance(0, place) for place in places))
    vertices = np.concatenate([cloud.positions @ place[:3, :3].T + place[:3, 3] for place in places]) - many.center
    looked_at = []
    monkeypatch.setattr(Mesh, "drawn_chunks", lambda mesh: looked_at.append(mesh) or [mesh.positions])
    for direction in rng.normal(size=(5, 3)):
        np.testing.assert_allclose(many.farthest(direction), vertices[(vertices @ direction).argmax()], atol=1e-9)
    assert 5 <= len(looked_at) <= 5 * 4


def test_a_scene_of_nothing_has_a_camera():
    assert np.isfinite(Scene("empty").framing_camera(1.0).pose).all()


@pytest.mark.parametrize("height", [None, 2.0])
def test_fewer_pixels_show_the_same_view(height):
    """Each point is at the same place of the picture, though 7 x 4 pixels are not as wide as 1281 x 719."""
    model, camera = scene(sphere(segments=8)), replace(Camera.orbit((0, 0, 0), 4.0, 0.5, 0.3), height=height)
    whole = Frame(model, camera, (1281, 719))
    coarse = whole.within(28)
    assert coarse.size == (7, 4) and whole.within(1281 * 719) is whole
    assert np.array_equal(coarse.view_projection, whole.view_projection) and np.array_equal(coarse.ray, whole.ray)
    assert np.array_equal(coarse.within(6).view_projection, whole.view_projection)
    assert Frame(model, camera, (10_000, 1)).within(100).size == (1000, 1)


def test_pixels_across_are_those_of_the_scenes_sphere():
    ball = scene(sphere())
    radius, size = ball.radius, (100, 200)
    flat = replace(Camera.look_at((0, 0, 5), (0, 0, 0)), height=radius * 4)
    deep = Camera.look_at((0, 0, radius * 4), (0, 0, 0), fov_y=2 * math.atan(0.5))
    inside = Camera.look_at((0, 0, radius * 0.9), (0, 0, 0))
    found = [Frame(ball, camera, size).pixels_across for camera in (flat, deep, inside)]
    assert found == pytest.approx([100, 100, math.inf])
