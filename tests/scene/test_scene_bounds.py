"""The box and the sphere that frame a scene."""

import numpy as np
import pytest
from shapes import moved, plate, scene, sphere

from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene


def test_what_a_scale_of_0_shrinks_to_a_point_frames_nothing():
    alone = scene(sphere(segments=24))
    model = scene(sphere(segments=24), (sphere(segments=12), moved((100, 200, 300), 0.0)))
    np.testing.assert_array_equal(model.bounds, alone.bounds)
    assert model.radius == alone.radius


def test_what_is_flattened_or_a_point_counts():
    flat = scene(sphere(segments=24), (plate(0), moved((100, 0, 0), (0, 1, 1))))
    point = Mesh("point", np.float32([[100, 0, 0]]), 0, topology="points")
    assert flat.bounds[1, 0] == 100 and scene(sphere(segments=24), point).bounds[1, 0] == 100
    assert flat.radius == pytest.approx(50.5, rel=0.02)


def test_a_scene_of_nothing_but_shrunken_things_has_a_box_all_the_same():
    model = scene((sphere(segments=12), moved((1, 2, 3), 0.0)))
    np.testing.assert_array_equal(model.bounds, [[1, 2, 3], [1, 2, 3]])
    assert 0 < model.radius < 1e-3 and Scene("empty").radius > 0
