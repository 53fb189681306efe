"""Which solids a point is inside of, for the eye and for lights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import TraceGeometry, TraceInstance


def solids_around(geometry: TraceGeometry, point: NDArray[np.float64]) -> list[TraceInstance]:
    """The solids that light can enter and that `point`, (3,) in tracer space, is inside of, the largest first."""
    found = []
    for instance in geometry.instances:
        material = geometry.materials[instance.material]
        if material.is_thin or not (material.transmits or material.transmits_diffusely):
            continue
        mesh = geometry.meshes[instance.mesh]
        corners = mesh.positions.astype(np.float64) @ instance.transform[:, :3].T + instance.transform[:, 3]
        low, high = corners.min(axis=0), corners.max(axis=0)
        if (point < low).any() or (point > high).any():
            continue
        if winding_number((corners - point)[mesh.triangles]) > 0.5:
            found.append((float(np.prod(high - low)), instance))
    return [instance for _, instance in sorted(found, key=lambda pair: -pair[0])]


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
