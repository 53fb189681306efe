"""Which solids a point is inside of, for the eye and for lights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene.winding import winding_number
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
