"""Lines of glTF with a radius, which are curves."""

from __future__ import annotations

import numpy as np
import pytest
from gltf_builder import GltfBuilder
from test_gltf_instancing import COUNT, INSTANCING, VISIBILITY, expected_transforms, instanced

from viewer.errors import InputError
from viewer.scene.curves import Curves

POINTS = np.float32([[0, 0, 0], [1, 0, 0], [1, 2, 0], [5, 5, 5], [5, 6, 5], [4, 6, 5]])
RADII = np.float32([0.1, 0.2, 0.05, 0.3, 0.2, 0.1])


def lines(mode: int, indices=None, radii=RADII, points=POINTS, **more) -> GltfBuilder:
    builder = GltfBuilder()
    attributes = {"POSITION": builder.accessor(points), "_RADIUS": builder.accessor(radii)}
    primitive = {} if indices is None else {"indices": builder.accessor(np.asarray(indices), "uint16")}
    builder.mesh(attributes, mode=mode, **primitive, **more)
    builder.node(mesh=0)
    return builder


def only(builder: GltfBuilder) -> Curves:
    scene = builder.load()
    curves, = scene.curves
    assert not scene.meshes and not scene.warnings
    return curves


@pytest.mark.parametrize("mode, indices, strands, closed", [
    (3, None, [[0, 1, 2, 3, 4, 5]], [False]), (2, None, [[0, 1, 2, 3, 4, 5]], [True]),
    (1, None, [[0, 1], [2, 3], [4, 5]], [False] * 3), (3, [4, 2, 0], [[4, 2, 0]], [False]),
    (1, [0, 1, 1, 2, 2, 3, 5, 4], [[0, 1, 2, 3], [5, 4]], [False, False]),
    (1, [0, 1, 1, 2, 2, 0, 4, 5], [[0, 1, 2], [4, 5]], [True, False]),
    (3, [3, 4, 5, 3], [[3, 4, 5]], [True]), (3, [0, 1, 0], [[0, 1, 0]], [False])])
def test_lines_become_strands(mode, indices, strands, closed):
    curves = only(lines(mode, indices))
    order = np.concatenate(strands)
    np.testing.assert_array_equal(curves.points, POINTS[order])
    np.testing.assert_array_equal(curves.radii, RADII[order])
    assert curves.lengths.tolist() == [len(strand) for strand in strands] and curves.closed.tolist() == closed
    assert curves.kind == "linear" and curves.colors is None


def test_lines_without_a_radius_stay_lines():
    builder = lines(3)
    del builder.json["meshes"][0]["primitives"][0]["attributes"]["_RADIUS"]
    scene = builder.load()
    assert not scene.curves and scene.meshes[0].topology == "lines"


def test_curves_stand_where_their_node_is():
    builder = lines(3)
    builder.json["nodes"][0] = {"mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, 2], "name": "fur"}
    curves = only(builder)
    np.testing.assert_allclose(curves.points, 2 * POINTS + (1, 2, 3))
    np.testing.assert_allclose(curves.radii, 2 * RADII)
    assert curves.name == "fur"


def test_instances_are_copies():
    builder = instanced(lines(3, [0, 1, 2]))
    builder.json["nodes"].pop(0)
    builder.json["nodes"][0]["mesh"] = 0
    builder.json["scenes"] = [{"nodes": [0]}]
    curves = only(builder)
    assert curves.strand_count == COUNT and len(curves.points) == 3 * COUNT
    for k, matrix in enumerate(expected_transforms()):
        np.testing.assert_allclose(curves.points[3 * k:3 * k + 3], POINTS[:3] @ matrix[:3, :3].T + matrix[:3, 3],
                                   atol=1e-5)
        np.testing.assert_allclose(curves.radii[3 * k:3 * k + 3], RADII[:3] * np.cbrt(np.linalg.det(matrix[:3, :3])),
                                   rtol=1e-5)


def test_the_colour_is_that_of_the_vertices_times_that_of_the_material():
    builder = lines(3, material=0)
    colors = np.random.default_rng(0).random((6, 3)).astype(np.float32)
    builder.json["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]}}]
    np.testing.assert_allclose(only(builder).colors, [[0.5, 0.25, 1]] * 6)
    del builder.json["buffers"]
    builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = builder.accessor(colors)
    np.testing.assert_allclose(only(builder).colors, colors * np.float32([0.5, 0.25, 1]))


def test_the_colour_moves_with_the_base_colour_of_the_material():
    builder = lines(3, material=0)
    colors = np.random.default_rng(0).random((6, 3)).astype(np.float32)
    builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = builder.accessor(colors)
    builder.json["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]}}]
    builder.json["animations"] = [{"samplers": [{
        "input": builder.accessor(np.float32([0, 1])),
        "output": builder.accessor(np.float32([[0.5, 0.25, 1, 1], [2, 0.75, 0, 1]]))}], "channels": [
            {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {
                "pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}}}}]}]
    scene = builder.load()
    later = scene.at(1)
    np.testing.assert_allclose(later.curves[0].colors, colors * np.float32([1, 0.75, 0]))
    np.testing.assert_array_equal(later.curves[0].points, scene.curves[0].points)
    assert later.at(1).curves is later.curves and later.at(0).curves[0] is scene.at(0).curves[0] is scene.curves[0]


def test_hidden_nodes_have_no_curves():
    builder = lines(3)
    builder.json["nodes"][0]["extensions"] = {VISIBILITY: {"visible": False}}
    builder.json["extensionsUsed"] = [VISIBILITY]
    assert not builder.load().curves


def animated(builder: GltfBuilder, node: int, path: str, values) -> GltfBuilder:
    """One second long, from the first of two values to the other."""
    track = {"input": builder.accessor(np.float32([0, 1])), "output": builder.accessor(np.float32(values))}
    builder.json["animations"] = [{"samplers": [track], "channels": [
        {"sampler": 0, "target": {"node": node, "path": path}}]}]
    return builder


def test_morph_targets_are_left_out():
    assert lines(3, targets=[]).load().warnings == (
        "meshes[0].primitives[0].targets: the targets of curves are left out",)


def test_curves_move_with_their_node_and_those_above():
    builder = lines(3)
    builder.json["nodes"][0] = {"mesh": 0, "translation": [1, 0, 0]}
    builder.json["nodes"] += [{"children": [0]}, {"mesh": 0}]
    builder.json["scenes"] = [{"nodes": [1, 2]}]
    scene = animated(builder, 1, "scale", [[1, 1, 1], [3, 3, 3]]).load()
    assert not scene.warnings
    moving, still = (next(k for k in (0, 1) if (scene.curves[k].points[0, 0] == x)) for x in (1, 0))
    later = scene.at(0.5)
    np.testing.assert_allclose(later.curves[moving].points, 2 * (POINTS + (1, 0, 0)), rtol=1e-6)
    np.testing.assert_allclose(later.curves[moving].radii, 2 * RADII, rtol=1e-6)
    assert later.curves[still] is scene.curves[still] and later.layout == scene.layout
    assert later.at(0.5).curves is later.curves  # what has not moved since is the same
    back = later.at(0)
    assert all(a is b for a, b in zip(back.curves, scene.curves, strict=True))
    assert scene.at(0).curves is scene.curves and later.bounds[1].max() > scene.bounds[1].max()


def test_curves_move_with_the_joints_of_a_skin():
    builder = GltfBuilder()
    joints = np.zeros((6, 4), np.uint8)
    joints[:, 1] = 1
    weights = np.zeros((6, 4), np.float32)
    weights[:, 1] = [0, 0, 0.5, 1, 1, 1]
    weights[:, 0] = 1 - weights[:, 1]
    builder.mesh({"POSITION": builder.accessor(POINTS), "_RADIUS": builder.accessor(RADII),
                  "JOINTS_0": builder.accessor(joints, "uint8"), "WEIGHTS_0": builder.accessor(weights)},
                 mode=3, indices=builder.accessor(np.uint16([5, 4, 3, 2, 1, 0]), "uint16"))
    for node in ({"mesh": 0, "skin": 0, "translation": [7, 7, 7]}, {}, {}):
        builder.node(**node)
    builder.json["skins"] = [{"joints": [1, 2]}]
    scene = animated(builder, 2, "translation", [[0, 0, 0], [0, 4, 0]]).load()
    assert not scene.warnings
    order = [5, 4, 3, 2, 1, 0]
    np.testing.assert_allclose(scene.curves[0].points, POINTS[order])  # only the joints place what has a skin
    np.testing.assert_allclose(scene.at(1).curves[0].points, (POINTS + np.outer(weights[:, 1], (0, 4, 0)))[order])
    np.testing.assert_allclose(scene.at(1).curves[0].radii, RADII[order])


def test_curves_appear_when_their_node_does():
    builder = lines(3)
    builder.json["nodes"][0]["extensions"] = {VISIBILITY: {"visible": False}}
    builder.json["extensionsUsed"] = [VISIBILITY, "KHR_animation_pointer"]
    track = {"input": builder.accessor(np.float32([0, 1])), "output": builder.accessor(np.uint8([0, 1]), "uint8"),
             "interpolation": "STEP"}
    pointer = {"pointer": f"/nodes/0/extensions/{VISIBILITY}/visible"}
    builder.json["animations"] = [{"samplers": [track], "channels": [
        {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": pointer}}}]}]
    scene = builder.load()
    assert not scene.curves[0].radii.any()
    np.testing.assert_array_equal(scene.at(1).curves[0].radii, RADII)
    np.testing.assert_array_equal(scene.at(1).curves[0].points, POINTS)


def test_a_pose_beyond_what_can_be_drawn_is_told():
    scene = animated(lines(3), 0, "scale", [[1, 1, 1], [3e38, 1, 1]]).load()
    with pytest.raises(InputError, match="at 1 s the model cannot be drawn"):
        scene.at(1)


@pytest.mark.parametrize("builder, problem", [
    (lines(3, radii=[1, 1, 1, -1, 1, 1]), "attributes._RADIUS: vertex 3: -1 is no radius"),
    (lines(3, radii=[1, 1, 1, np.nan, 1, 1]), "attributes._RADIUS: vertex 3: nan is no radius"),
    (lines(3, radii=[1, 1]), "attributes._RADIUS: 2 values for 6 positions")])
def test_radii_that_are_none_are_refused(builder, problem):
    with pytest.raises(InputError, match=problem):
        builder.load()


def test_too_many_copies_are_refused():
    builder = lines(3, points=np.tile(POINTS, (400, 1)), radii=np.tile(RADII, 400))
    attributes = {"SCALE": builder.add("accessors", {"componentType": 5126, "count": 60000, "type": "VEC3"})}
    builder.json["extensionsUsed"] = [INSTANCING]
    builder.json["nodes"][0]["extensions"] = {INSTANCING: {"attributes": attributes}}
    with pytest.raises(InputError, match="primitives.0.: 60000 copies of 2400 points of curves are too many"):
        builder.load()


def test_broken_positions_are_left_out():
    scene = lines(3, points=np.where(POINTS == 2, np.nan, POINTS)).load()
    assert "2 of 5 lines are not at finite positions" in scene.warnings[0]
    assert scene.curves[0].lengths.tolist() == [2, 3]
