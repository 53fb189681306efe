"""How a transform changes normals and the winding order of triangles."""

from __future__ import annotations

from typing import Any

import numpy as np


def normal_matrix(transform: np.ndarray) -> np.ndarray:
    """The inverse transpose of the upper 3x3 matrix, up to a positive factor, (3, 3) float64.

    It is the matrix of cofactors, which exists even if a scale is 0.
    """
    return np.array(_cofactors(_scaled(transform))) * handedness(transform)


def handedness(transform: np.ndarray) -> float:
    """-1 if the transform mirrors (its determinant is negative), else 1."""
    row = transform[0, :3].tolist()
    return -1.0 if sum(value * cofactor for value, cofactor in zip(row, _cofactors(_scaled(transform))[0])) < 0 else 1.0


def normals_and_hands(transforms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`normal_matrix` and `handedness` of each of (N, 4, 4): (N, 3, 3) and (N,) float64."""
    m = transforms[:, :3, :3]
    largest = np.abs(m).max(axis=(1, 2), initial=0.0)
    m = m / np.where(largest > 0, largest, 1.0)[:, None, None]
    cofactors = np.moveaxis(np.array(_cofactors(np.moveaxis(m, 0, 2))), 2, 0)
    hands = np.where((m[:, 0] * cofactors[:, 0]).sum(axis=1) < 0, -1.0, 1.0)
    return cofactors * hands[:, None, None], hands


def _scaled(transform: np.ndarray) -> list[list[float]]:
    """The upper 3x3 matrix divided by its largest entry, in plain floats: for one draw, numpy's calls would take longer
    than OpenGL's."""
    m = transform[:3, :3]
    rows: list[list[float]] = (m / (np.abs(m).max() or 1.0)).tolist()
    return rows


def _cofactors(rows: Any) -> list[list[Any]]:
    """The cofactors of a 3x3 matrix of floats, or of arrays."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return [[e * i - f * h, f * g - d * i, d * h - e * g],
            [h * c - i * b, i * a - g * c, g * b - h * a],
            [b * f - c * e, c * d - a * f, a * e - b * d]]
