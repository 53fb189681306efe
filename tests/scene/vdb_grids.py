"""Grids that tests write as OpenVDB files."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from assets.vdb import VdbGrid, vdb_bytes
from viewer.scene.scene import Scene
from viewer.scene.vdb.load import load_vdb

SHEARED = np.array([[0.1, 0.2, 0, 3], [0, 0.3, 0.05, 4], [0, 0, -0.5, -1], [0, 0, 0, 1]])


def puff(shape=(13, 18, 9), seed: int = 0, holes: float = 0.4) -> np.ndarray:
    """Random values, 0 in some voxels, and a leaf of one value."""
    random = np.random.default_rng(seed)
    values = np.where(random.random(shape) > holes, random.random(shape), 0).astype(np.float32)
    values[:8, :8, :8] = 0.5
    return values


def blosc(data: bytes) -> bytes:
    from numcodecs import blosc as packer

    if not data:  # which this one refuses, and Blosc does not
        return bytes([2, 1, 0x33, 4]) + struct.pack("<3I", 0, 1, 16)
    return packer.compress(data, b"lz4", 9, packer.SHUFFLE)


def load(*grids: VdbGrid, version: int = 224) -> Scene:
    return load_vdb(Path("some.vdb"), vdb_bytes(grids, version))
