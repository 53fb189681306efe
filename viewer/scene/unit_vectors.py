"""Vectors at length 1, and how a square holds them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def unit_vectors(vectors: NDArray) -> NDArray:
    """The vectors (..., 3) at length 1; those without length stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def octahedron(d: NDArray) -> NDArray:
    """Unit vectors (N, 3) as points (N, 2) in [-1, 1], as shaders/sample/octahedron.glsl; 0 for 0."""
    p = d[:, :2] / np.maximum(np.abs(d).sum(axis=1, keepdims=True), 1e-30)
    return np.where(d[:, 2:] < 0, (1 - np.abs(p[:, ::-1])) * np.where(p >= 0, 1, -1), p)
