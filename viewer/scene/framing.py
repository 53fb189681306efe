"""The camera that a model fills. It fits what is projected, the vertices, and not a sphere about them.

In the axes of the camera, relative to the scene's centre, let the eye be at (a, b, c) and a vertex at (x, y, z), with z
towards the viewer. Let t be the tangent of half the field of view. The vertex is in the picture if
|x - a| <= t (c - z), which is two linear inequalities: t c + a >= x + t z and t c - a >= -x + t z. So only the two
vertices count that lie farthest along (1, 0, t) and (-1, 0, t), the normals of the sides of the view. If A and B are
the largest values of the right-hand sides, the least distance is c = (A + B) / 2t, at a = (A - B) / 2. The same holds
for y and b. The larger of the two distances fills the picture in one axis. In the other the picture is centred: that is
the fit of a smaller t, for which A + B = 2 t c.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..base.expect import expect_positive
from .arrays import scene_array
from .camera import Camera, check_fov

if TYPE_CHECKING:
    from .scene import Scene

MARGIN = 0.05
"""What stays free at each side of the axis that is filled, of the picture's width or height."""
NEAREST = 0.5
"""The least depth of the nearest vertex, in radii of the scene. It limits the perspective of what is long, narrow and
points at the viewer, and keeps the eye away from a single point."""


def camera(scene: Scene, aspect: float, azimuth: float, elevation: float, fov_y: float, target: ArrayLike | None,
           orthographic: bool) -> Camera:
    """See `Scene.framing_camera`."""
    expect_positive(aspect, "aspect")
    check_fov(fov_y, "fov_y")
    if target is not None:
        target = scene_array(target, "target", np.float64, 3)
    rotation = Camera.orbit((0.0, 0.0, 0.0), 1.0, azimuth, elevation).pose[:3, :3]
    target, distance = fit(scene, rotation, aspect, fov_y, target=target, is_orthographic=orthographic)
    made = Camera.orbit(target, distance, azimuth, elevation, fov_y)
    if not orthographic:
        return made
    outside = float((scene.center - target) @ rotation[:, 2]) + 2 * scene.radius
    return replace(Camera.orbit(target, max(distance, outside), azimuth, elevation, fov_y),
                   height=made.orthographic(distance).height)


def fit(scene: Scene, rotation: np.ndarray, aspect: float, fov_y: float, *, target: np.ndarray | None = None,
        is_orthographic: bool = False) -> tuple[np.ndarray, float]:
    """Where a camera with the axes `rotation` (right, up and back as columns, (3, 3)) looks, and from how far.

    `aspect` is width / height and `fov_y` the vertical field of view in radians. The returned target, (3,) in world
    space, is in the middle of the picture, as deep as the scene's centre. If one is given, only the distance is fitted.
    An orthographic camera shows as much as a perspective one does at the depth of the target.
    """
    tangents = (1 - 2 * MARGIN) * math.tan(fov_y / 2) * np.array([aspect, 1.0])
    slopes = np.zeros(2) if is_orthographic else tangents
    back = rotation[:, 2]
    nearest = max(float(scene.farthest(back) @ back), 0.0) + NEAREST * scene.radius
    if is_orthographic:  # whose eye may stand anywhere
        nearest = 1e-3 * scene.radius
    reach = [_reach(scene, rotation[:, k], back, slopes[k])[0] for k in range(2)]
    if target is not None:
        x = (target - scene.center) @ rotation
        distances = [max(a - x[k], b + x[k]) / tangents[k] - slopes[k] / tangents[k] * x[2]
                     for k, (a, b) in enumerate(reach)]
        return target, max(nearest - x[2], *distances)
    distance = max(nearest, *(float(reach[k].sum()) / (2 * tangents[k]) for k in range(2)))
    shift = [_centred(scene, rotation[:, k], back, slopes[k], distance) for k in range(2)]
    return scene.center + rotation[:, :2] @ shift, distance


def _centred(scene: Scene, axis: np.ndarray, back: np.ndarray, slope: float, distance: float) -> float:
    """The place of the eye on `axis` from which the picture has as much free at both sides."""
    for _ in range(8):  # Newton's method: what is linear in pieces needs few steps
        values, depths = _reach(scene, axis, back, slope)
        excess = float(values.sum()) - 2 * slope * distance
        if slope == 0 or abs(excess) < 1e-9 * distance:
            break
        slope = max(slope + excess / (2 * distance - float(depths.sum())), 0.0)
    return float(values[0] - values[1]) / 2


def _reach(scene: Scene, axis: np.ndarray, back: np.ndarray, slope: float) -> np.ndarray:
    """A and B of the vertices that lie farthest at both sides, and how far those vertices lie in front of the centre,
    (2, 2) float64."""
    normals = np.stack([axis + slope * back, slope * back - axis])
    vertices = np.stack([scene.farthest(normal) for normal in normals])
    return np.stack([np.einsum("ij,ij->i", vertices, normals), vertices @ back])
