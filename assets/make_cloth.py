"""Makes `scenes/cloth.glb`, a square of cloth that hangs over a ball, for weaves: python assets/make_cloth.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, grid, save_scenes, without

SIDE, BALL, HEM = 2.6, 0.55, 1.15
"""The cloth's side; the ball's radius; the angle in radians from the ball's top at which the cloth leaves it."""


def draped(place: np.ndarray) -> np.ndarray:
    """Where points (..., 2) of the flat cloth come to lie, (..., 3). From the middle outwards they follow the ball, and
    then a cone below it, whose circumference is too short for them: so they fold."""
    length, around = np.hypot(*np.moveaxis(place, -1, 0)), np.arctan2(place[..., 1], place[..., 0])
    angle = np.minimum(length / BALL, HEM)
    free = np.maximum(length - BALL * angle, 0)
    out = BALL * np.sin(angle) + free * np.cos(HEM) * 0.4
    out = out + 0.5 * free**1.5 * np.cos(7 * around + 0.6) / (1 + free)
    up = BALL * np.cos(angle) - free * 0.92
    return np.stack([out * np.cos(around), up, -out * np.sin(around)], axis=-1)


def cloth() -> Glb:
    """Texture coordinates grow by 1 along each side: u to the right and v away from the camera."""
    u, v = np.meshgrid(np.linspace(0, 1, 33), np.linspace(0, 1, 33))
    place = (np.stack([u, v], -1) - 0.5) * SIDE
    step = 1e-4
    along_u, along_v = (draped(place + d) - draped(place - d) for d in (np.array([step, 0]), np.array([0, step])))
    normals = np.cross(along_u, along_v)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    shape = grid(draped(place), normals, np.stack([u, v], -1), np.zeros((*u.shape, 4)))
    glb = Glb()
    glb.node(glb.mesh(without(shape, "TANGENT"), glb.material((0.5, 0.5, 0.5), 0.0, 0.8, doubleSided=True)))
    glb.light("directional", (-1, 1.6, 1.2), intensity=2.5)
    glb.camera((0.3, 1.6, 4.0), (0.0, -0.12, 0.0), fov=28.0)
    return glb


if __name__ == "__main__":
    save_scenes([cloth], Path(__file__).parent / "scenes")
