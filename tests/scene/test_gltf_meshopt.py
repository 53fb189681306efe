"""Buffer views that meshoptimizer has compressed: every mode and filter, and data that is broken or lies."""

from __future__ import annotations

import resource

import meshopt
import numpy as np
import pytest
from byte_mutations import mutations
from gltf_builder import GltfBuilder

from viewer.errors import InputError

EXTENSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
COUNT = 42
RNG = np.random.default_rng(0)
POSITIONS = RNG.integers(-3000, 3000, (COUNT, 4)).astype(np.int16)  # the fourth is padding
TRIANGLES = RNG.integers(0, COUNT, 90)
NORMALS = RNG.normal(size=(COUNT, 4))
NORMALS /= np.linalg.norm(NORMALS[:, :3], axis=1, keepdims=True)


class Compressing(GltfBuilder):
    """Adds compressed views; their own buffer has no bytes."""

    def __init__(self, extension: str = EXTENSIONS[0]) -> None:
        super().__init__(extensionsUsed=[extension, "KHR_mesh_quantization"], extensionsRequired=[extension])
        self.extension = extension

    def compressed(self, data: bytes, count: int, stride: int, mode: str = "ATTRIBUTES", **extra) -> int:
        """A view of `count` rows of `stride` bytes, which `data` holds in compressed form."""
        self.view(data)
        stored = self.json["bufferViews"].pop()
        how = {**stored, "count": count, "byteStride": stride, "mode": mode, **extra}
        strided = {"byteStride": stride} if mode == "ATTRIBUTES" else {}
        return self.add("bufferViews", {"buffer": 1, "byteLength": count * stride, **strided,
                                        "extensions": {self.extension: how}})

    def of_view(self, view: int, component: int, kind: str, count: int = COUNT, **extra) -> int:
        return self.add("accessors", {"bufferView": view, "componentType": component, "type": kind, "count": count,
                                      **extra})

    def positions(self, version: int = 0) -> int:
        data = meshopt.encode_gltf_buffer(POSITIONS, "ATTRIBUTES", version)
        return self.of_view(self.compressed(data, COUNT, 8), 5122, "VEC3")

    def draw(self, **attributes):
        if "POSITION" not in attributes:
            attributes["POSITION"] = self.positions()
        indices = attributes.pop("indices", None)
        self.node(mesh=self.mesh(attributes, **({} if indices is None else {"indices": indices})))
        self.json["buffers"] = [{"byteLength": len(self.blob)},
                                {"byteLength": 1 << 20, "extensions": {self.extension: {"fallback": True}}}]
        return self.load().meshes[0]


@pytest.mark.parametrize("extension, version", [(EXTENSIONS[0], 0), (EXTENSIONS[1], 0), (EXTENSIONS[1], 1)])
def test_vertices(extension, version):
    builder = Compressing(extension)
    mesh = builder.draw(POSITION=builder.positions(version))
    np.testing.assert_array_equal(mesh.positions, POSITIONS[:, :3])


@pytest.mark.parametrize("mode", ["TRIANGLES", "INDICES"])
@pytest.mark.parametrize("dtype, component", [(np.uint16, 5123), (np.uint32, 5125)])
def test_indices(mode, dtype, component):
    builder = Compressing()
    data = meshopt.encode_gltf_buffer(TRIANGLES.astype(np.uint32), mode)
    view = builder.compressed(data, 90, np.dtype(dtype).itemsize, mode)
    got = builder.draw(NORMAL=builder.accessor(NORMALS[:, :3]),
                       indices=builder.of_view(view, component, "SCALAR", 90)).indices.reshape(-1, 3)
    expected = TRIANGLES.reshape(-1, 3)
    if mode == "TRIANGLES":  # the codec may turn a triangle's corners round
        turns = [np.roll(got, k, axis=1) for k in range(3)]
        assert np.any([np.all(turn == expected, axis=1) for turn in turns], axis=0).all()
    else:
        np.testing.assert_array_equal(got, expected)


@pytest.mark.parametrize("stride, component, error", [(4, 5120, 0.02), (8, 5122, 1e-4)])
def test_octahedral_normals(stride, component, error):
    builder = Compressing()
    data = meshopt.encode_gltf_buffer(meshopt.encode_filter_oct(NORMALS, stride, 8 if stride == 4 else 16),
                                      "ATTRIBUTES")
    view = builder.compressed(data, COUNT, stride, filter="OCTAHEDRAL")
    mesh = builder.draw(NORMAL=builder.of_view(view, component, "VEC3", normalized=True))
    np.testing.assert_allclose(mesh.normals, NORMALS[:, :3], atol=error)


def test_exponential_texture_coordinates():
    uv = RNG.uniform(-4, 4, (COUNT, 2))
    builder = Compressing()
    data = meshopt.encode_gltf_buffer(meshopt.encode_filter_exp(uv, 20), "ATTRIBUTES")
    view = builder.compressed(data, COUNT, 8, filter="EXPONENTIAL")
    np.testing.assert_allclose(builder.draw(TEXCOORD_0=builder.of_view(view, 5126, "VEC2")).uvs[0], uv, atol=1e-4)


@pytest.mark.parametrize("stride, component, error", [(4, 5121, 0.02), (8, 5123, 1e-4)])
def test_colors(stride, component, error):
    colors = RNG.uniform(0, 1, (COUNT, 4))
    builder = Compressing(EXTENSIONS[1])
    data = meshopt.encode_gltf_buffer(meshopt.encode_filter_color(colors, stride, 8 if stride == 4 else 16),
                                      "ATTRIBUTES", 1)
    view = builder.compressed(data, COUNT, stride, filter="COLOR")
    mesh = builder.draw(COLOR_0=builder.of_view(view, component, "VEC4", normalized=True))
    np.testing.assert_allclose(mesh.colors, colors, atol=error)


def test_quaternions():
    """No mesh has them, but instances and animations do."""
    quaternions = RNG.normal(size=(COUNT, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    builder = Compressing()
    data = meshopt.encode_gltf_buffer(meshopt.encode_filter_quat(quaternions, 8, 16), "ATTRIBUTES")
    view = builder.compressed(data, COUNT, 8, filter="QUATERNION")
    got = builder.draw(TEXCOORD_0=builder.of_view(view, 5122, "VEC2", normalized=True)).uvs[0]
    same, other = np.abs(got - quaternions[:, :2]), np.abs(got + quaternions[:, :2])  # q and -q are one rotation
    assert np.minimum(same.max(axis=1), other.max(axis=1)).max() < 1e-3


@pytest.mark.parametrize("change, place", [
    ({"mode": "WAT"}, "mode"), ({"mode": 3}, "mode"), ({"filter": "X"}, "filter"), ({"byteStride": 6}, "byteStride"),
    ({"byteStride": 260}, "byteStride"), ({"filter": "OCTAHEDRAL", "byteStride": 12}, "byteStride"),
    ({"filter": "QUATERNION", "byteStride": 4}, "byteStride"), ({"mode": "TRIANGLES"}, "byteStride"),
    ({"mode": "INDICES", "byteStride": 4, "filter": "OCTAHEDRAL"}, "filter"),
    ({"mode": "TRIANGLES", "byteStride": 4, "count": 43}, "count"), ({"count": 41}, "byteLength"),
    ({"count": -1}, "count"), ({"byteLength": 10**9}, "byteLength"), ({"byteLength": 30}, "compressed data"),
    ({"byteOffset": 5}, "ends at byte"), ({"buffer": 7}, "buffer"), ({"buffer": 1}, r"buffers\[1\]")])
def test_bad_properties_name_their_place(change, place):
    builder = Compressing()
    position = builder.positions()
    builder.json["bufferViews"][0]["extensions"][builder.extension].update(change)
    with pytest.raises(InputError, match=place):
        builder.draw(POSITION=position)


def test_a_bomb_is_refused():
    """Constant rows, of which version 1 stores nearly nothing, used often enough for 4 GB."""
    rows = 1 << 18
    builder = Compressing(EXTENSIONS[1])
    builder.compressed(meshopt.encode_vertex_buffer_level(np.zeros((rows, 64), np.uint32), 3, 1), rows, 256)
    assert len(builder.blob) < 1 << 20
    builder.json["bufferViews"] *= 64
    uses = [{"attributes": {"POSITION": builder.of_view(view, 5126, "VEC3", rows)}} for view in range(64)]
    builder.json["meshes"] = [{"primitives": uses}]
    builder.node(mesh=0)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match="are too many for buffers of this size"):
        builder.load()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1 << 20  # KiB


def test_broken_data_does_no_harm():
    """A sample of what 10,000 mutations of each mode and each filter were tried for."""
    encoded = [(meshopt.encode_gltf_buffer(POSITIONS, "ATTRIBUTES", version), COUNT, 8, "ATTRIBUTES", "NONE")
               for version in (0, 1)]
    encoded += [(meshopt.encode_gltf_buffer(TRIANGLES.astype(np.uint32), mode), 90, 4, mode, "NONE")
                for mode in ("TRIANGLES", "INDICES")]
    filtered = {"OCTAHEDRAL": meshopt.encode_filter_oct(NORMALS, 8, 12),
                "QUATERNION": meshopt.encode_filter_quat(NORMALS, 8, 16),
                "EXPONENTIAL": meshopt.encode_filter_exp(NORMALS[:, :2], 20),
                "COLOR": meshopt.encode_filter_color(np.abs(NORMALS), 8, 16)}
    encoded += [(meshopt.encode_gltf_buffer(values, "ATTRIBUTES", 1), COUNT, 8, "ATTRIBUTES", name)
                for name, values in filtered.items()]
    refused = 0
    for data, count, stride, mode, name in encoded:
        for broken in mutations(data, 100 if name == "NONE" else 25):
            builder = Compressing(EXTENSIONS[1])
            view = builder.compressed(broken, count, stride, mode, filter=name)
            try:
                if mode == "ATTRIBUTES":
                    builder.draw(POSITION=builder.of_view(view, 5122, "VEC3"))
                else:
                    builder.draw(NORMAL=builder.accessor(NORMALS[:, :3]),
                                 indices=builder.of_view(view, 5125, "SCALAR", 90))
            except InputError:
                refused += 1
    assert refused > 100
