"""The order and the layers of transmissive surfaces, so that each shows what is behind it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import moved, orthographic, plate, scene, sphere

from viewer.plan.glass_walls import MOST_WALLS
from viewer.plan.model import Plan
from viewer.plan.planner import plan_scene
from viewer.raster.walls import MOST_LAYERS, layers_of
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.material import Material
from viewer.settings import Settings

GLASS = Material(metallic=0.0, transmission=1.0)
WALL = replace(GLASS, double_sided=True)
CAMERAS = orthographic(height=8.0), Camera.look_at((0, 0, 20), (0, 0, 0))


def planned(camera, model) -> Plan:
    return plan_scene(model, Settings(), (), samples=1, half_target=False, orthographic=camera.height is not None)


def found(camera, *meshes, material=WALL) -> list[list[tuple[int, str]]]:
    model = scene(*meshes, materials=[material])
    plan = planned(camera, model)
    layers = layers_of([draw for draw in plan.draws if draw.transmits], Frame(model, camera, (64, 64)))
    return [[(wall.draw.instance, wall.side) for wall in layer] for layer in layers]


@pytest.mark.parametrize("camera", CAMERAS)
def test_what_stands_side_by_side_shares_its_layers(camera):
    assert found(camera) == []
    pair = [(plate(), moved((x, 0, x))) for x in (-2, 2)]
    assert found(camera, *pair) == [[(0, "all"), (1, "all")]]
    balls = [(sphere(), moved((x, 0, 0))) for x in (-2, 2)]
    assert found(camera, *balls) == [[(0, "back"), (1, "back")], [(0, "front"), (1, "front")]]


@pytest.mark.parametrize("camera", CAMERAS)
def test_outlines_and_not_boxes_decide_what_overlaps(camera):
    pair = [(sphere(), np.eye(4)), (sphere(), moved((1.5, 1.5, 0)))]
    assert len(found(camera, *pair)) == 2
    assert len(found(camera, pair[0], (sphere(), moved((1.3, 1.3, 0))))) == 4


@pytest.mark.parametrize("camera", CAMERAS)
def test_what_is_behind_comes_first(camera):
    panes = [(plate(), moved((0, 0, z))) for z in (1, -1, 0)]
    assert found(camera, *panes) == [[(1, "all")], [(2, "all")], [(0, "all")]]
    nested = [(sphere(), np.eye(4)), (sphere(), moved((0, 0, 0), 0.5))]
    assert found(camera, *nested) == [[(0, "back")], [(1, "back")], [(1, "front")], [(0, "front")]]


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("material", [GLASS, replace(WALL, thickness=0.1)])
def test_only_walls_with_two_sides_are_drawn_twice(camera, material):
    assert found(camera, sphere(), material=material) == [[(0, "all")]]


def test_what_reaches_behind_the_camera_may_cover_everything():
    camera = Camera.look_at((0, 0, 0.5), (0, 0, -1))
    assert len(found(camera, (sphere(), np.eye(4)), (plate(), moved((1, 0, -4))))) == 3


def test_the_farthest_share_the_first_layer_where_there_are_too_many():
    layers = found(CAMERAS[0], *[(plate(), moved((0, 0, 0.1 * k))) for k in range(MOST_LAYERS + 3)])
    assert [len(layer) for layer in layers] == [4] + [1] * (MOST_LAYERS - 1)
    many = [(plate(), moved((0, 0, 0.01 * k))) for k in range(MOST_WALLS + 1)]
    assert found(CAMERAS[0], *many)[1:] == []
    told = f"thin walls of glass behind others, where more than {MOST_WALLS} of {MOST_WALLS + 1} are in the picture"
    assert told in planned(CAMERAS[0], scene(*many, materials=[WALL])).left_out
    assert told not in planned(CAMERAS[0], scene(*many[1:], materials=[WALL])).left_out
