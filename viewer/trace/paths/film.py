"""The film: what every pixel has gathered, and how sure it is."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from ...errors import UsageError
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ..layout import TILE, shader_defines
from .wavefront import LAYERS, SUMS, UNIT_BLOCKS, Sums, Wave, float_target


class Film:
    """Sums over the samples of each pixel of a picture of `size` (width, height), row 0 at the bottom.

    `sum` (rgb, samples), `squares` (of rgb; alpha); with `has_layers` of the first hits `albedo` (rgb, hits),
    `normal` (xyz, distance along the ray in world units) and `emission` (rgb). `radiance` is the mean, with associated
    alpha, as of the last `develop`. Raises UsageError for a size that this OpenGL has no textures for.
    """

    def __init__(self, gl: moderngl.Context, programs: Programs, size: tuple[int, int], has_layers: bool) -> None:
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > limit or min(size) < 1:
            raise UsageError(f"a picture of {size[0]}x{size[1]}: this OpenGL draws from 1x1 to {limit}x{limit}")
        self._gl, self._programs, self.size = gl, programs, size
        self.tiles = -(-size[0] // TILE), -(-size[1] // TILE)
        try:
            self._sums = Sums(gl, size, SUMS)
            self._layers = Sums(gl, size, LAYERS) if has_layers else None
            self.radiance = float_target(gl, size)
            self._tile_errors = float_target(gl, self.tiles)
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} is more than this OpenGL can hold ({error})") from error
        self._developed = gl.framebuffer([self.radiance])
        self._estimated = gl.framebuffer([self._tile_errors])
        self.sum, self.squares = self._sums.textures
        layers: list[Any] = self._layers.textures if self._layers else [None] * LAYERS
        self.albedo, self.normal, self.emission = layers

    def add(self, wave: Wave, blocks: np.ndarray) -> None:
        """What these blocks of the wave have gathered, each at its tile, in this order."""
        self._resolve(wave, blocks, wave.sums, self._sums)
        if self._layers is not None and wave.layers is not None:
            self._resolve(wave, blocks, wave.layers, self._layers)

    def _resolve(self, wave: Wave, blocks: np.ndarray, source: Sums, target: Sums) -> None:
        program = self._programs.get("trace/film/resolve.vert", "trace/film/resolve.frag",
                                     shader_defines({"COUNT": len(source.textures)}))
        target.framebuffer.use()
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        for unit, (name, texture) in enumerate(zip(("u_first", "u_second", "u_third"), source.textures, strict=False)):
            texture.use(unit)
            set_uniform(program, name, unit)
        wave.bind_blocks()
        set_uniform(program, "u_blocks", UNIT_BLOCKS)
        set_uniform(program, "u_size", self.size)
        wave.draw_blocks(program, blocks)
        self._gl.enable_only(moderngl.NOTHING)

    def develop(self) -> None:
        """Work `radiance` out."""
        self._draw("mean", self._developed)

    def tile_errors(self) -> np.ndarray:
        """For each tile, (rows, columns, 4) float32, row 0 at the bottom: the sum of its pixels' relative variances,
        how many pixels have one (it takes two samples), samples, and pixels.

        A pixel's relative variance is that of its mean over mean^2 + 0.01, averaged over the channels (relMSE, with the
        mean, or what is around the pixel if that is darker, for the reference). It is from the samples themselves:
        their low discrepancy makes the true error smaller, light that none has found yet makes it larger.
        """
        self._draw("error", self._estimated)
        return _read(self._estimated)

    def _draw(self, name: str, target: moderngl.Framebuffer) -> None:
        program = self._programs.get("display/fullscreen.vert", f"trace/film/{name}.frag", shader_defines())
        target.use()
        self._gl.enable_only(moderngl.NOTHING)
        self.sum.use(0)
        self.squares.use(1)
        set_uniform(program, "u_sum", 0)
        set_uniform(program, "u_squares", 1)
        fullscreen(self._gl, program).render(vertices=3)

    def read_radiance(self) -> np.ndarray:
        """`radiance`, (H, W, 4) float32, row 0 at the top."""
        return _read(self._developed)[::-1].copy()

    def read_sums(self) -> tuple[np.ndarray, np.ndarray]:
        """`sum` and `squares`, (H, W, 4) float32 each, row 0 at the top."""
        first, second = (_read(self._sums.framebuffer, attachment)[::-1] for attachment in range(2))
        return first, second

    def read_layers(self) -> tuple[np.ndarray, ...]:
        """`albedo`, `normal` and `emission`, likewise; for a film that has them."""
        assert self._layers is not None
        return tuple(_read(self._layers.framebuffer, attachment)[::-1] for attachment in range(LAYERS))

    def release(self) -> None:
        for thing in (self._sums, self._layers, self._developed, self._estimated, self.radiance, self._tile_errors):
            if thing is not None:
                thing.release()


def relative_error(tiles: np.ndarray) -> float:
    """The estimated relative error of a picture, from `Film.tile_errors`.

    It is the root of the pixels' mean relative variance; infinite as long as some pixel has fewer than two samples.
    """
    variance, known, _, pixels = tiles.reshape(-1, 4).astype(np.float64).sum(axis=0)
    return float(np.sqrt(variance / known)) if known == pixels else float("inf")


def _read(framebuffer: moderngl.Framebuffer, attachment: int = 0) -> np.ndarray:
    width, height = framebuffer.size
    pixels = framebuffer.read(components=4, attachment=attachment, dtype="f4")
    return np.frombuffer(pixels, np.float32).reshape(height, width, 4)
