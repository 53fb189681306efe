"""Whether a point is inside of a closed surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def winding_number(triangles: NDArray[np.float64]) -> float:
    """How often closed triangles, (N, 3, 3), enclose the origin, seen from outside counter-clockwise or clockwise.

    The sum of their solid angles over 4 pi: van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
    """
    a, b, c = np.moveaxis(triangles, 1, 0)
    la, lb, lc = (np.linalg.norm(edge, axis=1) for edge in (a, b, c))
    numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
    denominator = (la * lb * lc + np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la
                   + np.einsum("ij,ij->i", c, a) * lb)
    return float(abs(np.arctan2(numerator, denominator).sum()) / (2 * np.pi))
