"""glTF's cameras, which the nodes that refer to them place."""

from __future__ import annotations

import math

import numpy as np

from ..camera import Camera
from ..rig import camera_pose
from .element import Element


def read_camera(element: Element, world: np.ndarray, name: str) -> Camera | None:
    """The camera of a node with the world matrix `world` (4, 4); None, with a warning, if it could show nothing.

    The file's aspect ratio, `xmag` and far plane are ignored: the picture defines the first two, and the scene the
    last. The near plane of a perspective becomes `Camera.near`; that of an orthographic camera is ignored, too.
    """
    pose = camera_pose(world)
    kind = element.string("type")
    if kind == "perspective":
        perspective = element.object("perspective")
        fov, near = perspective.number("yfov"), perspective.number("znear", 0.0)
        if 0 < fov < math.pi:
            return Camera(pose, fov, name=name, near=near if near > 0 else None)
        element.warn(f"a vertical field of view of {fov:g} shows nothing; the camera is left out", "perspective.yfov")
    elif kind == "orthographic":
        ymag = abs(element.object("orthographic").number("ymag"))
        if ymag > 0:
            return Camera(pose, height=2 * ymag, name=name)
        element.warn("a height of 0 shows nothing; the camera is left out", "orthographic.ymag")
    else:
        element.warn(f"{kind[:20]!r} is unknown; the camera is left out", "type")
    return None
