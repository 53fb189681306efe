"""Scenes made for measuring growth: so many triangles, materials, lights, textures or instances."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from assets.glb import Glb, Shape

SIDE = 2048
"""Texels along each side of a texture."""


def write(kind: str, count: int, folder: Path) -> Path:
    """The scene's file in `folder`, made if it is not there; `kind` is one of KINDS."""
    path = folder / f"{kind}-{count}.glb"
    if not path.is_file():
        _MAKERS[kind](count).save(path)
    return path


def hills(triangles: int) -> Glb:
    """One mesh, a rough ball."""
    glb = Glb()
    glb.node(glb.mesh(_ball(triangles, bumps=0.05), glb.material((0.6, 0.5, 0.4))))
    return glb


def kinds_of_materials(count: int) -> Glb:
    """As many balls as materials, which differ in what they have, not in numbers alone: 200 are of 196 kinds."""
    glb, rng = Glb(), np.random.default_rng(1)
    texture = glb.texture(rng.integers(100, 255, (16, 16, 3), np.uint8))
    names = ("baseColorTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture", "emissiveTexture")
    ball = _ball(200)
    for k in range(count):
        bits = rng.integers(1 << len(names))
        fields: dict = {name: texture for bit, name in enumerate(names) if bits >> bit & 1}
        fields |= {"emissiveFactor": [0.1, 0.1, 0.1], "doubleSided": bool(rng.integers(2)),
                   "alphaMode": ("OPAQUE", "MASK", "BLEND")[rng.integers(3)]}
        material = glb.material(rng.random(3).tolist(), (0.0, 0.5, 1.0)[rng.integers(3)], float(rng.random()), **fields)
        glb.node(glb.mesh(ball, material), translation=_place(k, count))
    return glb


def lamps(count: int) -> Glb:
    """A ball under spots, point and directional lights in turn."""
    glb, rng = Glb(), np.random.default_rng(1)
    glb.node(glb.mesh(_ball(20_000), glb.material((0.6, 0.5, 0.4))))
    for k in range(count):
        eye = rng.normal(size=3)
        eye *= 3 / np.linalg.norm(eye)
        kind = ("spot", "point", "directional")[k % 3]
        glb.light(kind, eye.tolist(), intensity=20.0 / count, **({"spot": {}} if kind == "spot" else {}))
    return glb


def pictures(count: int) -> Glb:
    """As many balls as textures of 2048 x 2048, JPEG; at least one ball."""
    glb, ball = Glb(), _ball(2_000)
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32) / SIDE
    waves = np.stack([0.5 + 0.4 * np.sin(40 * x + 9 * y), y, 0.5 + 0.4 * np.cos(60 * y)], axis=-1)
    waves = (255 * waves).astype(np.uint8)
    for k in range(max(count, 1)):
        shifted = np.roll(waves, 31 * k, axis=0)
        fields = {"baseColorTexture": glb.texture(shifted, jpeg=85)} if count else {}
        glb.node(glb.mesh(ball, glb.material(roughness=0.4, **fields)), translation=_place(k, count))
    return glb


def crowd(count: int) -> Glb:
    """As many instances of one ball of 80 triangles, turned and stretched, in a cube."""
    glb, rng = Glb(), np.random.default_rng(1)
    side = int(np.ceil(count ** (1 / 3)))
    places = np.stack(np.unravel_index(np.arange(count), (side,) * 3), axis=1) * 3 + rng.uniform(-0.5, 0.5, (count, 3))
    turns = rng.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    mesh = glb.mesh(_ball(80), glb.material((0.6, 0.5, 0.4)))
    glb.instances(mesh, places, turns, rng.uniform(0.5, 1.2, (count, 3)))
    return glb


def _ball(triangles: int, bumps: float = 0.0) -> Shape:
    """About so many triangles, with normals and texture coordinates."""
    rows = max(int((triangles / 4) ** 0.5), 2)
    columns = 2 * rows
    v, u = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    theta, phi = np.pi * v, 2 * np.pi * u
    normals = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    radius = 1 + bumps * np.sin(16 * phi) * np.sin(16 * theta)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = corner + columns + 1
    indices = np.stack([corner, below, corner + 1, corner + 1, below, below + 1], axis=1)
    return {"POSITION": (normals * radius[..., None]).reshape(-1, 3).astype(np.float32),
            "NORMAL": normals.reshape(-1, 3).astype(np.float32),
            "TEXCOORD_0": np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
            "indices": indices.ravel().astype(np.uint32)}


def _place(k: int, count: int) -> list[float]:
    side = int(np.ceil(max(count, 1) ** 0.5))
    return [2.2 * (k % side), 2.2 * (k // side), 0.0]


_MAKERS: dict[str, Callable[[int], Glb]] = {
    "triangles": hills, "materials": kinds_of_materials, "lights": lamps, "textures": pictures,
    "instances": crowd}
KINDS = tuple(_MAKERS)
