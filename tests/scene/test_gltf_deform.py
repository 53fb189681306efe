import math

import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError

TRIANGLE = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])


def morphed(**node):
    builder = GltfBuilder()
    targets = [{"POSITION": builder.accessor(np.float32([[0, 0, 1]] * 3))},
               {"POSITION": builder.accessor(np.float32([[2, 0, 0]] * 3))}]
    mesh = builder.mesh({"POSITION": builder.accessor(TRIANGLE)}, targets=targets)
    builder.json["meshes"][mesh]["weights"] = [0.5, 0]
    builder.node(mesh=mesh, **node)
    builder.node(mesh=mesh)
    return builder.load()


def test_node_weights_override_mesh_weights():
    scene = morphed(weights=[1, 0.25])
    np.testing.assert_allclose(scene.meshes[0].positions, TRIANGLE + (0.5, 0, 1), atol=1e-6)
    np.testing.assert_allclose(scene.meshes[1].positions, TRIANGLE + (0, 0, 0.5), atol=1e-6)
    assert [instance.mesh for instance in scene.instances] == [0, 1]


def test_equal_weights_share_a_mesh():
    assert len(morphed(weights=[0.5, 0]).meshes) == 1


def skinned(joint_nodes, weights, joints, dtype="float32", **extra):
    """A triangle with a normal, skinned to nodes with bind poses at the origin, under a node that is to be ignored."""
    builder = GltfBuilder()
    numbers = [builder.node(**node) for node in joint_nodes]
    inverse_bind = np.tile(np.eye(4, dtype=np.float32).T.ravel(), (len(numbers), 1))
    skin = builder.add("skins", {"joints": numbers, "inverseBindMatrices": builder.accessor(inverse_bind)})
    attributes = {"POSITION": builder.accessor(TRIANGLE), "NORMAL": builder.accessor([[0, 0, 1]] * 3)}
    for k in range(len(joints[0]) // 4):
        columns = slice(4 * k, 4 * k + 4)
        attributes[f"JOINTS_{k}"] = builder.accessor(np.array(joints)[:, columns], "uint8")
        attributes[f"WEIGHTS_{k}"] = builder.accessor(np.array(weights)[:, columns], dtype,
                                                      normalized=dtype != "float32")
    builder.node(mesh=builder.mesh(attributes), skin=skin, translation=[100, 0, 0], **extra)
    return builder


def test_skin_in_the_pose_of_its_joints():
    half = math.sqrt(0.5)
    nodes = [{"translation": [0, 0, 5]}, {"rotation": [half, 0, 0, half]}]  # the second turns +z to -y
    scene = skinned(nodes, [[1, 0, 0, 0], [0, 1, 0, 0], [0.5, 0.5, 0, 0]], [[0, 1, 0, 0]] * 3).load()
    mesh, instance = scene.meshes[0], scene.instances[0]
    np.testing.assert_allclose(mesh.positions, [[0, 0, 5], [1, 0, 0], [0, 0.5, 3]], atol=1e-6)
    np.testing.assert_allclose(mesh.normals[:2], [[0, 0, 1], [0, -1, 0]], atol=1e-6)
    np.testing.assert_array_equal(instance.transform, np.eye(4))


def test_normals_turn_against_a_stretch():
    builder = skinned([{"scale": [1, 1, 0.5]}], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3)
    slanted = builder.accessor([[0, 0.6, 0.8]] * 3)
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = slanted
    expected = np.array([0, 0.6, 1.6]) / math.hypot(0.6, 1.6)
    np.testing.assert_allclose(builder.load().meshes[0].normals, [expected] * 3, atol=1e-6)


MIRRORED = {"scale": [-1, 1, 1]}


def winding(mesh):
    """Whether each triangle winds counter-clockwise about the mean of its normals."""
    corners = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
    corners = corners.reshape(-1, 3)
    a, b, c = (mesh.positions[corners[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), mesh.normals[corners].sum(axis=1)) > 0


@pytest.mark.parametrize("indexed", [False, True])
def test_a_mirrored_joint_keeps_the_outside_outside(indexed):
    builder = skinned([MIRRORED], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3)
    if indexed:
        builder.json["meshes"][0]["primitives"][0]["indices"] = builder.accessor([0, 1, 2], "uint16")
    mesh = builder.load().meshes[0]
    np.testing.assert_allclose(mesh.positions, TRIANGLE * (-1, 1, 1))
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3)
    assert winding(mesh).all()


def test_joints_and_not_the_node_of_the_mesh_say_what_is_mirrored():
    """The node of the mesh mirrors, its joint does not."""
    assert winding(skinned([{}], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3, **MIRRORED).load().meshes[0]).all()


@pytest.mark.parametrize("joint", [{}, MIRRORED])
def test_an_inverse_bind_matrix_may_mirror(joint):
    builder = skinned([joint], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3)
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor([np.diag([-1.0, 1, 1, 1]).ravel()])
    mesh = builder.load().meshes[0]
    assert winding(mesh).all()
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3)


def test_each_triangle_follows_its_own_joints():
    builder = GltfBuilder()
    joints = [builder.node(), builder.node(**MIRRORED)]
    skin = builder.add("skins", {"joints": joints})
    chosen = [0, 0, 0, 1, 1, 1, 0, 1, 1]
    attributes = {"POSITION": builder.accessor(np.tile(TRIANGLE, (3, 1)) + np.float32([2, 0, 0])),
                  "NORMAL": builder.accessor([[0, 0, 1]] * 9),
                  "JOINTS_0": builder.accessor([[k, 0, 0, 0] for k in chosen], "uint8"),
                  "WEIGHTS_0": builder.accessor([[1, 0, 0, 0]] * 9)}
    builder.node(mesh=builder.mesh(attributes), skin=skin)
    mesh = builder.load().meshes[0]
    np.testing.assert_array_equal(mesh.indices, [0, 1, 2, 3, 5, 4, 6, 8, 7])
    assert winding(mesh)[:2].all()


def test_a_mirrored_joint_turns_the_bitangent():
    builder = skinned([MIRRORED], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3)
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["attributes"] |= {"TANGENT": builder.accessor([[1, 0, 0, 1]] * 3),
                                "TEXCOORD_0": builder.accessor([[0, 0], [1, 0], [0, 1]])}
    primitive["material"] = builder.add("materials", {"normalTexture": {"index": builder.texture()}})
    np.testing.assert_allclose(builder.load().meshes[0].tangents, [[-1, 0, 0, -1]] * 3)


@pytest.mark.parametrize("dtype, one", [("float32", 1), ("uint8", 255), ("uint16", 65535)])
def test_eight_influences(dtype, one):
    nodes = [{"translation": [k, 0, 0]} for k in range(8)]
    weights = np.zeros((3, 8))
    weights[0, 7] = weights[1, 3] = weights[2, 0] = one
    mesh = skinned(nodes, weights, [list(range(8))] * 3, dtype).load().meshes[0]
    np.testing.assert_allclose(mesh.positions, TRIANGLE + [[7, 0, 0], [3, 0, 0], [0, 0, 0]], atol=1e-5)


def test_weights_are_normalised():
    mesh = skinned([{"translation": [2, 0, 0]}, {}], [[0.1, 0.1, 0, 0]] * 3, [[0, 1, 0, 0]] * 3).load().meshes[0]
    np.testing.assert_allclose(mesh.positions, TRIANGLE + (1, 0, 0), atol=1e-6)


def test_joints_that_do_not_exist():
    with pytest.raises(InputError, match="JOINTS_0: joint 9, but the skin has 1"):
        skinned([{}], [[1, 0, 0, 0]] * 3, [[9, 0, 0, 0]] * 3).load()


def test_skin_on_a_mesh_without_joints_is_not_used():
    builder = GltfBuilder()
    joint = builder.node()
    builder.add("skins", {"joints": [joint]})
    builder.node(mesh=builder.triangle(), skin=0, translation=[4, 0, 0])
    scene = builder.load()
    assert scene.instances[0].transform[0, 3] == 4 and any("skin" in line for line in scene.warnings)


def test_inverse_bind_matrices_come_before_the_joints():
    builder = skinned([{"translation": [0, 0, 5], "scale": [2, 2, 2]}], [[1, 0, 0, 0]] * 3, [[0] * 4] * 3)
    inverse_bind = np.eye(4)
    inverse_bind[:3, 3] = (-1, 0, 0)
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor(inverse_bind.T.reshape(1, 16))
    np.testing.assert_allclose(builder.load().meshes[0].positions, 2 * (TRIANGLE - (1, 0, 0)) + (0, 0, 5), atol=1e-6)
