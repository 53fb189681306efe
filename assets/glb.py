"""A small glTF 2.0 binary writer and the surfaces of revolution that the project's own scenes are made of."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from PIL import Image

Shape = dict[str, np.ndarray]
"""Vertex attributes by their glTF names, and "indices"."""

_COMPONENTS = {"f4": 5126, "u4": 5125, "u2": 5123, "u1": 5121}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class Glb:
    """Collects a scene; materials, samplers and nodes are written as glTF's own JSON."""

    def __init__(self) -> None:
        self.json: dict = {"asset": {"version": "2.0", "generator": "pbr-viewer assets"}, "scene": 0,
                           "scenes": [{"nodes": []}]}
        self._binary = bytearray()
        self._shapes: dict[int, tuple[Shape, dict]] = {}

    def add(self, kind: str, entry: dict) -> int:
        """Appends to one of the file's arrays; the index it got."""
        entries = self.json.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def texture(self, pixels: np.ndarray, jpeg: int = 0, **sampler: int) -> dict:
        """A textureInfo of (H, W), (H, W, 3 or 4) values in [0, 1] or uint8; `jpeg` is its quality, 0 makes a PNG."""
        if pixels.dtype != np.uint8:
            pixels = (np.clip(pixels, 0, 1) * 255 + 0.5).astype(np.uint8)
        encoded = io.BytesIO()
        options = {"quality": jpeg, "subsampling": 0} if jpeg else {"optimize": True}
        Image.fromarray(pixels).save(encoded, "JPEG" if jpeg else "PNG", **options)
        image = self.add("images", {"bufferView": self._view(encoded.getvalue()),
                                    "mimeType": "image/jpeg" if jpeg else "image/png"})
        texture = {"source": image} | ({"sampler": self.add("samplers", sampler)} if sampler else {})
        return {"index": self.add("textures", texture)}

    def material(self, color=(1, 1, 1, 1), metallic: float = 0.0, roughness: float = 0.5, **fields) -> int:
        """A material; `fields` are glTF's, those named *Texture that belong there go to pbrMetallicRoughness."""
        pbr = {"baseColorFactor": [*color, 1][:4], "metallicFactor": metallic, "roughnessFactor": roughness}
        for name in ("baseColorTexture", "metallicRoughnessTexture"):
            if name in fields:
                pbr[name] = fields.pop(name)
        return self.add("materials", {"pbrMetallicRoughness": pbr, **fields})

    def mesh(self, shape: Shape, material: int | None, mode: int = 4) -> int:
        """A mesh of one primitive; a shape used again shares its accessors."""
        if id(shape) not in self._shapes:
            attributes = {name: self._accessor(values, 34962) for name, values in shape.items() if name != "indices"}
            primitive = {"attributes": attributes}
            if "indices" in shape:
                small = len(shape["POSITION"]) < 65536
                primitive["indices"] = self._accessor(shape["indices"].astype("u2" if small else "u4"), 34963)
            self._shapes[id(shape)] = shape, primitive
        primitive = self._shapes[id(shape)][1] | {"mode": mode}
        return self.add("meshes", {"primitives": [primitive | ({} if material is None else {"material": material})]})

    def node(self, mesh: int | None = None, root: bool = True, **fields) -> int:
        """A node of the scene, with glTF's fields; `root` is False for another node's child."""
        node = self.add("nodes", fields | ({} if mesh is None else {"mesh": mesh}))
        if root:
            self.json["scenes"][0]["nodes"].append(node)
        return node

    def instances(self, mesh: int, translations: np.ndarray, rotations: np.ndarray, scales: np.ndarray) -> int:
        """A node that draws a mesh many times: (N, 3), unit quaternions (N, 4), (N, 3)."""
        placed = {"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales}
        attributes = {name: self._accessor(values.astype("f4"), None) for name, values in placed.items()}
        self.json["extensionsUsed"] = [*self.json.get("extensionsUsed", ()), "EXT_mesh_gpu_instancing"]
        return self.node(mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})

    def animation(self, name: str, *channels: tuple[int, str, list[float], np.ndarray]) -> None:
        """Each channel moves a node: its number, the path (such as "rotation"), the times, and a value for each."""
        samplers, listed = [], []
        for node, path, times, values in channels:
            moments = self._accessor(np.array(times, float), None)
            self.json["accessors"][moments] |= {"min": [min(times)], "max": [max(times)]}
            listed.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
            samplers.append({"input": moments, "output": self._accessor(np.array(values, float), None)})
        self.add("animations", {"name": name, "samplers": samplers, "channels": listed})

    def light(self, kind: str, eye, target=(0, 0, 0), **fields) -> None:
        """A punctual light at `eye` that shines at `target`."""
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": kind, **fields})
        self.node(matrix=pose(eye, target), extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def camera(self, eye, target=(0, 0, 0), fov: float = 30.0) -> None:
        """A perspective camera; `fov` is vertical, in degrees. The scenes are placed to fill a square picture."""
        distance = float(np.linalg.norm(np.subtract(eye, target)))
        lens = {"yfov": np.radians(fov), "znear": distance / 100, "zfar": distance * 100}
        self.node(camera=self.add("cameras", {"type": "perspective", "perspective": lens}), matrix=pose(eye, target))

    def save(self, path: Path) -> None:
        used = sorted(_extensions(self.json))
        head = self.json | {"buffers": [{"byteLength": len(self._binary)}]} | ({"extensionsUsed": used} if used else {})
        text = json.dumps(head, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self._binary), b"BIN\0") + self._binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)

    def _view(self, data: bytes, **fields) -> int:
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)} | fields)
        self._binary += data + b"\0" * (-len(data) % 4)
        return view

    def _accessor(self, values: np.ndarray, target: int | None) -> int:
        values = np.ascontiguousarray(values, "f4" if values.dtype.kind == "f" else values.dtype)
        width = 1 if values.ndim == 1 else values.shape[1]
        view = self._view(values.tobytes(), **({} if target is None else {"target": target}))
        accessor = {"bufferView": view, "count": len(values),
                    "componentType": _COMPONENTS[values.dtype.str[1:]], "type": _TYPES[width]}
        if values.dtype == np.uint8:
            accessor["normalized"] = True
        if width == 3:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        return self.add("accessors", accessor)


def save_scenes(scenes: Sequence[Callable[[], Glb]], folder: Path) -> None:
    """Writes what each function makes to a file with its name in `folder`, and tells how large it is."""
    folder.mkdir(exist_ok=True)
    for scene in scenes:
        path = folder / f"{scene.__name__.replace('_', '-')}.glb"
        scene().save(path)
        print(f"{path.name:20} {path.stat().st_size:6} bytes")


def lathe(*pieces, segments: int = 48) -> Shape:
    """A surface of revolution about +Y of profiles (n, 2) of (radius, height), smooth within each, creased between.

    A profile has its outside on its right. u grows counter-clockwise seen from above from +Z on; v runs along the
    profiles by length, 1 at their start. A profile that ends where it began is closed smoothly.
    """
    pieces = [np.asarray(piece, float) for piece in pieces]
    steps = [np.hypot(*np.diff(piece, axis=0).T) for piece in pieces]
    total, start, shapes = sum(map(np.sum, steps)), 0.0, []
    u = np.linspace(0, 1, segments + 1)
    around = np.stack([np.sin(2 * np.pi * u), np.cos(2 * np.pi * u)], -1)
    for piece, step in zip(pieces, steps):
        v = 1 - (start + np.r_[0, np.cumsum(step)]) / total
        start += step.sum()
        closed = np.allclose(piece[0], piece[-1])
        wrapped = np.r_[piece[-2:-1], piece, piece[1:2]] if closed else piece
        along = np.gradient(wrapped, axis=0, edge_order=min(2, len(wrapped) - 1))
        along = along[1:-1] if closed else along
        outward = np.stack([along[:, 1], -along[:, 0]], -1)
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        shapes.append(grid(
            np.stack([piece[:, :1] * around[:, 0], np.repeat(piece[:, 1:], segments + 1, 1),
                      piece[:, :1] * around[:, 1]], -1),
            np.stack([outward[:, :1] * around[:, 0], np.repeat(outward[:, 1:], segments + 1, 1),
                      outward[:, :1] * around[:, 1]], -1),
            np.stack(np.meshgrid(u, v), -1),
            np.stack([around[:, 1], 0 * u, -around[:, 0], 0 * u + 1], -1)[None].repeat(len(piece), 0)))
    return merge(*shapes)


def grid(positions, normals, uvs, tangents) -> Shape:
    """Quads between (rows, columns, n) vertices, rows going up and columns to the right seen from outside."""
    rows, columns = positions.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    quads = np.stack([corner, corner + 1, corner + columns + 1, corner, corner + columns + 1, corner + columns], -1)
    flat = {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs, "TANGENT": tangents}
    shape = {name: values.reshape(-1, values.shape[-1]) for name, values in flat.items()}
    triangles = quads.reshape(-1, 3)
    sides = np.diff(shape["POSITION"][triangles], axis=1)
    real = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) > 1e-12 * np.ptp(positions)**2
    return shape | {"indices": triangles[real].ravel()}


def merge(*shapes: Shape) -> Shape:
    """One shape of several with the same attributes."""
    starts = np.cumsum([0] + [len(shape["POSITION"]) for shape in shapes])
    merged = {name: np.concatenate([shape[name] for shape in shapes]) for name in shapes[0]}
    return merged | {"indices": np.concatenate([s["indices"] + start for s, start in zip(shapes, starts)])}


def moved(shape: Shape, offset=(0, 0, 0), scale: float = 1.0) -> Shape:
    return shape | {"POSITION": shape["POSITION"] * scale + np.asarray(offset)}


def arc(radius: float, height: float, size: float, first: float, last: float, count: int) -> np.ndarray:
    """A profile: part of a circle about (radius, height), from one angle to another in degrees, 0 pointing outwards."""
    angle = np.radians(np.linspace(first, last, count))
    return np.stack([radius + size * np.cos(angle), height + size * np.sin(angle)], -1)


def sphere(radius: float = 1.0, segments: int = 32) -> Shape:
    profile = arc(0, 0, radius, -90, 90, segments // 2 + 1)
    profile[[0, -1], 0] = 0
    return lathe(profile, segments=segments)


def torus(radius: float, size: float, segments: int = 48, rings: int = 24) -> Shape:
    profile = arc(radius, 0, size, -180, 180, rings + 1)
    profile[-1] = profile[0]
    return lathe(profile, segments=segments)


def plate(width: float, height: float, columns: int = 1, rows: int = 1) -> Shape:
    """A rectangle about the origin that faces +Z."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(1, 0, rows + 1))
    position = np.stack([(u - 0.5) * width, (0.5 - v) * height, 0 * u], -1)
    constant = [np.broadcast_to(np.array(value, float), (*u.shape, len(value))) for value in ((0, 0, 1), (1, 0, 0, 1))]
    return grid(position, constant[0], np.stack([u, v], -1), constant[1])


def without(shape: Shape, *names: str) -> Shape:
    return {name: values for name, values in shape.items() if name not in names}


def pose(eye, target) -> list[float]:
    """The column-major matrix of a thing at `eye` whose -Z points at `target`."""
    back = np.subtract(eye, target).astype(float)
    back /= np.linalg.norm(back)
    right = np.cross([0, 0, -1] if abs(back[1]) > 0.999 else [0, 1, 0], back)
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :] = np.stack([right, np.cross(back, right), back, np.asarray(eye, float)], -1)
    return pose.T.ravel().tolist()


def _extensions(part) -> set[str]:
    """The names of all extensions used anywhere in the JSON."""
    if isinstance(part, list):
        return set().union(*map(_extensions, part))
    if isinstance(part, dict):
        return set(part.get("extensions", ())) | set().union(*map(_extensions, part.values()))
    return set()
