"""Scenes at a time: what has moved is where it should be, and the rest is shared."""

from __future__ import annotations

import math

import numpy as np
import pytest
from gltf_builder import GltfBuilder
from needs import CORPUS, needs

from viewer.errors import InputError, UsageError
from viewer.scene.load import load_scene

TRIANGLE = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
HALF = math.sqrt(0.5)


def animate(builder, channels, name="", interpolation="LINEAR", **accessors):
    """An animation with a sampler for each (node, path, times, values); `accessors` are properties of the outputs."""
    samplers, listed = [], []
    for node, path, times, values in channels:
        values = np.asarray(values)
        dtype = {"f": "float32", "i": "int64"}.get(values.dtype.kind, values.dtype.name)
        samplers.append({"input": builder.accessor(times), "interpolation": interpolation,
                         "output": builder.accessor(values, "float32" if dtype == "int64" else dtype, **accessors)})
        listed.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
    return builder.add("animations", {"samplers": samplers, "channels": listed} | ({"name": name} if name else {}))


def placed(scene):
    return [instance.transform[:3, 3].tolist() for instance in scene.instances]


def family():
    """A parent that turns about z and a child at its x = 2; beside them something that stands still."""
    builder = GltfBuilder()
    mesh = builder.triangle()
    child = builder.node(root=False, mesh=mesh, translation=[2, 0, 0])
    parent = builder.node(mesh=mesh, children=[child])
    builder.node(mesh=builder.triangle(), translation=[0, 0, 5])
    animate(builder, [(parent, "rotation", [0, 1], [[0, 0, 0, 1], [0, 0, HALF, HALF]])], "turn")
    animate(builder, [(parent, "translation", [0, 2], [[0, 0, 0], [0, 8, 0]])], "rise")
    return builder.load()


def test_a_child_follows_its_parent():
    scene = family()
    assert scene.warnings == () and placed(scene) == [[0, 0, 0], [2, 0, 0], [0, 0, 5]]
    half = scene.at(0.5)
    np.testing.assert_allclose(placed(half)[1], [2 * HALF, 2 * HALF, 0], atol=1e-6)
    np.testing.assert_allclose(half.instances[0].transform[:2, :2], [[HALF, -HALF], [HALF, HALF]], atol=1e-6)
    np.testing.assert_allclose(placed(scene.at(1, "rise")), [[0, 4, 0], [2, 4, 0], [0, 0, 5]])
    np.testing.assert_allclose(scene.bounds, family().bounds, err_msg="the scene at rest has not changed")


def test_what_stands_still_is_shared():
    scene = family()
    pose = scene.at(0.5)
    assert pose.meshes is scene.meshes and pose.materials is scene.materials and pose.cameras is scene.cameras
    assert pose.instances[2] is scene.instances[2] and pose.instances[0] is not scene.instances[0]
    assert pose.at(0.5).instances is pose.instances, "the same time is the same pose"
    assert scene.at(0).instances is scene.instances and scene.at(-3).instances is scene.instances
    assert pose.at(1, "rise").at(0).instances[1].transform.tolist() == scene.instances[1].transform.tolist()


def test_relit_scenes_keep_added_lights():
    builder = GltfBuilder(extensionsUsed=["KHR_lights_punctual"],
                          extensions={"KHR_lights_punctual": {"lights": [{"type": "spot"}]}})
    lamp = builder.node(extensions={"KHR_lights_punctual": {"light": 0}})
    builder.node(mesh=builder.triangle())
    animate(builder, [(lamp, "translation", [0, 1], [[0, 0, 0], [3, 0, 0]]),
                      (lamp, "rotation", [0, 1], [[0, 0, 0, 1], [0, HALF, 0, HALF]])])
    scene = builder.load()
    scene = scene.relit(lights=(*scene.lights, scene.lights[0]))
    moved = scene.at(1)
    assert moved.lights[0].position == (3, 0, 0) and moved.lights[0].direction == pytest.approx((-1, 0, 0), abs=1e-6)
    assert moved.lights[1] is scene.lights[1] and moved.instances is scene.instances


def test_a_camera_moves_with_its_node():
    builder = GltfBuilder(cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])
    node = builder.node(camera=0)
    builder.node(mesh=builder.triangle())
    animate(builder, [(node, "translation", [0, 1], [[0, 0, 0], [0, 0, 6]])])
    scene = builder.load()
    assert scene.at(0.5).cameras[0].eye.tolist() == [0, 0, 3] and scene.at(0).cameras is scene.cameras


def morphing(**extra):
    builder = GltfBuilder()
    targets = [{"POSITION": builder.accessor(np.float32([[0, 0, 1]] * 3))},
               {"POSITION": builder.accessor(np.float32([[0, 0, 0], [0, 0, 0], [0, 0, 2]]))}]
    mesh = builder.mesh({"POSITION": builder.accessor(TRIANGLE)}, targets=targets)
    first, second = builder.node(mesh=mesh), builder.node(mesh=mesh)
    animate(builder, [(first, "weights", [0, 1], np.float32([0, 0, 1, 0.5]))], **extra)
    return builder.load(), second


def test_morph_weights_move_one_node_only():
    scene, _ = morphing()
    assert len(scene.meshes) == 2
    pose = scene.at(0.5)
    np.testing.assert_allclose(pose.meshes[0].positions, TRIANGLE + [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 1]])
    assert pose.meshes[1] is scene.meshes[1] and pose.instances is scene.instances
    # The facet through (0, 0), (1, 0) and (0, 1), raised by 0.5, 0.5 and 1, has the normal (0, -0.5, 1).
    np.testing.assert_allclose(pose.meshes[0].normals, [np.array([0, -0.5, 1]) / math.sqrt(1.25)] * 3, atol=1e-6)
    assert pose.at(0.5).meshes is pose.meshes


def skinned():
    """A strip along y whose upper end a second joint moves, under a node whose transform is to be ignored."""
    builder = GltfBuilder()
    tip = builder.node(root=False, translation=[0, 1, 0])
    base = builder.node(children=[tip])
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[1, 1, 3] = -1
    skin = builder.add("skins", {"joints": [base, tip], "inverseBindMatrices": builder.accessor(
        bind.transpose(0, 2, 1).reshape(2, 16))})
    attributes = {"POSITION": builder.accessor([[0, 0, 0], [1, 0, 0], [0, 2, 0]]),
                  "NORMAL": builder.accessor([[0, 0, 1]] * 3),
                  "JOINTS_0": builder.accessor([[0, 1, 0, 0]] * 3, "uint8"),
                  "WEIGHTS_0": builder.accessor([[1, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 1, 0, 0]])}
    builder.node(mesh=builder.mesh(attributes), skin=skin, translation=[100, 0, 0])
    animate(builder, [(tip, "rotation", [0, 1], [[0, 0, 0, 1], [HALF, 0, 0, HALF]])])
    return builder.load()


def test_a_skin_follows_its_joints():
    """The tip turns by 90 degrees about x at y = 1: (0, 2, 0) comes to (0, 1, 1), normals to -y."""
    scene = skinned()
    np.testing.assert_allclose(scene.meshes[0].positions, [[0, 0, 0], [1, 0, 0], [0, 2, 0]], atol=1e-6)
    mesh = scene.at(1).meshes[0]
    # (1, 0, 0) is half way between itself and (1, 1, -1).
    np.testing.assert_allclose(mesh.positions, [[0, 0, 0], [1, 0.5, -0.5], [0, 1, 1]], atol=1e-6)
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1], [0, -HALF, HALF], [0, -1, 0]], atol=1e-6)
    assert mesh.indices is scene.meshes[0].indices and mesh.uvs == scene.meshes[0].uvs
    assert scene.at(1).instances is scene.instances


@pytest.mark.parametrize("dtype, one", [("int8", 127), ("uint8", 255), ("int16", 32767), ("uint16", 65535)])
def test_normalised_integers(dtype, one):
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle())
    animate(builder, [(node, "rotation", [0, 1], np.array([[0, 0, 0, one], [0, 0, one, 0]], dtype))], normalized=True)
    np.testing.assert_allclose(builder.load().at(0.5).instances[0].transform[:2, 0], [0, 1], atol=1e-4)


def broken(change):
    """The warnings of a file whose only animation `change` (JSON, builder) has broken; Inputerrors pass."""
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle())
    animate(builder, [(node, "translation", [0, 1, 2], [[0, 0, 0], [1, 0, 0], [0, 0, 0]])])
    change(builder.json["animations"][0], builder)
    scene = builder.load()
    assert scene.animations == () and len(scene.instances) == 1 and scene.at(1) is scene
    return scene.warnings


@pytest.mark.parametrize("times", [[0, 2, 1], [0, math.nan, 1], [0, 1, math.inf]])
def test_bad_times_cost_the_channel(times):
    def change(animation, builder):
        animation["samplers"][0]["input"] = builder.accessor(times)

    problem = "times must be finite, each after the one before; what it moves stands still"
    assert broken(change) == (f"animations[0].samplers[0].input: {problem}",)


def test_bad_values_cost_the_channel():
    def change(animation, builder):
        animation["samplers"][0]["output"] = builder.accessor([[0, 0, 0], [0, math.nan, 0], [0, 0, 0]])

    assert "output: values must be finite" in broken(change)[0]


@pytest.mark.parametrize("target, line", [
    ({"path": "translation"}, "'translation' of no node"), ({"node": 0, "path": "colour"}, "'colour' is unknown")])
def test_channels_that_move_nothing_are_left_out(target, line):
    def change(animation, _):
        animation["channels"][0]["target"] = target

    assert line in broken(change)[0]


@pytest.mark.parametrize("place, value, line", [
    ("channel", 9, r"channels\[0\]\.sampler: index 9"), ("node", 9, r"target\.node: index 9"),
    ("input", 99, r"samplers\[0\]\.input: index 99"), ("short", None, r"output: 2 values for 3 key frames"),
    ("type", None, r"must be VEC3 here, not 'VEC4'"), ("cubic", None, r"output: 3 values for 3 key frames"),
])
def test_what_refers_to_nothing_or_lies_is_an_error(place, value, line):
    def change(animation, builder):
        sampler, channel = animation["samplers"][0], animation["channels"][0]
        if place == "channel":
            channel["sampler"] = value
        elif place == "node":
            channel["target"]["node"] = value
        elif place == "input":
            sampler["input"] = value
        elif place == "cubic":
            sampler["interpolation"] = "CUBICSPLINE"
        else:
            sampler["output"] = builder.accessor(np.zeros((2, 3) if place == "short" else (3, 4)))

    with pytest.raises(InputError, match=line):
        broken(change)


def test_a_node_with_a_matrix_is_not_animated():
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle(), matrix=np.eye(4).ravel().tolist())
    animate(builder, [(node, "translation", [0, 1], [[0, 0, 0], [1, 0, 0]])])
    assert "has a matrix, which cannot be animated" in builder.load().warnings[0]


def test_scales_that_overflow_are_one_line():
    builder = GltfBuilder()
    child = builder.node(root=False, mesh=builder.triangle(), scale=[1e30] * 3)
    parent = builder.node(children=[child], scale=[1e-30] * 3)
    animate(builder, [(parent, "scale", [0, 1], [[1e-30] * 3, [1e30] * 3])], "grow")
    scene = builder.load()
    with pytest.raises(InputError, match="animation 'grow': at 1 s the model cannot be drawn: .*beyond 1e"):
        scene.at(1)


def test_animations_that_are_not_there():
    scene = family()
    with pytest.raises(UsageError, match="there is no animation 'fly'; there are turn, rise"):
        scene.at(0, "fly")
    with pytest.raises(UsageError, match="there is no animation 2"):
        scene.at(0, 2)
    with pytest.raises(UsageError, match="time=nan"):
        scene.at(math.nan)
    with pytest.raises(UsageError, match="time is of type str, not a number of seconds"):
        scene.at("a")
    with pytest.raises(UsageError, match="there is no animation True"):
        scene.at(0, True)
    assert np.array_equal(scene.at(0.5, np.int64(1)).instances[0].transform, scene.at(0.5, 1).instances[0].transform)


MOVING = ["Fox", "RiggedFigure", "BoxAnimated", "CesiumMilkTruck", "InterpolationTest", "SimpleMorph", "SimpleSkin",
          "alien-scolitex", "blender-all-animations"]


@needs("corpus")
@pytest.mark.parametrize("name", MOVING)
def test_models_of_the_corpus_move(name):
    path = next(p for p in (CORPUS / "models" / name).iterdir() if p.suffix in (".glb", ".gltf"))
    scene = load_scene(path)
    assert scene.animations and not [line for line in scene.warnings if "animation" in line]
    for number, animation in enumerate(scene.animations):
        poses = [scene.at(animation.duration * k / 4, number) for k in range(5)]
        shapes = {(pose.transforms.tobytes(), *(mesh.positions.tobytes() for mesh in pose.meshes)) for pose in poses}
        assert len(shapes) > 1
        assert [len(mesh.positions) for mesh in poses[2].meshes] == [len(mesh.positions) for mesh in scene.meshes]
        assert all(np.ptp(pose.bounds, axis=0).max() < 10 * np.ptp(scene.bounds, axis=0).max() for pose in poses)
