"""The ray under the cursor and what it meets."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.interact.pick import box_intervals, pick, plane_point
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene

SIZE = (320, 240)


def quad(z: float = 0.0, **kwargs) -> Mesh:
    """Two triangles over [-1, 1]^2, facing +Z."""
    positions = np.array([[-1, -1, z], [1, -1, z], [1, 1, z], [-1, 1, z]], np.float32)
    return Mesh("quad", positions, 0, indices=np.array([0, 1, 2, 0, 2, 3], np.uint32), **kwargs)


def scene_of(*transforms, double_sided: bool = False) -> Scene:
    instances = tuple(Instance(0, np.asarray(t, np.float64)) for t in transforms)
    return Scene("s", (quad(),), (Material(double_sided=double_sided),), instances)


def moved(x=0.0, y=0.0, z=0.0, scale=(1.0, 1.0, 1.0)) -> np.ndarray:
    matrix = np.diag([*scale, 1.0])
    matrix[:3, 3] = x, y, z
    return matrix


FRONT = Camera.look_at([0, 0, 5], [0, 0, 0])


def cursor_of(camera: Camera, point) -> tuple[float, float]:
    clip = camera.projection(SIZE[0] / SIZE[1], 0.1, 100) @ camera.view() @ np.append(point, 1.0)
    x, y = clip[:2] / clip[3]
    return (x + 1) / 2 * SIZE[0], (1 - y) / 2 * SIZE[1]


@pytest.mark.parametrize("point", [(0, 0, 0), (0.5, -0.3, 0), (-0.99, 0.99, 0)])
@pytest.mark.parametrize("height", [None, 4.0])
def test_the_point_under_the_cursor(point, height):
    camera = Camera(FRONT.pose, FRONT.fov_y, height)
    assert np.allclose(pick(scene_of(np.eye(4)), camera, SIZE, cursor_of(camera, point)), point, atol=1e-12)


def test_beside_it_is_nothing():
    assert pick(scene_of(np.eye(4)), FRONT, SIZE, cursor_of(FRONT, (1.01, 0, 0))) is None


def test_the_nearest_of_several_instances():
    scene = scene_of(moved(z=-3), moved(z=1), moved(z=-1))
    assert pick(scene, FRONT, SIZE, (160, 120))[2] == pytest.approx(1, abs=1e-12)


def test_a_back_side_is_hit_only_where_it_is_drawn():
    behind = Camera.look_at([0, 0, -5], [0, 0, 0])
    assert pick(scene_of(np.eye(4)), behind, SIZE, (160, 120)) is None
    assert pick(scene_of(np.eye(4), double_sided=True), behind, SIZE, (160, 120)) is not None
    # A mirrored instance shows the other side of its triangles to the same place (glTF 2.0, section 3.7.4).
    mirrored = scene_of(moved(scale=(1, 1, -1)))
    assert pick(mirrored, behind, SIZE, (160, 120)) is not None
    assert pick(mirrored, FRONT, SIZE, (160, 120)) is None


def test_what_lies_behind_the_eye_is_seen_by_an_orthographic_camera_only():
    scene = scene_of(moved(z=9))
    assert pick(scene, FRONT, SIZE, (160, 120)) is None
    assert pick(scene, Camera(FRONT.pose, FRONT.fov_y, 4.0), SIZE, (160, 120))[2] == pytest.approx(9)


@pytest.mark.parametrize("size", [1e-7, 1e9])
def test_every_size_of_scene(size):
    camera = Camera.look_at([0, 0, 5 * size], [0, 0, 0])
    hit = pick(scene_of(moved(scale=(size,) * 3)), camera, SIZE, cursor_of(FRONT, (0.5, 0.25, 0)))
    assert np.allclose(hit / size, [0.5, 0.25, 0], atol=1e-9)


def test_a_flattened_instance_is_passed_over():
    assert pick(scene_of(moved(scale=(1, 1, 0))), FRONT, SIZE, (160, 120)) is None


def test_a_mesh_agrees_with_the_triangles_one_by_one():
    random = np.random.default_rng(7)
    positions = random.normal(size=(60, 3)).astype(np.float32)
    indices = random.integers(0, 60, 300).astype(np.uint32)
    whole = Scene("s", (Mesh("m", positions, 0, indices=indices),), (Material(double_sided=True),),
                  (Instance(0, np.eye(4)),))
    singles = [Scene("s", (Mesh("m", positions, 0, indices=indices[k:k + 3]),), whole.materials, whole.instances)
               for k in range(0, 300, 3)]
    for cursor in random.uniform((80, 60), (240, 180), (12, 2)):
        hits = [h for h in (pick(s, FRONT, SIZE, cursor) for s in singles) if h is not None]
        found = pick(whole, FRONT, SIZE, cursor)
        assert (found is None) == (not hits)
        if hits:
            assert found[2] == pytest.approx(max(h[2] for h in hits), abs=1e-12)


def test_where_nothing_is_the_cursor_means_a_plane():
    point = plane_point(FRONT, SIZE, (200, 90), 3.0)
    assert (point - FRONT.eye) @ FRONT.forward == pytest.approx(3.0)
    assert np.allclose(cursor_of(FRONT, point), (200, 90))


def test_a_ray_in_the_plane_of_a_box_side():
    boxes = np.array([[[0.0, 0, 0], [1, 1, 1]], [[5.0, 0, 0], [6, 1, 1]]])
    enter, leave = box_intervals(boxes, np.array([0.0, 0.5, -1]), np.array([0.0, 0, 1]))
    assert enter[0] == pytest.approx(1) and leave[0] == pytest.approx(2)
    assert enter[1] > leave[1]
