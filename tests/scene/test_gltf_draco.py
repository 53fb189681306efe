"""Primitives that Draco has compressed, and data that is broken or lies."""

from __future__ import annotations

import DracoPy
import numpy as np
import pytest
from byte_mutations import mutations
from gltf_builder import GltfBuilder

from viewer.base.apart import apart
from viewer.errors import InputError
from viewer.scene.gltf import draco

SIDE = 9
_X, _Y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
POSITIONS = np.stack([_X.ravel(), _Y.ravel(), np.sin(_X + 0.5 * _Y).ravel()], axis=1).astype(np.float32)
COUNT = len(POSITIONS)
_CORNER = np.arange(COUNT).reshape(SIDE, SIDE)[:-1, :-1].ravel()
FACES = np.concatenate([_CORNER[:, None] + (0, 1, SIDE), _CORNER[:, None] + (1, SIDE + 1, SIDE)]).astype(np.uint32)
NORMALS = np.tile([0.0, 0.0, 1.0], (COUNT, 1))
UVS = POSITIONS[:, :2].astype(np.float64) / SIDE
COLORS = np.stack([_X.ravel() * 20, _Y.ravel() * 20, np.full(COUNT, 7), np.full(COUNT, 255)], axis=1).astype(np.uint8)
JOINTS = (np.arange(COUNT)[:, None] % (2, 3, 1, 1)).astype(np.uint16)
WEIGHTS = np.tile(np.uint8([200, 55, 0, 0]), (COUNT, 1))


class Compressing(GltfBuilder):
    def __init__(self) -> None:
        super().__init__(extensionsUsed=[draco.EXTENSION], extensionsRequired=[draco.EXTENSION])

    def primitive(self, data: bytes, numbers: dict[str, int], count: int = COUNT, faces: int = len(FACES),
                  **extra) -> dict:
        """A primitive whose accessors have no buffer view; `numbers` are the attributes' unique ids in `data`."""
        kinds = {"POSITION": (5126, "VEC3", {}), "NORMAL": (5126, "VEC3", {}), "TEXCOORD_0": (5126, "VEC2", {}),
                 "COLOR_0": (5121, "VEC4", {"normalized": True}), "JOINTS_0": (5123, "VEC4", {}),
                 "WEIGHTS_0": (5121, "VEC4", {"normalized": True})}
        attributes = {}
        for key in numbers:
            component, kind, more = kinds[key]
            attributes[key] = self.add("accessors", {"componentType": component, "type": kind, "count": count, **more})
        indices = self.add("accessors", {"componentType": 5123, "type": "SCALAR", "count": 3 * faces})
        compressed = {"bufferView": self.view(data), "attributes": numbers}
        return {"attributes": attributes, "indices": indices, "extensions": {draco.EXTENSION: compressed}, **extra}

    def draw(self, primitive: dict, **node):
        self.node(mesh=self.add("meshes", {"primitives": [primitive]}), **node)
        return self.load()


def encoded(**options) -> bytes:
    return DracoPy.encode(POSITIONS, FACES, quantization_bits=20, **{"normals": NORMALS, **options})


def numbers_of(data: bytes) -> dict[str, int]:
    """The unique ids of what is no generic attribute."""
    names = {0: "POSITION", 1: "NORMAL", 2: "COLOR_0", 3: "TEXCOORD_0"}
    return {names[a["attribute_type"]]: a["unique_id"] for a in DracoPy.decode(data).attributes
            if a["attribute_type"] in names}


def corners(mesh, values) -> np.ndarray:
    """The values at the corners of all triangles in an order of their own, since Draco keeps none."""
    rows = values[mesh.indices.reshape(-1, 3)]
    return rows[np.lexsort(np.round(mesh.positions[mesh.indices].reshape(-1, 9)[:, [0, 1, 3, 4, 6, 7]], 2).T)]


def expected_corners(mesh, values) -> np.ndarray:
    """As `corners` gives for what was encoded: each corner is found by its x and y."""
    x, y = np.round(mesh.positions[mesh.indices, :2]).astype(int).T
    rows = values[(y * SIDE + x)].reshape(-1, 3, values.shape[1])
    return rows[np.lexsort(np.round(mesh.positions[mesh.indices].reshape(-1, 9)[:, [0, 1, 3, 4, 6, 7]], 2).T)]


@pytest.mark.parametrize("mode", [4, 5])
@pytest.mark.parametrize("level, keeps_order", [(1, False), (10, False), (0, True)])
def test_attributes(mode, level, keeps_order):
    data = encoded(compression_level=level, preserve_order=keeps_order, tex_coord=UVS, colors=COLORS)
    builder = Compressing()
    mesh = builder.draw(builder.primitive(data, numbers_of(data), mode=mode)).meshes[0]
    assert mesh.triangle_count == len(FACES) and mesh.topology == "triangles"
    for got, stored, error in ((mesh.positions, POSITIONS, 1e-4), (mesh.normals, NORMALS, 1e-5),
                               (mesh.uvs[0], UVS, 1e-5), (mesh.colors, COLORS / 255, 1e-6)):
        np.testing.assert_allclose(corners(mesh, got), expected_corners(mesh, stored), atol=error)
    seen = np.cross(*np.diff(mesh.positions[mesh.indices.reshape(-1, 3)], axis=1).transpose(1, 0, 2))
    assert (seen[:, 2] > 0).all()


def test_joints_and_weights_with_morph_targets():
    """Generic attributes by their ids; morph targets are not compressed, so the order of the vertices is kept."""
    data = encoded(preserve_order=True, generic_attributes={5: JOINTS, 7: WEIGHTS})
    builder = Compressing()
    primitive = builder.primitive(data, {**numbers_of(data), "JOINTS_0": 5, "WEIGHTS_0": 7})
    primitive["targets"] = [{"POSITION": builder.accessor(np.tile(np.float32([0, 0, 1]), (COUNT, 1)))}]
    joints = [builder.node(root=False), builder.node(root=False, translation=[0, 30, 0]),
              builder.node(root=False, translation=[0, 0, 900])]
    builder.add("skins", {"joints": joints})
    mesh = builder.draw(primitive, skin=0, weights=[0.5]).meshes[0]
    shifts = np.float32([[0, 0, 0], [0, 30, 0], [0, 0, 900]])
    skinned = POSITIONS + (0, 0, 0.5) + (shifts[JOINTS[:, 0]] * 200 + shifts[JOINTS[:, 1]] * 55) / 255
    got = mesh.positions[mesh.indices.reshape(-1, 3)]
    np.testing.assert_allclose(np.sort(got.reshape(-1, 3), axis=0), np.sort(skinned[FACES.ravel()], axis=0), atol=2e-3)


def test_an_attribute_that_is_not_compressed():
    data = encoded(preserve_order=True)
    builder = Compressing()
    primitive = builder.primitive(data, numbers_of(data))
    primitive["attributes"]["TEXCOORD_0"] = builder.accessor(UVS)
    mesh = builder.draw(primitive).meshes[0]
    np.testing.assert_allclose(corners(mesh, mesh.uvs[0]), expected_corners(mesh, UVS), atol=1e-6)


def test_a_wrong_count_is_told():
    data = encoded()
    builder = Compressing()
    scene = builder.draw(builder.primitive(data, numbers_of(data), count=5, faces=1))
    assert scene.triangle_count == len(FACES)
    assert any(f"has {COUNT} elements for accessors[0] of 5" in line for line in scene.warnings)


HEADER = b"DRACO\x02\x02\x01\x01\x00\x00"


@pytest.mark.parametrize("data, words", [
    (b"", "ends inside its header"), (b"Draco" * 9, "does not begin with 'DRACO'"), (HEADER[:9], "ends inside"),
    (b"DRACO\x01\x03" + HEADER[7:] + bytes(50), r"version 1\.3"), (b"DRACO\x02\x02\x00" + bytes(50), "not a mesh"),
    (HEADER + b"\xff" * 20, "more than 32 bits"), (HEADER + b"\0" + b"\x90\x01\xff\xff\xff\xff\x0f", "too many"),
    (HEADER[:9] + b"\0\x80\0" + b"\0\1\1a" * 40 + bytes(20), "nested too deeply"),
    (HEADER + b"\0" + b"\x90\x01\xf2\x01" + b"\xff" * 60, "is broken")])
def test_broken_headers(data, words):
    builder = Compressing()
    data = data or b"D"
    with pytest.raises(InputError, match=r"primitives\[0\]\.extensions\.KHR_draco_mesh_compression.*" + words):
        builder.draw(builder.primitive(data, {"POSITION": 0}))


@pytest.mark.parametrize("change, words", [
    ({"mode": 1}, r"mode: 1, but KHR_draco"), ({"indices": None}, r"indices: is missing"),
    ({"attributes": {"POSITION": 99}}, r"attributes\.POSITION: the compressed data has no attribute 99"),
    ({"attributes": {"POSITION": -1}}, r"attributes\.POSITION: must be at least 0"),
    ({"type": "VEC2"}, r"accessors\[0\]\.type: 'VEC2', but the compressed data has 3"),
    ({"bufferView": 7}, "bufferView: index 7")])
def test_bad_properties_name_their_place(change, words):
    data = encoded()
    builder = Compressing()
    primitive = builder.primitive(data, numbers_of(data))
    for key, value in change.items():
        if key == "type":
            builder.json["accessors"][0]["type"] = value
        elif key in ("attributes", "bufferView"):
            primitive["extensions"][draco.EXTENSION][key] = value
        elif value is None:
            del primitive[key]
        else:
            primitive[key] = value
    with pytest.raises(InputError, match=words):
        builder.draw(primitive)


def test_metadata_is_passed_over():
    data = encoded(create_metadata=True, generic_attributes={"joints": JOINTS})
    assert data[10] & 128
    builder = Compressing()
    assert builder.draw(builder.primitive(data, numbers_of(data))).triangle_count == len(FACES)


def test_broken_data_does_no_harm():
    """A sample of what 20,000 mutations of larger meshes were tried for. Sixteen of those hung, and were stopped."""
    data = encoded(tex_coord=UVS)
    numbers, refused = numbers_of(data), 0
    for broken in mutations(data, 100):
        builder = Compressing()
        try:
            builder.draw(builder.primitive(broken, numbers))
        except InputError:
            refused += 1
    assert refused > 50
    assert apart.call("viewer.scene.decoders:draco", data, 60, 1 << 28)["faces"].shape == FACES.shape
