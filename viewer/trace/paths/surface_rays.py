"""A list of first rays at surface points, in place of camera rays (shaders/trace/surface_ray.glsl)."""

from __future__ import annotations

import moderngl
import numpy as np

FROM_SURFACE, TO_SURFACE = 1, 2
"""Kinds of rays: from the surface into its hemisphere; or to the surface, from just above it."""
_WIDTH = 1024
UNITS = {"u_surface_rays": 16}
"""A texture unit behind all those that a scene binds. It is one, since passes have hardly one of 16 left."""


class SurfaceRays:
    """Rays at N points in tracer space, one pixel each, in rows from the bottom of a picture of `size` (width, height).

    `points`, `normals` (for shading) and `geometric_normals` (on the side of `normals`) are (N, 3). `kind` is
    FROM_SURFACE or TO_SURFACE.
    """

    def __init__(self, gl: moderngl.Context, kind: int, points: np.ndarray, normals: np.ndarray,
                 geometric_normals: np.ndarray) -> None:
        self.kind, self.count = kind, len(points)
        self.size = min(len(points), _WIDTH), -(-len(points) // _WIDTH)
        texels = np.zeros((self.size[0] * self.size[1], 3, 4), np.float32)
        texels[:self.count, :, :3] = np.stack([points, normals, geometric_normals], axis=1)
        texels[:self.count, :, 3] = 1.0
        self._texture = gl.texture((3 * self.size[0], self.size[1]), 4, texels, dtype="f4")
        self._texture.filter = moderngl.NEAREST, moderngl.NEAREST

    def use_textures(self) -> None:
        """Bind the list to its units."""
        self._texture.use(UNITS["u_surface_rays"])

    def rows(self, pixels: np.ndarray) -> np.ndarray:
        """The pixel of each ray, (N, C), from a picture (H, W, C) whose row 0 is at the bottom."""
        return pixels.reshape(-1, pixels.shape[-1])[:self.count]

    def release(self) -> None:
        self._texture.release()
