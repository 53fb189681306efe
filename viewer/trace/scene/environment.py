"""The environment as a light: its map, and a table that samples directions by its radiance."""

from __future__ import annotations

import math

import moderngl
import numpy as np

from ...bake.background import blurred, is_magnified
from ...gpu.context import Context
from ...gpu.float_texture import float_texture
from ...gpu.programs import set_uniform
from ...gpu.smooth_map import SmoothMap, can_be_smooth, most_smooth_rows
from ...scene.color import LUMINANCE
from ...scene.environment import Environment
from ...scene.equirect import texel_solid_angles
from .alias import alias_grid

UNITS = {"u_environment": 11, "u_environment_table": 10}
_UNIT_BACKGROUND = 15
"""Texture units, below and above those of viewer/trace/scene/scene_data.py."""
MAX_CELLS = 2048, 1024
"""Most columns and rows of a table, 32 MiB. The cells of a larger map are blocks of its texels.

On eight photographed maps of 1024 x 512, combined with the BSDF samples of a white surface, blocks of 2 x 2 texels make
the standard deviation 1.01 to 1.6 times as large, blocks of 4 x 4 up to 3 times."""
FLOOR = 0.1
"""Least weight of a direction, relative to its radiance.

On those maps the standard deviation is at most 6 % larger than with 0.02. Without compensation, which is the value 1,
it is 1.01 to 1.4 times as large."""


def cell_texels(height: int, width: int) -> int:
    """Side of a cell, in texels of the map."""
    return max(-(-width // MAX_CELLS[0]), -(-height // MAX_CELLS[1]))


def cell_densities(radiance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Density by solid angle and solid angles of the cells of a map, both (rows, columns) float64.

    `radiance` is (H, W, 3), some of it positive. The weight of a texel begins as the mean of the bilinear look-up over
    its area, in which each neighbour has a weight of 1/8. So it is 0 only where the look-up is 0. From that the mean
    over the sphere is subtracted (Karlik et al. 2019, "MIS Compensation"), because BSDF samples find uniform light
    well. The weight stays at least `FLOOR` times the luminance, so that light samples alone are unbiased, too. By that
    floor a map of one colour is sampled uniformly.
    """
    height, width = radiance.shape[:2]
    luminance = radiance @ LUMINANCE.astype(np.float32)
    luminance = 0.75 * luminance + 0.125 * (np.roll(luminance, 1, axis=1) + np.roll(luminance, -1, axis=1))
    padded = np.pad(luminance, ((1, 1), (0, 0)), mode="edge")
    luminance = 0.75 * luminance + 0.125 * (padded[:-2] + padded[2:])
    solid_angles = texel_solid_angles(height, width)
    mean = width * (solid_angles @ luminance.mean(axis=1, dtype=np.float64)) / (4 * np.pi)
    weights = np.maximum(luminance - np.float32(mean), FLOOR * luminance)
    weights *= solid_angles[:, None].astype(np.float32)
    side = cell_texels(height, width)
    rows, columns = np.arange(0, height, side), np.arange(0, width, side)
    weights = np.add.reduceat(np.add.reduceat(weights, rows, axis=0), columns, axis=1, dtype=np.float64)
    solid_angles = np.add.reduceat(solid_angles, rows)[:, None] * np.diff(columns, append=width)
    return weights / weights.sum() / solid_angles, solid_angles


class EnvironmentTable:
    """Textures and uniforms of shaders/trace/environment.glsl and background.glsl, for an environment and its decoded
    `radiance`.

    `environment` may be replaced by one that differs only in rotation and intensity.
    """

    def __init__(self, context: Context, environment: Environment, radiance: np.ndarray) -> None:
        gl = context.gl
        self._context, self.environment = context, environment
        height, width = radiance.shape[:2]
        side = cell_texels(height, width)
        self._cell = side / width, side / height
        self._map = float_texture(gl, np.ascontiguousarray(radiance, np.float32))
        self._map.repeat_x = True
        self._can_be_smooth = can_be_smooth(context, radiance)
        self._blur = 0.0
        self._smooth: SmoothMap | None = None
        self.background_rows: int = self._map.height
        """Rows of the map that camera rays see."""
        densities, solid_angles = cell_densities(radiance)
        threshold, alias = alias_grid(densities * solid_angles)
        density = densities.ravel().astype(np.float32)
        texels = np.empty((len(alias), 4), np.uint32)
        texels[:, 0] = threshold.astype(np.float32).view(np.uint32)
        texels[:, 1] = alias % densities.shape[1] | alias // densities.shape[1] << 16
        texels[:, 2] = density.view(np.uint32)
        texels[:, 3] = density[alias].view(np.uint32)
        self._table = gl.texture(densities.shape[::-1], 4, texels, dtype="u4")
        self._table.filter = moderngl.NEAREST, moderngl.NEAREST

    def holds(self, environment: Environment) -> bool:
        """Whether this is the map of that environment; rotation and intensity may differ."""
        return environment.source is self.environment.source

    def blur_background(self, degrees: float) -> None:
        """Let camera rays see the map blurred so far; 0: as it is."""
        if degrees == self._blur:
            return
        self._forget_smooth()
        self._blur, self.background_rows = degrees, self._map.height
        if degrees:
            pixels = blurred(self.environment.radiance, degrees, most_smooth_rows(self._context))
            self._smooth, self.background_rows = SmoothMap(self._context, pixels, is_exact=True), len(pixels)

    def is_background_smooth(self, pixel_angle: float) -> bool:
        """Whether camera rays see the background by B-splines, in a picture whose pixels have that angle."""
        return self._blur > 0 or (self._can_be_smooth and is_magnified(self._map.height, pixel_angle))

    def use_textures(self) -> None:
        """Bind the textures to their units."""
        for unit, texture in zip(UNITS.values(), (self._map, self._table), strict=True):
            texture.use(unit)
        if self._smooth is not None:
            self._smooth.use(_UNIT_BACKGROUND)

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Set all uniforms except the share of light samples."""
        for name, unit in UNITS.items():
            set_uniform(program, name, unit)
        if "u_background" in program:
            if self._smooth is None:
                self._smooth = SmoothMap(self._context, self.environment.radiance, is_exact=True)
            self._smooth.bind(program, "u_background", _UNIT_BACKGROUND)
        angle = self.environment.rotation
        set_uniform(program, "u_environment_cell", self._cell)
        set_uniform(program, "u_environment_intensity", self.environment.intensity)
        set_uniform(program, "u_environment_rotation", (math.cos(angle), math.sin(angle)))

    def release(self) -> None:
        self._forget_smooth()
        self._map.release()
        self._table.release()

    def _forget_smooth(self) -> None:
        if self._smooth is not None:
            self._smooth.release()
            self._smooth = None
