import math
import re

import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError


def test_trs_matrix_and_hierarchy():
    builder = GltfBuilder()
    mesh = builder.triangle()
    half = math.sqrt(0.5)
    matrix = np.array([[2, 0, 0, 1], [0, 1, 0, 2], [0, 0, -1, 3], [0, 0, 0, 1.0]])
    child = builder.node(root=False, mesh=mesh, matrix=matrix.T.ravel().tolist())
    builder.node(mesh=mesh, translation=[1, 2, 3], rotation=[0, 0, half, half], scale=[2, 3, -4], children=[child])
    parent_world, child_world = (instance.transform for instance in builder.load().instances)
    expected = np.array([[0, -3, 0, 1], [2, 0, 0, 2], [0, 0, -4, 3], [0, 0, 0, 1]])
    np.testing.assert_allclose(parent_world, expected, atol=1e-12)
    np.testing.assert_allclose(child_world, expected @ matrix, atol=1e-12)


def test_instances_share_the_mesh():
    builder = GltfBuilder()
    mesh = builder.triangle()
    for k in range(3):
        builder.node(mesh=mesh, name=f"n{k}")
    scene = builder.load()
    assert len(scene.meshes) == 1 and [(i.mesh, i.name) for i in scene.instances] == [(0, "n0"), (0, "n1"), (0, "n2")]


def test_a_scene_is_named_after_its_file():
    """Most exporters name it "Scene", which tells a user nothing in the title of a window or the name of a picture."""
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    assert builder.load().name == "memory"
    builder.json["scenes"][0]["name"] = "Scene"
    assert builder.load().name == "memory"


def test_scenes():
    builder = GltfBuilder()
    mesh = builder.triangle()
    builder.node(root=False, mesh=mesh, name="a")
    builder.node(root=False, mesh=mesh, name="b")
    assert [i.name for i in builder.load().instances] == ["a", "b"]
    builder.json.update(scenes=[{"nodes": [0], "name": "A"}, {"nodes": [1], "name": "B"}])
    assert builder.load().name == "memory - A"
    builder.json["scene"] = 1
    assert [i.name for i in builder.load().instances] == ["b"]
    assert builder.load(0).name == "memory - A"
    with pytest.raises(InputError, match="no scene 2"):
        builder.load(2)


@pytest.mark.parametrize("nodes, problem", [
    ([{"children": [0]}], "own ancestor"), ([{"children": [1]}, {"children": [0]}], "own ancestor"),
    ([{"children": [2]}, {"children": [2]}, {}], "child of nodes"),
    ([{"children": [5]}], "index 5, but only 0 exists"),
    ([{"children": [True]}], "integer"), ([{"children": {}}], "array"), ([7], "object")])
def test_broken_hierarchies(nodes, problem):
    builder = GltfBuilder(nodes=nodes, scenes=[{"nodes": [0]}])
    with pytest.raises(InputError, match=rf"nodes\[\d\].*{problem}"):
        builder.load()


INDEX_SITES = {"scene": ("scene",), "scenes[0].nodes[0]": ("scenes", 0, "nodes", 0),
               "nodes[0].mesh": ("nodes", 0, "mesh"), "nodes[0].children[0]": ("nodes", 0, "children", 0),
               "nodes[0].camera": ("nodes", 0, "camera"),
               "meshes[0].primitives[0].material": ("meshes", 0, "primitives", 0, "material")}


@pytest.mark.parametrize("place", INDEX_SITES)
def test_an_index_is_an_integer(place):
    *path, last = INDEX_SITES[place]

    def load(value):
        builder = GltfBuilder(materials=[{}], cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}])
        builder.node(mesh=builder.triangle(material=0), children=[1], camera=0)
        builder.node(root=False)
        builder.json["scene"] = 0
        at = builder.json
        for key in path:
            at = at[key]
        at[last] = value
        return builder.load()

    right = 1 if place == "nodes[0].children[0]" else 0
    assert load(float(right)).triangle_count == load(right).triangle_count == 1
    for value, problem in ((1.5, "not 1.5"), (True, "not true or false"), ("0", "not a string"), (None, "not null"),
                           (-1, ""), (7, "index 7, but only"), (10**400, r"below 2\^53"), (1e300, r"below 2\^53")):
        with pytest.raises(InputError, match=re.escape(f"{place}: ") + f".*{problem}") as caught:
            load(value)
        assert len(str(caught.value)) < 100


def test_node_twice_in_a_scene():
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    builder.json["scenes"][0]["nodes"] = [0, 0]
    with pytest.raises(InputError, match="reached twice"):
        builder.load()


def test_depth_is_unlimited():
    builder = GltfBuilder()
    mesh = builder.triangle()
    depth = 3000
    builder.json["nodes"] = [{"children": [k + 1], "translation": [1, 0, 0]} for k in range(depth)] + [{"mesh": mesh}]
    builder.json["scenes"] = [{"nodes": [0]}]
    assert builder.load().instances[0].transform[0, 3] == depth


def test_cameras_are_rigid():
    builder = GltfBuilder()
    perspective = builder.add("cameras", {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}})
    orthographic = builder.add("cameras", {"type": "orthographic", "name": "front",
                                           "orthographic": {"xmag": 2, "ymag": 3, "znear": 0, "zfar": 9}})
    builder.node(camera=perspective, scale=[2, -3, 4], translation=[1, 2, 3], name="eye")
    builder.node(camera=orthographic)
    first, second = builder.load().cameras
    assert first.near == 0.1 and second.near is None
    rotation = first.pose[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)
    np.testing.assert_allclose(first.forward, [0, 0, -1], atol=1e-12)
    assert first.eye.tolist() == [1, 2, 3] and first.fov_y == 0.7 and first.name == "eye"
    assert second.height == 6 and second.name == "front"


@pytest.mark.parametrize("camera", [
    {"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}, {"type": "fisheye"},
    {"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 0, "znear": 0, "zfar": 1}}])
def test_useless_cameras_are_left_out(camera):
    builder = GltfBuilder(cameras=[camera])
    builder.node(camera=0)
    scene = builder.load()
    assert not scene.cameras and any("left out" in line for line in scene.warnings)


def test_punctual_lights():
    light = {"type": "spot", "color": [1, 0.5, 0], "intensity": 20, "range": 5, "spot": {"outerConeAngle": 0.5}}
    builder = GltfBuilder(extensionsUsed=["KHR_lights_punctual"],
                          extensions={"KHR_lights_punctual": {"lights": [light, {"type": "directional"}]}})
    half = math.sqrt(0.5)
    builder.node(extensions={"KHR_lights_punctual": {"light": 0}}, translation=[1, 2, 3], rotation=[half, 0, 0, half],
                 scale=[5, 5, 5])
    builder.node(extensions={"KHR_lights_punctual": {"light": 1}})
    spot, sun = builder.load().lights
    assert (spot.kind, spot.color, spot.intensity, spot.range) == ("spot", (1, 0.5, 0), 20, 5)
    assert (spot.inner_cone, spot.outer_cone, spot.position) == (0, 0.5, (1, 2, 3))
    np.testing.assert_allclose(spot.direction, [0, 1, 0], atol=1e-12)
    assert (sun.kind, sun.intensity, sun.range, sun.direction) == ("directional", 1, None, (0, 0, -1))


@pytest.mark.parametrize("noise, warned", [(3e-8, False), (3.6e-6, True), (-9e-4, True)])
def test_rounding_in_the_last_row_of_a_matrix_is_mended(noise, warned):
    builder = GltfBuilder()
    matrix = np.eye(4)
    matrix[3] += noise
    builder.node(mesh=builder.triangle(), matrix=matrix.T.ravel().tolist())
    scene = builder.load()
    assert np.array_equal(scene.instances[0].transform, np.eye(4))
    assert [line.split(":")[0] for line in scene.warnings] == ["nodes[0].matrix"] * warned


def test_a_projection_is_no_transformation():
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle(), matrix=[1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    with pytest.raises(InputError, match=r"nodes\[0\].matrix: the last row must be 0 0 0 1"):
        builder.load()
