import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError

POINTS = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 2, 0]])


def load(mode: int, indices=None, points=POINTS):
    builder = GltfBuilder()
    attributes = {"POSITION": builder.accessor(points), "NORMAL": builder.accessor([[0, 0, 1]] * len(points))}
    extra = {} if indices is None else {"indices": builder.accessor(indices, "uint16")}
    builder.node(mesh=builder.mesh(attributes, mode=mode, **extra))
    return builder.load()


@pytest.mark.parametrize("mode, topology, expected", [
    (0, "points", None), (2, "lines", [0, 1, 1, 2, 2, 3, 3, 4, 4, 0]), (3, "lines", [0, 1, 1, 2, 2, 3, 3, 4]),
    (5, "triangles", [0, 1, 2, 1, 3, 2, 2, 3, 4]), (6, "triangles", [1, 2, 0, 2, 3, 0, 3, 4, 0])])
def test_modes(mode, topology, expected):
    mesh = load(mode).meshes[0]
    assert mesh.topology == topology
    assert (mesh.indices is None) if expected is None else mesh.indices.tolist() == expected


def test_strips_wind_alike():
    mesh = load(5).meshes[0]
    a, b, c = mesh.positions[mesh.indices.reshape(-1, 3)].transpose(1, 0, 2)
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_strip_of_indices():
    assert load(5, [4, 2, 3]).meshes[0].indices.tolist() == [4, 2, 3]


def test_left_over_vertices_are_dropped_with_a_warning():
    scene = load(4)
    assert scene.meshes[0].indices.tolist() == [0, 1, 2]
    assert any("complete triangles" in line for line in scene.warnings)


@pytest.mark.parametrize("indices, problem", [([0, 1, 5], "index 5, but there are 5"), ([0, 1, 65535], "restart")])
def test_bad_indices(indices, problem):
    with pytest.raises(InputError, match=rf"meshes\[0\]\.primitives\[0\]\.indices: .*{problem}"):
        load(4, indices)


def test_missing_normals_are_flat_and_unindexed():
    builder = GltfBuilder()
    position = builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 1]])
    tangent = builder.accessor([[1, 0, 0, 1]] * 4)
    builder.node(mesh=builder.mesh({"POSITION": position, "TANGENT": tangent},
                                   indices=builder.accessor([0, 1, 2, 0, 3, 1], "uint8")))
    mesh = builder.load().meshes[0]
    assert mesh.indices is None and len(mesh.positions) == 6 and mesh.tangents is None
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3 + [[0, 1, 0]] * 3, atol=1e-6)


def test_bad_normals_are_computed_with_a_warning():
    builder = GltfBuilder()
    normals = builder.accessor([[0, 0, 1], [np.nan, 0, 0], [0, 0, 0]])
    builder.node(mesh=builder.mesh({"POSITION": builder.accessor(POINTS[:3]), "NORMAL": normals}))
    scene = builder.load()
    np.testing.assert_allclose(scene.meshes[0].normals, [[0, 0, 1]] * 3, atol=1e-6)
    assert any("2 normals" in line for line in scene.warnings)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("mode, kept, of", [(0, 4, "1 of 5 points"), (1, 2, "1 of 2 lines"), (3, 4, "2 of 4 lines"),
                                            (4, 0, "1 of 1 triangles"), (5, 0, "3 of 3 triangles")])
def test_what_is_not_at_finite_positions_is_left_out(mode, kept, of, value):
    builder = GltfBuilder()
    points = [[0, 0, 0], [1, 0, 0], [0, value, 0], [1, 1, 0], [2, 1, 0]]
    builder.node(mesh=builder.mesh({"POSITION": builder.accessor(points)}, mode=mode))
    scene = builder.load()
    assert any(f"attributes.POSITION: {of} are not at finite positions; they are left out" in line
               for line in scene.warnings)
    assert sum(mesh.element_count for mesh in scene.meshes) == kept and np.isfinite(scene.bounds).all()


def test_a_vertex_that_nothing_uses_may_be_anywhere():
    builder = GltfBuilder()
    points = builder.accessor([[0, 0, 0], [1, 0, 0], [np.nan, 0, 0], [0, 1, 0]])
    normals = builder.accessor([[0, 0, 1]] * 4)
    indices = builder.accessor([0, 1, 3], "uint16")
    builder.node(mesh=builder.mesh({"POSITION": points, "NORMAL": normals}, indices=indices))
    scene = builder.load()
    assert not scene.warnings and scene.triangle_count == 1 and np.isfinite(scene.meshes[0].positions).all()
    assert scene.bounds.tolist() == [[0, 0, 0], [1, 1, 0]]


@pytest.mark.parametrize("dtype, columns", [("uint8", 3), ("uint16", 4), ("float32", 3), ("float32", 4)])
def test_vertex_colours(dtype, columns):
    builder = GltfBuilder()
    peak = {"uint8": 255, "uint16": 65535, "float32": 1}[dtype]
    colors = np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0]])[:, :columns] * peak
    if dtype == "uint8":  # rows of 3 bytes are padded to 4
        view = builder.view(np.pad(colors.astype(np.uint8), ((0, 0), (0, 1))).tobytes(), byteStride=4)
        color = builder.add("accessors", {"bufferView": view, "componentType": 5121, "count": 3, "type": "VEC3",
                                          "normalized": True})
    else:
        color = builder.accessor(colors, dtype, normalized=dtype != "float32")
    builder.node(mesh=builder.mesh({"POSITION": builder.accessor(POINTS[:3]), "COLOR_0": color}))
    expected = np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0 if columns == 4 else 1]])
    np.testing.assert_array_equal(builder.load().meshes[0].colors, expected)


def test_colours_that_are_not_finite_are_told():
    builder = GltfBuilder()
    color = builder.accessor([[1, 0, 0, 1], [np.nan] * 4, [0, np.inf, 1, 1]])
    builder.node(mesh=builder.mesh({"POSITION": builder.accessor(POINTS[:3]), "COLOR_0": color}))
    scene = builder.load()
    (line,) = scene.warnings
    assert "attributes.COLOR_0: 2 colours are not finite" in line
    assert scene.meshes[0].colors.tolist() == [[1, 0, 0, 1], [0, 0, 0, 0], [0, 1, 1, 1]]


def test_two_uv_sets_and_a_missing_one():
    builder = GltfBuilder()
    material = builder.add("materials", {"emissiveTexture": {"index": builder.texture(), "texCoord": 1}})
    position, uv = builder.accessor(POINTS[:3]), builder.accessor([[1, 2]] * 3)
    builder.node(mesh=builder.mesh({"POSITION": position, "TEXCOORD_0": uv, "TEXCOORD_1": uv}, material=material))
    builder.node(mesh=builder.mesh({"POSITION": position, "TEXCOORD_0": uv}, material=material))
    scene = builder.load()
    assert [len(mesh.uvs) for mesh in scene.meshes] == [2, 2]
    assert not scene.meshes[1].uvs[1].any()
    assert any("TEXCOORD_1" in line for line in scene.warnings)


def test_tangents_of_no_length_are_made_anew():
    builder = GltfBuilder()
    position = builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    normal, tangent = builder.accessor([[0, 0, 1]] * 3), builder.accessor([[0, 0, 0, 1]] * 3)
    uv = builder.accessor([[0, 0], [1, 0], [0, 1]])
    material = builder.add("materials", {"normalTexture": {"index": builder.texture()}})
    builder.node(mesh=builder.mesh({"POSITION": position, "NORMAL": normal, "TANGENT": tangent, "TEXCOORD_0": uv},
                                   material=material))
    (mesh,) = builder.load().meshes
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents[:, :3], axis=1), 1, atol=1e-6)


def test_tangents_are_made_for_a_normal_map_alone():
    builder = GltfBuilder()
    material = builder.add("materials", {"normalTexture": {"index": builder.texture()}})
    attributes = {"POSITION": builder.accessor(POINTS[:3]), "NORMAL": builder.accessor([[0, 0, 1]] * 3),
                  "TEXCOORD_0": builder.accessor([[0, 1], [1, 1], [0, 0]])}
    builder.node(mesh=builder.mesh(attributes, material=material))
    builder.node(mesh=builder.mesh(attributes))
    mapped, plain = builder.load().meshes
    np.testing.assert_allclose(mapped.tangents, [[1, 0, 0, 1]] * 3, atol=1e-6)
    assert plain.tangents is None


def test_attributes_of_unequal_counts_and_missing_positions():
    builder = GltfBuilder()
    builder.node(mesh=builder.mesh({"POSITION": builder.accessor(POINTS[:3]), "NORMAL": builder.accessor(POINTS)}))
    with pytest.raises(InputError, match=r"attributes\.NORMAL: 5 values for 3"):
        builder.load()
    builder = GltfBuilder()
    builder.node(mesh=builder.mesh({"NORMAL": builder.accessor(POINTS)}))
    scene = builder.load()
    assert not scene.instances and any("no positions" in line for line in scene.warnings)


def test_vertices_that_are_not_drawn_are_dropped():
    builder = GltfBuilder()
    many = np.arange(3000, dtype=np.float32).reshape(1000, 3)
    attributes = {"POSITION": builder.accessor(many), "NORMAL": builder.accessor([[0, 0, 1]] * 1000),
                  "TEXCOORD_0": builder.accessor(many[:, :2])}
    drawn = [[900, 5, 7], list(range(300, 0, -1)), list(range(999))]
    for indices in drawn:
        builder.node(mesh=builder.mesh(attributes, indices=builder.accessor(indices, "uint16")))
    meshes = builder.load().meshes
    assert [len(mesh.positions) for mesh in meshes] == [3, 300, 1000]
    for mesh, indices in zip(meshes, drawn):
        np.testing.assert_array_equal(mesh.positions[mesh.indices], many[indices])
        np.testing.assert_array_equal(mesh.uvs[0][mesh.indices], many[indices, :2])
