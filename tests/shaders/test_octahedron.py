"""Normals in two numbers and in one: what is read is what was written, within the steps."""

from __future__ import annotations

import numpy as np

from viewer import call_glsl

FILE = "sample/octahedron.glsl"


def directions(count: int = 4096) -> np.ndarray:
    """On a golden spiral, and along the axes and edges of the octahedron."""
    z = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (1 + 5**0.5) * np.arange(count)
    spiral = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], axis=1)
    signs = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float)
    return np.concatenate([spiral, signs / np.linalg.norm(signs, axis=1)[:, None]])


def test_a_direction_comes_back():
    d = directions()
    points = call_glsl(FILE, "to_octahedron", d=d)
    assert np.abs(points).max() <= 1 + 1e-6
    assert np.abs(call_glsl(FILE, "from_octahedron", p=points) - d).max() < 1e-6


def test_a_packed_direction_is_a_whole_number_and_comes_back_within_steps():
    d = directions()
    packed = call_glsl(FILE, "pack_octahedron", p=call_glsl(FILE, "to_octahedron", d=d))
    assert np.array_equal(packed, np.round(packed)) and packed.min() >= 2 and packed.max() < 2**23
    found = call_glsl(FILE, "from_octahedron", p=call_glsl(FILE, "unpack_octahedron", packed_point=packed))
    angle = np.degrees(2 * np.arcsin(np.linalg.norm(found - d, axis=1) / 2))
    assert angle.max() < 0.12  # half a step of 2 / 2047 each way
    assert len(np.unique(packed[:4096])) == 4096
