"""Rays that begin on surfaces, a list of them in place of a camera's: shaders/trace/surface_ray.glsl."""

from __future__ import annotations

import moderngl
import numpy as np

from ...gpu.programs import set_uniform

GATHERS, LOOKS = 1, 2
"""Out of the surface into its hemisphere; at it, from just off it."""
_WIDTH = 1024
_UNITS = {"u_ray_point": 16, "u_ray_normal": 17, "u_ray_outside": 18}
"""After all that a scene binds."""


class SurfaceRays:
    """A pixel for each of N points in tracer space, in rows from the bottom; `size` (width, height) holds them all.

    `points`, `normals` and `outsides`, geometric normals on the side of those, are (N, 3). `kind` is GATHERS or LOOKS.
    """

    def __init__(self, gl: moderngl.Context, kind: int, points: np.ndarray, normals: np.ndarray,
                 outsides: np.ndarray) -> None:
        self.kind, self.count = kind, len(points)
        self.size = min(len(points), _WIDTH), -(-len(points) // _WIDTH)
        self._textures = {}
        for name, rows in zip(_UNITS, (points, normals, outsides), strict=True):
            texels = np.zeros((self.size[0] * self.size[1], 4), np.float32)
            texels[:len(rows), :3], texels[:len(rows), 3] = rows, 1.0
            texture = gl.texture(self.size, 4, texels, dtype="f4")
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._textures[name] = texture

    def bind(self, program: moderngl.Program) -> None:
        """To a program that begins paths; others have no use for them."""
        for name, texture in self._textures.items():
            if name in program:
                texture.use(_UNITS[name])
                set_uniform(program, name, _UNITS[name])

    def rows(self, pixels: np.ndarray) -> np.ndarray:
        """Of a picture (H, W, C), row 0 at the bottom, what each ray has, (N, C)."""
        return pixels.reshape(-1, pixels.shape[-1])[:self.count]

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()
