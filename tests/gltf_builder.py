"""Makes small glTF files in memory, valid or broken on purpose."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
from PIL import Image

from viewer.scene.gltf import load_gltf
from viewer.scene.scene import Scene

COMPONENTS = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfBuilder:
    """Holds the JSON as a dictionary, which tests may change as they like, and the binary chunk."""

    def __init__(self, **top_level) -> None:
        self.json: dict = {"asset": {"version": "2.0"}, **top_level}
        self.blob = bytearray()

    def add(self, key: str, element: dict) -> int:
        """Append to a top-level array; the new element's index."""
        self.json.setdefault(key, []).append(element)
        return len(self.json[key]) - 1

    def view(self, data: bytes, **extra) -> int:
        self.blob += b"\0" * (-len(self.blob) % 4)
        offset = len(self.blob)
        self.blob += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": offset, "byteLength": len(data), **extra})

    def accessor(self, array, dtype: str = "float32", **extra) -> int:
        """An accessor of a (count,) or (count, components) array in a buffer view of its own."""
        array = np.ascontiguousarray(array, dtype)
        columns = 1 if array.ndim == 1 else array.shape[1]
        return self.add("accessors", {"bufferView": self.view(array.tobytes()), "componentType": COMPONENTS[dtype],
                                      "count": len(array), "type": TYPES[columns], **extra})

    def texture(self, pixels=None, **sampler) -> int:
        """A texture of (H, W, C) uint8 pixels, one white texel by default, as a PNG in a buffer view."""
        pixels = np.full((1, 1, 3), 255, np.uint8) if pixels is None else pixels
        image = self.add("images", {"bufferView": self.view(png_bytes(pixels)), "mimeType": "image/png"})
        return self.add("textures", {"source": image, "sampler": self.add("samplers", sampler)})

    def mesh(self, attributes: dict[str, int], **primitive) -> int:
        return self.add("meshes", {"primitives": [{"attributes": attributes, **primitive}]})

    def node(self, root: bool = True, **node) -> int:
        index = self.add("nodes", node)
        if root:
            self.json.setdefault("scenes", [{"nodes": []}])[0]["nodes"].append(index)
        return index

    def triangle(self, **primitive) -> int:
        """A mesh of one triangle in the plane z = 0, facing +z; its index."""
        return self.mesh({"POSITION": self.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]])}, **primitive)

    def glb(self) -> bytes:
        blob = bytes(self.blob) + b"\0" * (-len(self.blob) % 4)
        if blob:
            self.json.setdefault("buffers", [{"byteLength": len(blob)}])
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if blob:
            chunks += struct.pack("<II", len(blob), 0x004E4942) + blob
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def load(self, scene_index: int | None = None) -> Scene:
        """What our reader makes of it."""
        return load_gltf(Path("memory.glb"), self.glb(), scene_index)


def png_bytes(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels).save(out, "PNG")
    return out.getvalue()


def triangle_glb() -> bytes:
    """The smallest scene that draws something."""
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    return builder.glb()
