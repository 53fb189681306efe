"""GLSL functions called on arrays: one pixel an input."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import moderngl
import numpy as np
import pytest
from contexts import open_or_skip

from viewer.gpu.context import Context
from viewer.gpu.smooth_map import SmoothMap
from viewer.gpu.source import assemble

VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID == 1, gl_VertexID == 2) * 4.0 - 1.0, 0.0, 1.0); }
"""


@pytest.fixture(scope="module")
def egl() -> Iterator[Context]:
    with open_or_skip("egl") as context:
        yield context


@pytest.fixture(scope="module")
def gl(egl: Context) -> moderngl.Context:
    return egl.gl


@pytest.fixture
def evaluate(gl, tmp_path: Path):
    """Runs GLSL on each row of `inputs`, (N, 4), as the vec4 `i`: what `expression`, a vec4, gives, (N, 4) float64.

    `include` is a file of the shaders folder, without its ending. `uniforms` are arrays, a texture or a map, declared
    in `declarations`.
    """

    def run(include: str, expression: str, inputs: np.ndarray, declarations: str = "",
            defines: Mapping[str, float] | None = None,
            **uniforms: np.ndarray | moderngl.Texture | moderngl.Texture3D | SmoothMap) -> np.ndarray:
        file = tmp_path / "evaluate.frag"
        file.write_text(f'#include "{include}.glsl"\n{declarations}\nuniform sampler2D inputs;\nout vec4 o;\n'
                        "void main() { vec4 i = texelFetch(inputs, ivec2(gl_FragCoord.xy), 0);"
                        f" o = {expression}; }}\n")
        program = gl.program(vertex_shader=VERTEX, fragment_shader=assemble(file, defines).text)
        count = len(inputs)
        texture = gl.texture((count, 1), 4, np.ascontiguousarray(inputs, "f4"), dtype="f4")
        texture.use(0)
        if "inputs" in program:  # it is not where the expression has no use for it
            program["inputs"] = 0
        for name, value in uniforms.items():
            if isinstance(value, moderngl.Texture | moderngl.Texture3D):
                value.use(1)
                program[name] = 1
            elif isinstance(value, SmoothMap):
                value.bind(program, name, 1)
            else:
                program[name].write(value.astype("f4").tobytes())
        target = gl.framebuffer([gl.texture((count, 1), 4, dtype="f4")])
        target.use()
        gl.vertex_array(program, []).render(moderngl.TRIANGLES, 3)
        return np.frombuffer(target.read(components=4, dtype="f4"), "f4").reshape(count, 4).astype(np.float64)

    return run
