"""Kernels on the device: what they give, and how long one evaluation takes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.float_texture import float_texture
from viewer.gpu.program import compile_sources
from viewer.gpu.source import assemble
from viewer.measure.report.timing import Effort, Timing

from .piece import Kernel

SIDE = 256
"""Pixels of the target's side. What is timed runs in neighbouring fragments, as in a picture."""
_LEAST_DRAW_S = 8e-3
_MOST_TIMES = 1 << 12

# q holds the parameters after the first four, which are p. u_zero is 0, which the compiler does not know: so it cannot
# compute the iterations of the loop once.
_MAIN = """
uniform sampler2D u_p;
uniform sampler2D u_q;
uniform float u_zero;
uniform int u_times;
out vec4 o_value;
void main() {{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 first_p = texelFetch(u_p, pixel, 0), first_q = texelFetch(u_q, pixel, 0);
    o_value = vec4(0.0);
    for (int k = 0; k < u_times; ++k) {{
        vec4 p = first_p + u_zero * float(k), q = first_q + u_zero * float(k);
        o_value += {call};
    }}
}}
"""
_EMPTY = Kernel("sample/luminance.glsl", "vec4(p.x)")


THOROUGH = Effort(least=5, most=15, seconds=0.3)
"""How often the loops of each kernel are timed."""


class Device:
    """Runs kernels in an OpenGL context."""

    def __init__(self, context: Context) -> None:
        self._context, self._gl = context, context.gl
        # On a software driver the device is the processor, whose time does not depend on what else is running.
        self._clock = time.process_time if context.is_software else time.perf_counter
        self._empty = _Program(context, _EMPTY)
        self._target = self._gl.framebuffer([self._gl.texture((SIDE, SIDE), 4, dtype="f4")])

    def values(self, kernel: Kernel, parameters: np.ndarray) -> np.ndarray:
        """What a kernel gives for each of `parameters`, (H, W, 4 or 8): (H, W, 4) float32."""
        height, width = parameters.shape[:2]
        program, textures = _Program(self._context, kernel), self._upload(parameters)
        target = self._gl.framebuffer([self._gl.texture((width, height), 4, dtype="f4")])
        program.draw(target, textures, 1)
        values = np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(height, width, 4)
        target.color_attachments[0].release()
        target.release()
        for texture in textures:
            texture.release()
        program.release()
        return values

    def costs(self, kernels: Sequence[Kernel], parameters: np.ndarray, effort: Effort) -> list[Timing]:
        """Nanoseconds of one evaluation of each, beyond those of a loop that evaluates nothing.

        They take turns, each followed by the empty loop, so that other load on the machine affects all alike.
        """
        programs = [_Program(self._context, kernel) for kernel in kernels]
        rows, columns = (np.arange(SIDE) * length // SIDE for length in parameters.shape[:2])
        textures = self._upload(parameters[rows][:, columns])
        times = [self._enough(program, textures) for program in programs]
        extra: list[list[float]] = [[] for _ in kernels]
        started = time.perf_counter()
        while not effort.is_enough(len(extra[0]), (time.perf_counter() - started) / len(kernels)):
            for program, n, found in zip(programs, times, extra):
                seconds = self._seconds(program, textures, n) - self._seconds(self._empty, textures, n)
                found.append(seconds / (SIDE * SIDE * n))
        for program in programs:
            program.release()
        for texture in textures:
            texture.release()
        return [Timing.of([1e6 * seconds for seconds in found]) for found in extra]  # its thousandths are nanoseconds

    def _enough(self, program: _Program, textures: Sequence[moderngl.Texture]) -> int:
        """How often the loop is to turn for a draw that can be timed; the program and the empty one are warm then."""
        times = 1
        self._seconds(program, textures, times)
        while self._seconds(program, textures, times) < _LEAST_DRAW_S and times < _MOST_TIMES:
            times *= 4
        self._seconds(self._empty, textures, times)
        return times

    def _seconds(self, program: _Program, textures: Sequence[moderngl.Texture], times: int) -> float:
        started = self._clock()
        program.draw(self._target, textures, times)
        self._gl.finish()
        return self._clock() - started

    def _upload(self, parameters: np.ndarray) -> list[moderngl.Texture]:
        whole = np.zeros((*parameters.shape[:2], 8), np.float32)
        whole[..., : parameters.shape[2]] = parameters
        return [float_texture(self._gl, half) for half in (whole[..., :4], whole[..., 4:])]

    def release(self) -> None:
        self._target.color_attachments[0].release()
        self._target.release()
        self._empty.release()


class _Program:
    def __init__(self, context: Context, kernel: Kernel) -> None:
        source = assemble(kernel.file, kernel.defines)
        samplers = "".join(f"uniform sampler2D {name};\n" for name in kernel.textures)
        main = samplers + _MAIN.format(call=kernel.call)
        origin = source.origins[-1]
        fragment = replace(source, text=source.text + main, origins=source.origins + [origin] * main.count("\n"))
        self._program = compile_sources(context, {"vertex": assemble("display/fullscreen.vert"), "fragment": fragment})
        self._triangle = context.gl.vertex_array(self._program, [])
        self._textures = {name: make(context) for name, make in kernel.textures.items()}
        for name, value in kernel.uniforms.items():
            uniform = self._program[name]
            assert isinstance(uniform, moderngl.Uniform)
            uniform.write(np.ascontiguousarray(value, np.float32).tobytes())

    def draw(self, target: moderngl.Framebuffer, parameters: Sequence[moderngl.Texture], times: int) -> None:
        target.use()
        target.ctx.enable_only(moderngl.NOTHING)
        for unit, (name, texture) in enumerate([*zip(("u_p", "u_q"), parameters), *self._textures.items()]):
            texture.use(unit)
            if name in self._program:
                self._program[name] = unit
        self._program["u_times"] = times
        if "u_zero" in self._program:
            self._program["u_zero"] = 0.0
        self._triangle.render(vertices=3)

    def release(self) -> None:
        self._triangle.release()
        self._program.release()
        for texture in self._textures.values():
            texture.release()
