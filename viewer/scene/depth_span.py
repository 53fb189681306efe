"""The depths between which a view of depth goes from white to black."""

from __future__ import annotations

import numpy as np

from .camera import Camera
from .scene import Scene


def depth_span(scene: Scene, camera: Camera) -> tuple[float, float]:
    """The least and the greatest depth, along the view axis in world units, of the boxes of all surfaces and curves.

    The least is not behind the camera, unless that is orthographic, and the greatest is greater.
    """
    corners = np.concatenate([scene.corners.reshape(-1, 3), scene.curve_corners])
    depths = (corners - camera.eye) @ camera.forward if len(corners) else np.zeros(1)
    near, far = float(depths.min()), float(depths.max())
    if camera.height is None:
        near = max(near, 0.0)
    return near, max(far, near + 1e-6 * scene.radius)
