"""The film: the sums of the samples of each pixel, and the estimate of their error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import moderngl
import numpy as np

from ...errors import UsageError
from ...gpu.float_target import float_target
from ...gpu.over_picture import draw_over
from ...gpu.programs import Programs, set_uniform
from ..defines import shader_defines
from ..layout import TILE
from .distribution import deviation_around
from .gathered import Gathered
from .photon_sums import PhotonSums
from .sky import UNIT_SKY, Sky
from .wavefront import LAYERS, SECOND, SUMS, UNIT_BLOCKS, Sums, Wavefront, Work

_SAMPLERS = "u_sum", "u_squares"


class Film:
    """Sums over the samples of each pixel of a picture of `size` (width, height), row 0 at the bottom.

    `sum` has rgb and the number of samples, `squares` the squares of rgb, and alpha. With `has_layers` there are sums
    of the first hits: `albedo` (rgb, hits), `normal` (xyz, distance along the ray in world units) and `emission` (rgb).
    With `has_photons` what photons have brought to the pixels is in `sum` and `squares`, too, as if each sample had
    found its share of it: mean and variance are those of both.
    With `has_parts` there are two films besides, `parts`, each with about half of the samples and of the photons.
    `radiance` is the mean with associated alpha, as of the last `develop`. Raises UsageError for a size for which this
    OpenGL has no textures.
    """

    def __init__(self, gl: moderngl.Context, programs: Programs, size: tuple[int, int], has_layers: bool,
                 has_photons: bool = False, has_parts: bool = False) -> None:
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > limit or min(size) < 1:
            raise UsageError(f"a picture of {size[0]}x{size[1]}: this OpenGL draws from 1x1 to {limit}x{limit}")
        self._gl, self._programs, self.size = gl, programs, size
        self.tiles = -(-size[0] // TILE), -(-size[1] // TILE)
        try:
            self._sums = Sums(gl, size, SUMS)
            self._layers = Sums(gl, size, LAYERS) if has_layers else None
            self.photon_sums = PhotonSums(gl, programs, size) if has_photons else None
            self._with_photons = Sums(gl, size, SUMS) if has_photons else None
            self.radiance = float_target(gl, size)
            self._tile_errors = float_target(gl, self.tiles)
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} is more than this OpenGL can hold ({error})") from error
        self._developed = gl.framebuffer([self.radiance])
        self._estimated = gl.framebuffer([self._tile_errors])
        self._joined: tuple[int, int] | None = None
        self._added = 0
        self.parts = tuple(Film(gl, programs, size, has_layers, has_photons) for _ in range(2)) if has_parts else ()
        if self.photon_sums is not None:
            self.photon_sums.parts = tuple(part.photon_sums for part in self.parts if part.photon_sums is not None)
        layers: list[Any] = self._layers.textures if self._layers else [None] * LAYERS
        self.albedo, self.normal, self.emission = layers

    def add(self, wavefront: Wavefront, blocks: np.ndarray) -> None:
        """Add the sums of these blocks of the wavefront to their tiles, in this order."""
        self._added += 1
        self._resolve(wavefront, blocks, wavefront.sums, self._sums)
        if wavefront.gathered is not None:
            self._resolve(wavefront, blocks, wavefront.gathered, self._sums)
        if self._layers is not None and wavefront.layers is not None:
            self._resolve(wavefront, blocks, wavefront.layers, self._layers)
        if self.parts:
            is_second = wavefront.work[blocks, 2] >= SECOND
            for part, own in zip(self.parts, (blocks[~is_second], blocks[is_second]), strict=True):
                if len(own):
                    part.add(wavefront, own)

    def add_sky(self, sky: Sky, work: Sequence[Work]) -> None:
        """Add the samples of work items whose tiles no geometry can touch."""
        self._added += 1
        defines = shader_defines({"BACKGROUND": int(sky.is_seen)})
        program = self._programs.get("trace/film/sky.vert", "trace/film/sky.frag", defines)
        self._sums.framebuffer.use()
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        sky.texture.use(UNIT_SKY)
        set_uniform(program, "u_sky", UNIT_SKY)
        set_uniform(program, "u_size", self.size)
        items = self._gl.buffer(np.asarray([item[:4] for item in work], np.int32))
        array = self._gl.vertex_array(program, [(items, "4i4/i", "a_work")])
        array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(work))
        array.release()
        items.release()
        self._gl.enable_only(moderngl.NOTHING)
        for k, part in enumerate(self.parts):
            own = [item for item in work if (item.first >= SECOND) == bool(k)]
            if own:
                part.add_sky(sky, own)

    @property
    def is_split(self) -> bool:
        """Whether there are parts, and all tiles have samples, and photons if there are any, in both."""
        return bool(self.parts) and all(part.tile_errors()[..., 2].min() > 0 for part in self.parts) and not (
            self.photons and min(part.photons for part in self.parts) == 0)

    @property
    def photons(self) -> int:
        """Number of photons whose light is in the film."""
        return 0 if self.photon_sums is None else self.photon_sums.count

    @property
    def sum(self) -> moderngl.Texture:
        """rgb and the number of samples of each pixel."""
        return self._total.textures[0]

    @property
    def squares(self) -> moderngl.Texture:
        """The squares of rgb, and alpha, of each pixel."""
        return self._total.textures[1]

    @property
    def _total(self) -> Sums:
        """The sums of paths, with those of photons if there are any."""
        if self.photon_sums is None or self._with_photons is None:
            return self._sums
        if self._joined != (self._added, self.photons):
            self._joined = self._added, self.photons
            sources = dict(zip(_SAMPLERS, self._sums.textures, strict=True)) | self.photon_sums.textures
            self._over_picture("join", self._with_photons.framebuffer, sources, {"u_photons": float(self.photons)})
        return self._with_photons

    def _over_picture(self, name: str, target: moderngl.Framebuffer, sources: Mapping[str, moderngl.Texture],
                      uniforms: Mapping[str, object] | None = None) -> None:
        program = self._programs.get("display/fullscreen.vert", f"trace/film/{name}.frag", shader_defines())
        draw_over(self._gl, program, target, sources, uniforms=uniforms)

    def _resolve(self, wavefront: Wavefront, blocks: np.ndarray, source: Sums | Gathered, target: Sums) -> None:
        program = self._programs.get("trace/film/resolve.vert", "trace/film/resolve.frag",
                                     shader_defines({"COUNT": len(source.textures)}))
        target.framebuffer.use()
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        for unit, (name, texture) in enumerate(zip(("u_first", "u_second", "u_third"), source.textures, strict=False)):
            texture.use(unit)
            set_uniform(program, name, unit)
        wavefront.bind_blocks()
        set_uniform(program, "u_blocks", UNIT_BLOCKS)
        set_uniform(program, "u_size", self.size)
        wavefront.draw_blocks(program, blocks)
        self._gl.enable_only(moderngl.NOTHING)

    def develop(self) -> None:
        """Compute `radiance`."""
        self._draw("mean", self._developed)

    def tile_errors(self) -> np.ndarray:
        """For each tile, (rows, columns, 4) float32, row 0 at the bottom: the sum of its pixels' relative variances,
        the number of pixels that have one (it needs two samples), the number of samples, and the number of pixels.

        A pixel's relative variance is the variance of its mean divided by mean^2 + 0.01, averaged over the channels.
        This is relMSE with the mean as reference, or with the mean of the neighbours if they are darker. It is
        estimated from the samples themselves: their low discrepancy makes the true error smaller, and light that no
        sample has found yet makes it larger.
        """
        self._draw("error", self._estimated)
        return _read(self._estimated)

    def deviation_around(self) -> np.ndarray:
        """How noisy it is around each pixel, (H, W), row 0 at the bottom
        (`viewer.trace.paths.distribution.deviation_around`)."""
        return deviation_around(*(sums[::-1] for sums in self.read_sums()))

    def _draw(self, name: str, target: moderngl.Framebuffer) -> None:
        self._over_picture(name, target, dict(zip(_SAMPLERS, self._total.textures, strict=True)))

    def read_radiance(self) -> np.ndarray:
        """`radiance`, (H, W, 4) float32, row 0 at the top."""
        return _read(self._developed)[::-1].copy()

    def read_sums(self) -> tuple[np.ndarray, np.ndarray]:
        """`sum` and `squares`, (H, W, 4) float32 each, row 0 at the top."""
        first, second = (_read(self._total.framebuffer, attachment)[::-1] for attachment in range(2))
        return first, second

    def read_layers(self) -> tuple[np.ndarray, ...]:
        """`albedo`, `normal` and `emission` in the same way, for a film that has them."""
        assert self._layers is not None
        return tuple(_read(self._layers.framebuffer, attachment)[::-1] for attachment in range(LAYERS))

    def read(self) -> np.ndarray:
        """All these, (2, H, W, 4) float32, or (5, H, W, 4) for a film with layers."""
        return np.stack([*self.read_sums(), *(self.read_layers() if self._layers is not None else ())])

    def take(self, sums: np.ndarray) -> None:
        """Take sums as `read` has them, instead of what the film has."""
        textures = [*self._sums.textures, *(self._layers.textures if self._layers is not None else ())]
        for texture, pixels in zip(textures, sums, strict=True):
            texture.write(np.ascontiguousarray(pixels[::-1], np.float32))

    def release(self) -> None:
        for thing in (self._sums, self._layers, self.photon_sums, self._with_photons, self._developed, self._estimated,
                      self.radiance, self._tile_errors, *self.parts):
            if thing is not None:
                thing.release()


def relative_error(tiles: np.ndarray) -> float:
    """The estimated relative error of a picture, from `Film.tile_errors`.

    It is the square root of the mean relative variance of the pixels. It is infinite as long as any pixel has fewer
    than two samples.
    """
    variance, estimated, _, pixels = tiles.reshape(-1, 4).astype(np.float64).sum(axis=0)
    return float(np.sqrt(variance / estimated)) if estimated == pixels else float("inf")


def _read(framebuffer: moderngl.Framebuffer, attachment: int = 0) -> np.ndarray:
    width, height = framebuffer.size
    pixels = framebuffer.read(components=4, attachment=attachment, dtype="f4")
    return np.frombuffer(pixels, np.float32).reshape(height, width, 4)
