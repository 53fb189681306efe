"""GLSL with its uniforms and textures run on rows of numbers: one pixel a row."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.source import assemble

_VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID == 1, gl_VertexID == 2) * 4.0 - 1.0, 0.0, 1.0); }
"""
_WIDTH = 4096


def run_pixels(context: Context, include: str, body: str, inputs: np.ndarray, bind: Callable[[moderngl.Program], None],
               defines: Mapping[str, float] | None = None) -> np.ndarray:
    """What `body` leaves in `vec4 o[2]`, given `vec4 i` from each row of `inputs` (N, 4): (N, 2, 4) float64.

    `include` is a file of the shaders folder; `bind` binds its textures and sets its uniforms. Texture unit 15 is taken.
    """
    gl = context.gl
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "pixels.frag")
        file.write_text(f'#include "{include}"\nuniform sampler2D inputs;\nlayout(location = 0) out vec4 o_0;\n'
                        "layout(location = 1) out vec4 o_1;\nvoid main() {\n"
                        "vec4 i = texelFetch(inputs, ivec2(gl_FragCoord.xy), 0); vec4 o[2];\n"
                        f"{body}\no_0 = o[0]; o_1 = o[1];\n}}\n")
        program = gl.program(vertex_shader=_VERTEX, fragment_shader=assemble(file, defines).text)
    rows = -(-len(inputs) // _WIDTH)
    padded = np.zeros((rows * _WIDTH, 4), np.float32)
    padded[: len(inputs)] = inputs
    texture = gl.texture((_WIDTH, rows), 4, padded, dtype="f4")
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    bind(program)
    texture.use(15)
    if "inputs" in program:
        program["inputs"] = 15
    target = gl.framebuffer([gl.texture((_WIDTH, rows), 4, dtype="f4") for _ in range(2)])
    target.use()
    gl.disable(moderngl.DEPTH_TEST | moderngl.BLEND)
    vertices = gl.vertex_array(program, [])
    vertices.render(moderngl.TRIANGLES, 3)
    planes = [np.frombuffer(target.read(components=4, attachment=k, dtype="f4"), "f4") for k in range(2)]
    for resource in (vertices, program, texture, *target.color_attachments, target):
        resource.release()
    return np.stack([plane.reshape(-1, 4)[: len(inputs)] for plane in planes], axis=1).astype(np.float64)
