"""Runs GLSL of the tracer on rows of numbers, one pixel for each row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.program import compile_sources
from viewer.gpu.source import assemble
from viewer.trace.defines import shader_defines

_WIDTH = 4096  # rows of numbers in one row of the textures


def evaluate(
    context: Context, folder: Path, include: str, body: str, rows: np.ndarray, outputs: int = 1,
    switches: Mapping[str, int] | None = None, bind: Callable[[moderngl.Program], None] = lambda program: None,
) -> np.ndarray:
    """What `body` assigns to the vec4s o0, o1, ... for each row: (N, outputs, 4) float64.

    A row of `rows`, (N, C) float32 or (bits are kept) uint32, C up to 16, is the uvec4s i0, i1, i2, i3 in the body, and
    the vec4s f0 .. f3. `include` is a file of the shaders folder, `bind` sets its uniforms; texture unit 15 is taken.
    """
    gl = context.gl
    context.make_current()
    count = len(rows)
    width, height = min(count, _WIDTH), -(-count // _WIDTH)
    bits = np.zeros((width * height, 16), np.uint32)
    bits[:count, : rows.shape[1]] = np.ascontiguousarray(rows).view(np.uint32)
    reads = "".join(f"uvec4 i{k} = texelFetch(harness_rows, ivec2(gl_FragCoord.xy) + ivec2(0, {k * height}), 0);"
                    f"vec4 f{k} = uintBitsToFloat(i{k});" for k in range(4))
    declared = "".join(f"layout(location = {k}) out vec4 o{k};\n" for k in range(outputs))
    file = folder / "harness.frag"
    file.write_text(f'#include "{include}"\nuniform usampler2D harness_rows;\n{declared}'
                    f"void main() {{ {reads}\n{body} }}\n")
    vertex = assemble("display/fullscreen.vert")
    program = compile_sources(context, {"vertex": vertex, "fragment": assemble(file, shader_defines(switches))})
    table = gl.texture((width, 4 * height), 4, bits.reshape(-1, 4, 4).transpose(1, 0, 2).tobytes(), dtype="u4")
    targets = [gl.texture((width, height), 4, dtype="f4") for _ in range(outputs)]
    target = gl.framebuffer(targets)
    target.use()
    gl.enable_only(moderngl.NOTHING)
    bind(program)
    table.use(15)
    if "harness_rows" in program:
        program["harness_rows"] = 15
    gl.vertex_array(program, []).render(moderngl.TRIANGLES, 3)
    found = [np.frombuffer(texture.read(), np.float32).reshape(-1, 4)[:count] for texture in targets]
    for thing in (target, *targets, table, program):
        thing.release()
    return np.stack(found, axis=1).astype(np.float64)
