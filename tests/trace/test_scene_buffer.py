"""viewer/trace/scene/scene_buffer.py: shaders read exactly the bits that were added."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate

from viewer.errors import InputError
from viewer.trace.scene import scene_buffer
from viewer.trace.scene.scene_buffer import SceneBufferBuilder

WIDTH = 4096
RANDOM = np.random.default_rng(3)


def test_a_shader_finds_every_bit(context, tmp_path):
    buffer = SceneBufferBuilder()
    first = RANDOM.integers(0, 1 << 32, (WIDTH - 3, 4), dtype=np.uint32)
    # Bits that a float texture might change: signalling NaN, denormals, infinities.
    special = np.array([[0x7F800001, 0xFF812345, 1, 0x80000001], [0x7F800000, 0xFF800000, 0x007FFFFF, 0x7FFFFFFF]],
                       np.uint32)
    floats = RANDOM.normal(size=(2 * WIDTH, 4)).astype(np.float32)
    offsets = [buffer.add("first", first), buffer.add("special", special), buffer.add("floats", floats)]
    assert offsets == [0, WIDTH - 3, WIDTH - 1]
    assert buffer.uniforms() == {"u_first": 0, "u_special": WIDTH - 3, "u_floats": WIDTH - 1}
    texture = buffer.texture(context)
    everything = np.concatenate([first, special, floats.view(np.uint32)])
    assert buffer.count == len(everything)

    def bind(program):
        texture.bind(program, "u_scene", 0)

    asked = np.concatenate([RANDOM.integers(0, len(everything), 2000), np.arange(WIDTH - 5, WIDTH + 3)])
    # As two 16-bit halves, which float targets hold exactly.
    halves = evaluate(context, tmp_path, "trace/scene_buffer.glsl",
                      "uvec4 w = scene_uint4(int(i0.x)); o0 = vec4(w & 0xffffu); o1 = vec4(w >> 16);",
                      asked[:, None].astype(np.uint32), 2, bind=bind)
    np.testing.assert_array_equal(halves[:, 0] + 65536 * halves[:, 1], everything[asked])
    k = RANDOM.integers(0, len(floats), 500)
    found = evaluate(context, tmp_path, "trace/scene_buffer.glsl", "o0 = scene_float4(int(i0.x));",
                     (k[:, None] + offsets[2]).astype(np.uint32), bind=bind)
    np.testing.assert_array_equal(found[:, 0], floats[k])


def test_nothing_at_all_is_a_texture_too(context):
    buffer = SceneBufferBuilder()
    buffer.add("triangles", np.zeros((0, 4), np.uint32))
    buffer.texture(context).release()


def test_mistakes_are_told():
    buffer = SceneBufferBuilder()
    buffer.add("lights", np.zeros((1, 4), np.float32))
    with pytest.raises(ValueError, match="already"):
        buffer.add("lights", np.zeros((1, 4), np.float32))
    for wrong in (np.zeros((1, 3), np.float32), np.zeros((1, 4)), np.zeros(4, np.uint32)):
        with pytest.raises(ValueError, match="32 bits"):
            buffer.add("wrong", wrong)


def test_more_than_a_buffer_holds_is_one_clear_line(context, monkeypatch):
    monkeypatch.setattr(scene_buffer, "most_texels", lambda context: 8192)
    buffer = SceneBufferBuilder()
    buffer.add("triangles", np.zeros((8193, 4), np.uint32))
    with pytest.raises(InputError, match="^city.glb: too many triangles to trace here: 8193 texels"):
        buffer.texture(context, "city.glb")
