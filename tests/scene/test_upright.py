"""Scenes that are turned so that another axis points upwards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import moved, plate, scene, sphere
from test_curves import curves
from test_gltf_curves import animated, lines
from test_pose import family, skinned

from viewer.errors import UsageError
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.upright import up_matrix, upright
from viewer.scene.volume import Volume

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "-x": (-1, 0, 0), "-y": (0, -1, 0), "-z": (0, 0, -1)}


@pytest.mark.parametrize("up", AXES)
def test_the_axis_becomes_y_by_a_turn_of_whole_numbers(up):
    matrix = up_matrix(up)
    np.testing.assert_array_equal(matrix[:3, :3] @ AXES[up], (0, 1, 0))
    np.testing.assert_array_equal(matrix @ matrix.T, np.eye(4))
    assert np.linalg.det(matrix) == 1 and np.isin(matrix, (-1, 0, 1)).all()


def test_z_up_keeps_what_is_right_and_puts_the_front_of_cad_in_front():
    turn = up_matrix("z")[:3, :3]
    assert (turn @ (1, 0, 0)).tolist() == [1, 0, 0] and (turn @ (0, -1, 0)).tolist() == [0, 0, 1]


def test_everything_turns_alike():
    model = scene(sphere(segments=8), (plate(), moved((0, 0, 3), (1, 2, 3))),
                  lights=(Light("spot", position=(0, 1, 5), direction=(0, 0, -1)),))
    eye = Camera.look_at((1, 2, 9), (0, 0, 1), (0, 0, 1))
    model = replace(model, cameras=(eye,), volumes=(Volume.in_box(np.ones((2, 3, 4)), [[0, 0, 0], [1, 2, 4]]),),
                    curves=(curves(),))
    turned, matrix = upright(model, "z"), up_matrix("z")
    def vectors(of: Scene) -> list[np.ndarray]:
        light = of.lights[0]
        return [of.corners, of.volume_corners, of.curves[0].points, of.cameras[0].eye, of.cameras[0].forward,
                np.array(light.position), np.array(light.direction)]

    for before, after in zip(vectors(model), vectors(turned), strict=True):
        np.testing.assert_array_equal(before @ matrix[:3, :3].T, after)
    assert turned.environment is model.environment and turned.radius == pytest.approx(model.radius)


def vertices(model: Scene) -> np.ndarray:
    """All vertices and points of curves in the world, (N, 3)."""
    return np.concatenate([*(model.meshes[i.mesh].positions @ i.transform[:3, :3].T + i.transform[:3, 3]
                             for i in model.instances), *(each.points for each in model.curves)])


def growing() -> Scene:
    return animated(lines(3), 0, "scale", [[1, 1, 1], [3, 2, 1]]).load()


@pytest.mark.parametrize("time", [None, 0.0, 0.4, 1.0])
@pytest.mark.parametrize("make", [family, skinned, growing])
def test_animations_move_as_before(make, time):
    model, turned, turn = make(), upright(make(), "-x"), up_matrix("-x")[:3, :3]
    if time is not None:
        model, turned = model.at(time), turned.at(time)
    np.testing.assert_allclose(vertices(turned), vertices(model) @ turn.T, atol=1e-6)


def test_a_scene_that_stands_upright_is_left_alone_and_other_words_are_refused():
    model = Scene("")
    assert upright(model, "y") is model
    with pytest.raises(UsageError, match="up='Z': it must be one of x, y, z, -x, -y, -z"):
        upright(model, "Z")
