import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError

TRIANGLE = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])


def scene_of(builder: GltfBuilder, **attributes):
    position = attributes.pop("POSITION", None)
    position = builder.accessor(TRIANGLE) if position is None else position
    builder.node(mesh=builder.mesh({"POSITION": position, **attributes}))
    return builder.load().meshes[0]


@pytest.mark.parametrize("dtype", ["int8", "uint8", "int16", "uint16", "float32"])
def test_every_component_type_as_positions(dtype):
    builder = GltfBuilder(extensionsUsed=["KHR_mesh_quantization"], extensionsRequired=["KHR_mesh_quantization"])
    values = np.array([[0, 0, 0], [100, 0, 0], [0, 100, 7]])
    mesh = scene_of(builder, POSITION=builder.accessor(values, dtype))
    np.testing.assert_array_equal(mesh.positions, values)
    assert mesh.positions.dtype == np.float32


@pytest.mark.parametrize("dtype, stored, expected", [
    ("uint8", [0, 51, 255], [0, 0.2, 1]), ("int8", [-128, -127, 127], [-1, -1, 1]),
    ("uint16", [0, 13107, 65535], [0, 0.2, 1]), ("int16", [-32768, -32767, 32767], [-1, -1, 1])])
def test_normalised_integers(dtype, stored, expected):
    builder = GltfBuilder()
    uv = builder.accessor(np.stack([stored, stored], 1), dtype, normalized=True)
    np.testing.assert_allclose(scene_of(builder, TEXCOORD_0=uv).uvs[0][:, 0], expected, atol=1e-6)


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "uint32"])
def test_index_types(dtype):
    builder = GltfBuilder()
    attributes = {"POSITION": builder.accessor(TRIANGLE), "NORMAL": builder.accessor([[0, 0, 1]] * 3)}
    builder.node(mesh=builder.mesh(attributes, indices=builder.accessor([2, 0, 1], dtype)))
    assert builder.load().meshes[0].indices.tolist() == [2, 0, 1]


def test_interleaved():
    builder = GltfBuilder()
    rows = np.concatenate([TRIANGLE, [[0.5, 0.25]] * 3], axis=1).astype(np.float32)
    view = builder.view(rows.tobytes(), byteStride=20)
    both = {"bufferView": view, "componentType": 5126, "count": 3}
    position = builder.add("accessors", {**both, "type": "VEC3"})
    uv = builder.add("accessors", {**both, "type": "VEC2", "byteOffset": 12})
    mesh = scene_of(builder, POSITION=position, TEXCOORD_0=uv)
    np.testing.assert_array_equal(mesh.positions, TRIANGLE)
    np.testing.assert_array_equal(mesh.uvs[0], [[0.5, 0.25]] * 3)


@pytest.mark.parametrize("backed", [True, False])
def test_sparse(backed):
    builder = GltfBuilder()
    sparse = {"count": 2, "indices": {"bufferView": builder.view(np.uint8([0, 2]).tobytes()), "componentType": 5121},
              "values": {"bufferView": builder.view(np.float32([[9, 9, 9], [8, 8, 8]]).tobytes())}}
    if backed:
        position = builder.accessor(TRIANGLE, sparse=sparse)
    else:
        position = builder.add("accessors", {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse})
    mesh = scene_of(builder, POSITION=position)
    np.testing.assert_array_equal(mesh.positions, [[9, 9, 9], [1, 0, 0] if backed else [0, 0, 0], [8, 8, 8]])


@pytest.mark.parametrize("change, place", [
    ({"count": 4}, r"accessors\[0\]\.count"), ({"count": 2**53}, r"accessors\[0\]\.count"),
    ({"count": 2.5}, r"accessors\[0\]\.count"),
    ({"byteOffset": 4}, r"accessors\[0\]\.count"),
    ({"bufferView": 7}, r"accessors\[0\]\.bufferView: index 7, but only 0 exists"),
    ({"componentType": 5124}, r"accessors\[0\]\.componentType"), ({"type": "VEC2"}, r"accessors\[0\]\.type"),
    ({"count": "3"}, r"accessors\[0\]\.count"), ({"count": -3}, r"accessors\[0\]\.count")])
def test_bad_accessors_name_their_place(change, place):
    builder = GltfBuilder()
    position = builder.accessor(TRIANGLE)
    builder.json["accessors"][0].update(change)
    with pytest.raises(InputError, match=place):
        scene_of(builder, POSITION=position)


@pytest.mark.parametrize("change, place", [
    ({"byteLength": 10**9}, r"bufferViews\[0\]\.byteLength"), ({"byteStride": 4}, r"bufferViews\[0\]\.byteStride"),
    ({"buffer": 3}, r"bufferViews\[0\]\.buffer")])
def test_bad_buffer_views_name_their_place(change, place):
    builder = GltfBuilder()
    position = builder.accessor(TRIANGLE)
    builder.json["bufferViews"][0].update(change)
    with pytest.raises(InputError, match=place):
        scene_of(builder, POSITION=position)


def test_elements_without_data_are_bounded():
    builder = GltfBuilder()
    position = builder.add("accessors", {"componentType": 5126, "count": 1 << 25, "type": "VEC3"})
    with pytest.raises(InputError, match=r"accessors\[0\]: .*too many"):
        scene_of(builder, POSITION=position)


def test_sharing_is_bounded_by_the_size_of_the_file():
    """Each primitive would take 65534 flat-shaded vertices of ours, and the file 50 more bytes."""
    builder = GltfBuilder()
    primitive = {"attributes": {"POSITION": builder.accessor(TRIANGLE)},
                 "indices": builder.accessor(np.zeros(65535), "uint8")}
    builder.node(mesh=builder.add("meshes", {"primitives": [primitive] * 300}))
    with pytest.raises(InputError, match=r"meshes\[0\]\.primitives\[256\]: .*too many"):
        builder.load()
