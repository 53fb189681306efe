"""shaders/light/: the lookups of image-based light against what viewer/bake says they do."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from viewer.bake.dfg import SIZE, dfg_table
from viewer.bake.prefilter import LEVEL_ROUGHNESS, lod_of_roughness
from viewer.errors import ContextError
from viewer.gpu.context import create_context
from viewer.gpu.source import assemble

VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID == 1, gl_VertexID == 2) * 4.0 - 1.0, 0.0, 1.0); }
"""
COUNT = 1024


@pytest.fixture(scope="module")
def gl() -> Iterator[moderngl.Context]:
    try:
        context = create_context("egl")
    except ContextError as error:
        pytest.skip(str(error))
    with context:
        yield context.gl


@pytest.fixture
def evaluate(gl, tmp_path: Path):
    """Runs GLSL on each of COUNT inputs `i` (vec4): evaluate(includes, expression, inputs, **uniforms) -> (COUNT, 4)."""

    def run(include: str, declarations: str, expression: str, inputs: np.ndarray, **uniforms) -> np.ndarray:
        file = tmp_path / "evaluate.frag"
        file.write_text(f'#include "light/{include}.glsl"\n{declarations}\nuniform sampler2D inputs;\nout vec4 o;\n'
                        f"void main() {{ vec4 i = texelFetch(inputs, ivec2(gl_FragCoord.xy), 0); o = {expression}; }}\n")
        program = gl.program(vertex_shader=VERTEX, fragment_shader=assemble(file).text)
        texture = gl.texture((COUNT, 1), 4, inputs.astype("f4").tobytes(), dtype="f4")
        texture.use(0)
        program["inputs"] = 0
        for name, value in uniforms.items():
            if isinstance(value, moderngl.Texture):
                value.use(1)
                program[name] = 1
            else:
                program[name].write(value.astype("f4").tobytes())
        target = gl.framebuffer([gl.texture((COUNT, 1), 4, dtype="f4")])
        target.use()
        gl.vertex_array(program, []).render(moderngl.TRIANGLES, 3)
        return np.frombuffer(target.read(components=4, dtype="f4"), "f4").reshape(COUNT, 4).astype(np.float64)

    return run


@pytest.fixture
def directions() -> np.ndarray:
    d = np.random.default_rng(7).normal(size=(COUNT, 4))
    d[:8, :3] = [(0, 1, 0), (0, -1, 0), (1, 0, 0), (-1, 0, 0), (-1, 0, -1e-7), (0, 0, 1), (0, 0, -1), (1e-5, 1, 0)]
    d[:, :3] /= np.linalg.norm(d[:, :3], axis=1, keepdims=True)
    d[:, 3] = np.linspace(0, 1, COUNT)
    return d


def test_equirect_uv(evaluate, directions):
    found = evaluate("equirect", "", "vec4(equirect_uv(i.xyz), 0.0, 0.0)", directions)
    u = 0.5 + np.arctan2(directions[:, 2], directions[:, 0]) / (2 * np.pi)
    v = np.arccos(directions[:, 1]) / np.pi
    assert np.isfinite(found).all()
    off = np.abs(found[:, 0] - u)[2:]  # at a pole any u will do
    assert np.minimum(off, 1 - off).max() < 1e-4 / (2 * np.pi)
    assert np.abs(found[:, 1] - v).max() < 5e-5 / np.pi


def test_lod_of_roughness(evaluate, directions):
    found = evaluate("prefiltered", "", "vec4(lod_of_roughness(i.w))", directions)[:, 0]
    assert np.abs(found - lod_of_roughness(directions[:, 3])).max() < 1e-5


def test_a_level_is_looked_up_where_its_direction_is(gl, evaluate, directions):
    # Levels that hold their own row's y = cos(theta), which a lookup must find again, the poles and seam included.
    texture = gl.texture((1024, 512), 3, dtype="f4")
    texture.build_mipmaps(max_level=5)
    for k in range(6):
        height = 512 >> k
        theta = np.pi * ((np.arange(height) + 0.5) / height - 1 / 32) / (15 / 16)
        phi = 2 * np.pi * ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5)
        sine = np.sin(theta)[:, None]
        level = np.stack([sine * np.cos(phi), np.cos(theta)[:, None] + 0 * phi, sine * np.sin(phi)], axis=-1)
        texture.write(level.astype("f4").tobytes(), level=k)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    look_up = "vec4(prefiltered_radiance(map, i.xyz, i.w), 0.0)"
    for level, roughness in enumerate(LEVEL_ROUGHNESS):
        directions[:, 3] = roughness
        found = evaluate("prefiltered", "uniform sampler2D map;", look_up, directions, map=texture)[:, :3]
        spacing = np.pi / (512 >> level) * 16 / 15
        assert np.abs(found - directions[:, :3]).max() < spacing**2 / 4 + 3e-3 * 2.0**-level + 3e-4


def test_irradiance_is_looked_up_along_the_normal(gl, evaluate, directions):
    # A map that is linear in the direction: bilinear lookup errs by its curvature alone.
    height = 32
    theta = np.pi * ((np.arange(height) + 0.5) / height - 1 / 32) / (15 / 16)
    phi = 2 * np.pi * ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5)
    sine = np.sin(theta)[:, None]
    rows = np.stack([sine * np.cos(phi), np.cos(theta)[:, None] + 0 * phi, sine * np.sin(phi)], axis=-1)
    texture = gl.texture((2 * height, height), 3, rows.astype("f4").tobytes(), dtype="f4")
    texture.repeat_x, texture.repeat_y = True, False
    found = evaluate("irradiance", "uniform sampler2D map;", "vec4(irradiance_over_pi(map, i.xyz), 0.0)", directions,
                     map=texture)[:, :3]
    assert np.abs(found - directions[:, :3]).max() < (np.pi / 30) ** 2 / 4 + 3e-3


def test_dfg_lookup_hits_the_table(gl, evaluate):
    table = gl.texture((SIZE, SIZE), 2, dfg_table().tobytes(), dtype="f4")
    table.repeat_x = table.repeat_y = False
    column, row = np.random.default_rng(9).integers(0, SIZE, (2, COUNT))
    inputs = np.stack([(row / (SIZE - 1)) ** 2, column / (SIZE - 1), column, row], axis=1)
    found = evaluate("dfg", "uniform sampler2D table;", "vec4(dfg_lookup(table, i.x, i.y), 0.0, 0.0)", inputs, table=table)
    # llvmpipe places samples to 1/256 of a texel, and the table is steep only towards the mirror at grazing view.
    assert np.abs(found[:, :2] - dfg_table()[row, column]).max() < 5e-3
