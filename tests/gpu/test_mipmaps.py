"""What is given to `mipmapped_texture` is what shaders see, level by level."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np
import pytest

from viewer.gpu.context import Context, open_context
from viewer.gpu.mipmaps import mipmapped_texture
from viewer.scene.color import srgb_to_linear

_VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
_FRAGMENT = """#version 330 core
uniform sampler2D u_texture;
uniform int u_level;
out vec4 o_texel;
void main() { o_texel = texelFetch(u_texture, ivec2(gl_FragCoord.xy), u_level); }
"""
_LOD = """#version 330 core
uniform sampler2D u_texture;
uniform float u_lod;
uniform vec2 u_uv;
out vec4 o_texel;
void main() { o_texel = textureLod(u_texture, u_uv, u_lod); }
"""
SIZES = [(5, 12), (2, 6), (1, 3), (1, 1)]  # rows of odd bytes, for the alignment


@pytest.fixture(scope="module")
def context() -> Iterator[Context]:
    with open_context() as context:
        yield context


def draw(context: Context, texture: moderngl.Texture, fragment: str, size: tuple[int, int], **uniforms) -> np.ndarray:
    """(H, W, 4) float32 of what the fragment shader reads."""
    gl = context.gl
    program = gl.program(vertex_shader=_VERTEX, fragment_shader=fragment)
    for name, value in uniforms.items():
        program[f"u_{name}"].value = value
    target = gl.framebuffer([gl.renderbuffer(size[::-1], 4, dtype="f4")])
    target.use()
    texture.use(3)
    program["u_texture"].value = 3
    gl.vertex_array(program, []).render(vertices=3)
    return np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(*size, 4)


def levels_of(dtype: str, components: int) -> list[np.ndarray]:
    rng = np.random.default_rng(11)
    if dtype.startswith("u"):
        return [rng.integers(0, np.iinfo(dtype).max, (*size, components), dtype, endpoint=True) for size in SIZES]
    return [rng.uniform(0, 60000, (*size, components)).astype(dtype) for size in SIZES]


@pytest.mark.parametrize("components", [1, 2, 3, 4])
@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float16", "float32"])
def test_every_level_holds_its_texels(context, dtype, components):
    levels = levels_of(dtype, components)
    texture = mipmapped_texture(context, levels)
    for number, level in enumerate(levels):
        expected = level / np.iinfo(dtype).max if dtype.startswith("u") else level
        seen = draw(context, texture, _FRAGMENT, level.shape[:2], level=number)
        assert seen[..., :components] == pytest.approx(expected, rel=1e-6)
    texture.release()


@pytest.mark.parametrize("components", [3, 4])
def test_srgb_colours_are_decoded_and_alpha_is_not(context, components):
    levels = levels_of("uint8", components)
    texture = mipmapped_texture(context, levels, srgb=True)
    for number, level in enumerate(levels):
        expected = level / 255
        expected[..., :3] = srgb_to_linear(expected[..., :3])
        seen = draw(context, texture, _FRAGMENT, level.shape[:2], level=number)
        assert seen[..., :components] == pytest.approx(expected, abs=2e-3 if context.is_software else 2**-8)
    texture.release()


def test_lookups_blend_levels_repeat_and_stop_at_the_last(context):
    levels = [np.full((4 >> k, 4 >> k, 1), value, np.float32) for k, value in enumerate([1.0, 3.0])]
    levels[0][:, 3] = 5.0
    texture = mipmapped_texture(context, levels)
    at = lambda u, lod: draw(context, texture, _LOD, (1, 1), uv=(u, 0.5), lod=lod)[0, 0, 0]  # noqa: E731
    assert at(0.375, 0.5) == pytest.approx(2.0, rel=1e-2)
    assert at(1.0, 0.0) == pytest.approx(3.0, rel=1e-2)  # between the last column and the first
    assert at(0.5, 9.0) == pytest.approx(3.0)
    texture.repeat_x = False
    assert at(1.0, 0.0) == pytest.approx(5.0)
    texture.release()


def test_no_texture_unit_in_use_is_disturbed(context):
    first = mipmapped_texture(context, [np.full((1, 1, 1), 7.0, np.float32)])
    gl = context.gl
    program = gl.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
    program["u_texture"].value = 3
    target = gl.framebuffer([gl.renderbuffer((1, 1), 4, dtype="f4")])
    target.use()
    first.use(3)
    second = mipmapped_texture(context, [np.full((1, 1, 1), 9.0, np.float32)])
    gl.vertex_array(program, []).render(vertices=3)
    assert np.frombuffer(target.read(components=4, dtype="f4"), np.float32)[0] == 7.0
    first.release()
    second.release()


def test_levels_that_the_driver_cannot_hold_are_left_out(context, monkeypatch):
    monkeypatch.setitem(context.gl.info, "GL_MAX_TEXTURE_SIZE", 4)
    levels = [np.full((side, side, 1), 10 * k, np.uint8) for k, side in enumerate((16, 8, 4, 2, 1))]
    texture = mipmapped_texture(context, levels)
    assert context.gl.error == "GL_NO_ERROR"
    for number, level in enumerate(levels[2:]):
        side = len(level)
        shown = draw(context, texture, _FRAGMENT, (side, side), level=number)
        assert np.abs(shown[..., 0] * 255 - 10 * (number + 2)).max() < 0.01
