"""What is drawn many times, sometimes, or in parts: instancing, visibility and primitive restart."""

from __future__ import annotations

import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError
from viewer.scene.rig import compose

RNG = np.random.default_rng(0)
COUNT = 5
TRANSLATIONS = RNG.uniform(-9, 9, (COUNT, 3))
ROTATIONS = RNG.normal(size=(COUNT, 4))
ROTATIONS /= np.linalg.norm(ROTATIONS, axis=1, keepdims=True)
SCALES = RNG.uniform(0.5, 2, (COUNT, 3))
INSTANCING, VISIBILITY = "EXT_mesh_gpu_instancing", "KHR_node_visibility"


def instanced(builder: GltfBuilder, **node) -> GltfBuilder:
    """A node of two triangles that is turned, moved and drawn COUNT times."""
    attributes = {"TRANSLATION": builder.accessor(TRANSLATIONS), "ROTATION": builder.accessor(ROTATIONS),
                  "SCALE": builder.accessor(SCALES)}
    corners = {"POSITION": builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]])}
    mesh = builder.add("meshes", {"primitives": [{"attributes": corners}, {"attributes": corners}]})
    builder.json["extensionsRequired"] = [INSTANCING]
    builder.node(mesh=mesh, translation=[1, 2, 3], rotation=[0.6, 0, 0, 0.8],
                 extensions={INSTANCING: {"attributes": attributes}}, **node)
    return builder


def expected_transforms() -> np.ndarray:
    node = compose(np.array([[1.0, 2, 3]]), np.array([[0.6, 0, 0, 0.8]]), np.ones((1, 3)))
    return node @ compose(TRANSLATIONS, ROTATIONS, SCALES)


def test_instances():
    scene = instanced(GltfBuilder()).load()
    assert not scene.warnings and len(scene.meshes) == 2 and scene.triangle_count == 2 * COUNT
    got = np.stack([instance.transform for instance in scene.instances])
    np.testing.assert_allclose(got.reshape(COUNT, 2, 4, 4), expected_transforms()[:, None].repeat(2, axis=1), atol=1e-6)
    assert [instance.mesh for instance in scene.instances] == [0, 1] * COUNT


@pytest.mark.parametrize("dtype, error", [("int8", 0.02), ("int16", 1e-4)])
def test_rotations_may_be_integers(dtype, error):
    builder = instanced(GltfBuilder())
    stored = np.rint(ROTATIONS * np.iinfo(dtype).max)
    attributes = builder.json["nodes"][0]["extensions"][INSTANCING]["attributes"]
    attributes["ROTATION"] = builder.accessor(stored, dtype, normalized=True)
    got = np.stack([instance.transform for instance in builder.load().instances[::2]])
    np.testing.assert_allclose(got, expected_transforms(), atol=error * 2)


def test_instances_follow_their_node():
    builder = instanced(GltfBuilder())
    track = {"input": builder.accessor([0, 1]), "output": builder.accessor([[1, 2, 3], [11, 2, 3]])}
    builder.json["animations"] = [{"samplers": [track], "channels": [
        {"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]
    scene = builder.load()
    moved = scene.at(1.0)
    np.testing.assert_allclose(moved.transforms, scene.transforms + np.eye(4)[0][:, None] * (0, 0, 0, 10), atol=1e-6)
    assert scene.at(0.0).instances is scene.instances


@pytest.mark.parametrize("change, words", [
    ({"ROTATION": None, "TRANSLATION": None, "SCALE": None}, "neither TRANSLATION nor"),
    ({"SCALE": 99}, "SCALE: index 99"), ({"SCALE": "count"}, "SCALE: 4 values for 5 of TRANSLATION"),
    ({"SCALE": "nan"}, "SCALE: the values must be finite"), ({"ROTATION": 2}, "must be VEC4 here"),
    ({"TRANSLATION": "bomb", "ROTATION": None, "SCALE": None}, f"{1 << 20} more instances are too many for")])
def test_bad_attributes_name_their_place(change, words):
    builder = instanced(GltfBuilder())
    made = {"count": lambda: builder.accessor(SCALES[:4]), "nan": lambda: builder.accessor(SCALES * np.nan),
            "bomb": lambda: builder.add("accessors", {"componentType": 5126, "type": "VEC3", "count": 1 << 20})}
    attributes = builder.json["nodes"][0]["extensions"][INSTANCING]["attributes"]
    for key, value in change.items():
        if value is None:
            del attributes[key]
        else:
            attributes[key] = made[value]() if isinstance(value, str) else value
    with pytest.raises(InputError, match=r"nodes\[0\]\.extensions|accessors\[") as caught:
        builder.load()
    assert words in str(caught.value)


def test_a_skinned_mesh_is_drawn_once():
    builder = instanced(GltfBuilder(), skin=0)
    for primitive in builder.json["meshes"][0]["primitives"]:
        primitive["attributes"] |= {"JOINTS_0": builder.accessor([[0] * 4] * 3, "uint8"),
                                    "WEIGHTS_0": builder.accessor([[1, 0, 0, 0]] * 3)}
    builder.add("skins", {"joints": [0]})
    scene = builder.load()
    assert len(scene.instances) == 2 and "is for meshes without a skin" in scene.warnings[0]


def family(builder: GltfBuilder, visible=(True, True, True)) -> GltfBuilder:
    """A parent with a triangle, a child with one, a light and a camera, and a node with a triangle beside them."""
    builder.json |= {"extensionsRequired": [VISIBILITY], "cameras": [
        {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}}}
    triangle = builder.triangle()
    child = builder.node(root=False, name="child", mesh=triangle, camera=0, translation=[0, 5, 0], extensions={
        "KHR_lights_punctual": {"light": 0}, VISIBILITY: {"visible": visible[1]}})
    builder.node(name="parent", mesh=triangle, children=[child], extensions={VISIBILITY: {"visible": visible[0]}})
    builder.node(name="beside", mesh=triangle, extensions={VISIBILITY: {"visible": visible[2]}})
    return builder


@pytest.mark.parametrize("visible, names, lights", [
    ((True, True, True), ["parent", "child", "beside"], 1), ((False, True, True), ["beside"], 0),
    ((True, False, True), ["parent", "beside"], 0), ((True, True, False), ["parent", "child"], 1)])
def test_what_is_hidden(visible, names, lights):
    scene = family(GltfBuilder(), visible).load()
    assert [instance.name for instance in scene.instances] == names
    assert len(scene.lights) == lights and len(scene.cameras) == 1 and not scene.warnings


def test_visibility_that_is_animated():
    """The parent is shown in the second second alone, and what is below it with it."""
    builder = family(GltfBuilder(), (False, True, True))
    times, shown = builder.accessor([0, 1, 2]), builder.accessor([0, 1, 0], "uint8")
    pointer = {"KHR_animation_pointer": {"pointer": f"/nodes/1/extensions/{VISIBILITY}/visible"}}
    builder.json["animations"] = [{
        "samplers": [{"input": times, "output": shown, "interpolation": "STEP"}],
        "channels": [{"sampler": 0, "target": {"path": "pointer", "extensions": pointer}}]}]
    scene = builder.load()
    assert len(scene.instances) == 3 and not scene.warnings
    for time, is_shown in ((None, False), (0.5, False), (1.5, True), (2.5, False)):
        posed = scene if time is None else scene.at(time)
        drawn = [instance.name for instance in posed.instances if np.linalg.det(instance.transform[:3, :3])]
        assert drawn == (["parent", "child", "beside"] if is_shown else ["beside"])
        assert posed.lights[0].intensity == (5 if is_shown else 0)
        assert posed.bounds[1, 1] == (6 if is_shown else 1)


def test_bad_visibility():
    with pytest.raises(InputError, match=r"nodes\[0\]\..*KHR_node_visibility\.visible: must be true or false"):
        family(GltfBuilder(), (True, 1, True)).load()


def drawn(mode: int, indices, dtype: str = "uint16", extension: bool = True) -> np.ndarray:
    used = ["EXT_mesh_primitive_restart"] * extension
    builder = GltfBuilder(extensionsUsed=used, extensionsRequired=used)
    corners = {"POSITION": builder.accessor(np.arange(36).reshape(12, 3)), "NORMAL": builder.accessor([[0, 0, 1]] * 12)}
    builder.node(mesh=builder.mesh(corners, mode=mode, indices=builder.accessor(indices, dtype)))
    mesh = builder.load().meshes[0]
    return mesh.positions[mesh.indices, 0].astype(int) // 3


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "uint32"])
@pytest.mark.parametrize("mode", [2, 3, 5, 6])
def test_parts_between_restart_values_are_drawn_each_for_itself(mode, dtype):
    cut = np.iinfo(dtype).max
    parts = [[0, 1, 2, 3, 4], [5, 6, 7], [8], [], [9, 10, 11, 7, 3, 1]]
    joined = [index for part in parts for index in (*part, cut)]
    alone = [drawn(mode, part, dtype) for part in parts if len(part) >= 3]
    np.testing.assert_array_equal(drawn(mode, joined, dtype), np.concatenate(alone))
    np.testing.assert_array_equal(drawn(mode, [cut, cut, *joined[:-1]], dtype), np.concatenate(alone))


@pytest.mark.parametrize("mode, extension", [(5, False), (4, True), (1, True), (0, True)])
def test_restart_values_that_are_not_allowed(mode, extension):
    with pytest.raises(InputError, match=r"primitives\[0\]\.indices: 65535 is the primitive restart value"):
        drawn(mode, [0, 1, 2, 65535, 3, 4, 5], extension=extension)


def test_an_index_too_high_beside_restart_values():
    with pytest.raises(InputError, match="index 12, but there are 12"):
        drawn(5, [0, 1, 2, 65535, 3, 4, 12])


def test_groups_of_primitives_are_drawn_as_they_are():
    """A group says how primitives may be drawn in one call, and that gives the same picture."""
    builder = GltfBuilder(extensionsUsed=["EXT_mesh_primitive_restart"])
    mesh = builder.triangle()
    builder.json["meshes"][mesh]["extensions"] = {"EXT_mesh_primitive_restart": {
        "primitiveGroups": [{"primitives": [0], "indices": 0}]}}
    builder.node(mesh=mesh)
    scene = builder.load()
    assert scene.triangle_count == 1 and not scene.warnings
