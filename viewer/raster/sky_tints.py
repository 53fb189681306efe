"""What the environment's light keeps on its way through glass: the optical depth of all that lets light through, seen
from each of the lights that stand for it."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl

from ..plan.model import Plan
from ..scene.scene import Scene
from .shadows import Atlas, Casters, Tile, draw_meshes

_COARSER = 4
"""Texels of depth along one of tints, which many lights blur anyway."""


class TintAtlas:
    """A texture of tiles at the places of those of `depths`: shaders/raster/sky_tint.frag writes them."""

    def __init__(self, gl: moderngl.Context, depths: Atlas) -> None:
        self._gl = gl
        self._side, self._columns = max(depths.tile_size // _COARSER, 1), depths.tiles[0]
        self.texture = gl.texture(tuple(number * self._side for number in depths.tiles), 4, dtype="f2")
        self.texture.repeat_x = self.texture.repeat_y = False
        self._framebuffer = gl.framebuffer([self.texture])

    def draw(self, scene: Scene, tiles: Sequence[Tile], plan: Plan, casters: Casters) -> None:
        """Add the surfaces that let light through in every tile."""
        gl, framebuffer = self._gl, self._framebuffer
        framebuffer.use()
        framebuffer.clear(alpha=1.0)
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        gl.blend_equation = moderngl.FUNC_ADD, moderngl.MIN  # optical depths, and the depth of the nearest surface
        side = self._side
        viewports = [(k % self._columns * side, k // self._columns * side, side, side) for k in range(len(tiles))]
        try:
            draw_meshes(framebuffer, viewports, scene, tiles, [draw for draw in plan.draws if not draw.hides_sky],
                        casters.prepare_tint)
        finally:
            gl.blend_equation = moderngl.FUNC_ADD

    def release(self) -> None:
        self._framebuffer.release()
        self.texture.release()
