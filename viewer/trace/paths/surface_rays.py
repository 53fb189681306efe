"""A list of first rays at surface points, in place of camera rays (shaders/trace/surface_ray.glsl)."""

from __future__ import annotations

import moderngl
import numpy as np

FROM_SURFACE, TO_SURFACE = 1, 2
"""Kinds of rays: from the surface into its hemisphere; or to the surface, from just above it."""
_WIDTH = 1024
UNITS = {"u_ray_point": 16, "u_ray_normal": 17, "u_ray_normal_geometric": 18}
"""Texture units behind all those that a scene binds."""


class SurfaceRays:
    """Rays at N points in tracer space, one pixel each, in rows from the bottom of a picture of `size` (width, height).

    `points`, `normals` (for shading) and `geometric_normals` (on the side of `normals`) are (N, 3). `kind` is
    FROM_SURFACE or TO_SURFACE.
    """

    def __init__(self, gl: moderngl.Context, kind: int, points: np.ndarray, normals: np.ndarray,
                 geometric_normals: np.ndarray) -> None:
        self.kind, self.count = kind, len(points)
        self.size = min(len(points), _WIDTH), -(-len(points) // _WIDTH)
        self._textures = {}
        for name, rows in zip(UNITS, (points, normals, geometric_normals), strict=True):
            texels = np.zeros((self.size[0] * self.size[1], 4), np.float32)
            texels[:len(rows), :3], texels[:len(rows), 3] = rows, 1.0
            texture = gl.texture(self.size, 4, texels, dtype="f4")
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._textures[name] = texture

    def use_textures(self) -> None:
        """Bind the list to its units."""
        for name, texture in self._textures.items():
            texture.use(UNITS[name])

    def rows(self, pixels: np.ndarray) -> np.ndarray:
        """The pixel of each ray, (N, C), from a picture (H, W, C) whose row 0 is at the bottom."""
        return pixels.reshape(-1, pixels.shape[-1])[:self.count]

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()
