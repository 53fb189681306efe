"""How a transform changes normals and the winding order of triangles."""

from __future__ import annotations

import numpy as np


def normal_matrix(transform: np.ndarray) -> np.ndarray:
    """The inverse transpose of the upper 3x3 matrix, up to a positive factor, (3, 3) float64.

    It is the matrix of cofactors, which exists even if a scale is 0.
    """
    return np.array(_cofactors(transform)) * handedness(transform)


def handedness(transform: np.ndarray) -> float:
    """-1 if the transform mirrors (its determinant is negative), else 1."""
    row = transform[0, :3].tolist()
    return -1.0 if sum(value * cofactor for value, cofactor in zip(row, _cofactors(transform)[0])) < 0 else 1.0


def _cofactors(transform: np.ndarray) -> list[list[float]]:
    """The cofactors of the upper 3x3 matrix divided by its largest entry.

    They are computed in plain floats: for one draw, numpy's calls would take longer than OpenGL's.
    """
    m = transform[:3, :3]
    (a, b, c), (d, e, f), (g, h, i) = (m / (np.abs(m).max() or 1.0)).tolist()
    return [[e * i - f * h, f * g - d * i, d * h - e * g],
            [h * c - i * b, i * a - g * c, g * b - h * a],
            [b * f - c * e, c * d - a * f, a * e - b * d]]
