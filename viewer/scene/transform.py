"""What a transform does to normals and to the order of a triangle's corners."""

from __future__ import annotations

import numpy as np


def normal_matrix(transform: np.ndarray) -> np.ndarray:
    """The inverse transpose of the upper 3x3, up to a positive factor, as its cofactors: a scale of 0 is no trouble."""
    return np.array(_cofactors(transform)) * handedness(transform)


def handedness(transform: np.ndarray) -> float:
    """-1 where the transform mirrors, else 1."""
    row = transform[0, :3].tolist()
    return -1.0 if sum(value * cofactor for value, cofactor in zip(row, _cofactors(transform)[0])) < 0 else 1.0


def _cofactors(transform: np.ndarray) -> list[list[float]]:
    """Of the upper 3x3 over its largest entry: in plain floats, for numpy's calls would cost a draw more than GL's."""
    m = transform[:3, :3]
    (a, b, c), (d, e, f), (g, h, i) = (m / (np.abs(m).max() or 1.0)).tolist()
    return [[e * i - f * h, f * g - d * i, d * h - e * g],
            [h * c - i * b, i * a - g * c, g * b - h * a],
            [b * f - c * e, c * d - a * f, a * e - b * d]]
