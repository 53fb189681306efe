"""An edge-avoiding wavelet filter, for the `fast` and the `raster` denoiser."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from .denoiser import NoisyFilm

PASSES = 5
"""Number of passes. Each is twice as wide as the one before; together they reach 62 pixels."""


class Wavelet:
    """An edge-avoiding a-trous wavelet transform (Dammertz et al. 2010). Its weights follow the variance (Schied et al.
    2017), so that its effect fades out as the picture converges. It preserves the sum of the light; see
    shaders/trace/denoise/wavelet.frag."""

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context, self._programs = context, programs
        self._size = (0, 0)
        self._textures: list[moderngl.Texture] = []
        self._framebuffers: list[moderngl.Framebuffer] = []

    @property
    def result(self) -> moderngl.Texture:
        """The picture that was filtered last. It stays valid until the last pass of the next `steps`."""
        return self._textures[-1]

    def filter(self, film: NoisyFilm) -> moderngl.Texture:
        """The filtered picture, RGBA32F, in a texture that is valid until the next call. Alpha is unchanged,
        and so are pixels without hits."""
        for _ in self.steps(film):
            pass
        return self.result

    def steps(self, film: NoisyFilm) -> Iterator[None]:
        """`filter` in steps of one pass each, for a window that handles input in between."""
        self._context.make_current()
        self._resize(film.radiance.size)
        prepared, first, second, final = self._framebuffers
        light, guide, *results, _ = self._textures
        textures = {"u_radiance": film.radiance, "u_sum": film.sum, "u_squares": film.squares,
                    "u_albedo": film.albedo, "u_normal": film.normal, "u_emission": film.emission,
                    "u_guide": guide}
        self._draw("prepare", prepared, textures)
        yield
        steps = [(1 << k, 0) if across else (0, 1 << k) for k in range(PASSES) for across in (True, False)]
        passes = [("variance", None), *(("wavelet", step) for step in steps)]
        for number, (name, step) in enumerate(passes):
            self._draw(name, (first, second)[number % 2], textures | {"u_light": light}, step)
            light = results[number % 2]
            yield
        self._draw("resolve", final, textures | {"u_light": light})
        yield

    def _draw(self, name: str, target: moderngl.Framebuffer, textures: dict[str, moderngl.Texture],
              step: tuple[int, int] | None = None) -> None:
        program = self._programs.get("display/fullscreen.vert", f"trace/denoise/{name}.frag", {})
        target.use()
        self._context.gl.enable_only(moderngl.NOTHING)
        used = (texture_name for texture_name in textures if texture_name in program)
        for unit, texture_name in enumerate(used):
            textures[texture_name].use(unit)
            set_uniform(program, texture_name, unit)
        if step is not None:
            set_uniform(program, "u_step", step)
        fullscreen(self._context.gl, program).render(vertices=3)

    def _resize(self, size: tuple[int, int]) -> None:
        if size == self._size:
            return
        self.release()
        gl = self._context.gl
        self._textures = [gl.texture(size, 4, dtype="f4") for _ in range(5)]
        light, guide, *results = self._textures
        self._framebuffers = [gl.framebuffer([light, guide]), *(gl.framebuffer([texture]) for texture in results)]
        self._size = size

    def release(self) -> None:
        for framebuffer in self._framebuffers:
            framebuffer.release()
        for texture in self._textures:
            texture.release()
        self._textures, self._framebuffers, self._size = [], [], (0, 0)
