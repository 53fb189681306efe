from __future__ import annotations

import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.short_depth import read_depths, short_depth_texture, write_depths


def test_what_is_drawn_is_rounded_to_16_bits(context: Context) -> None:
    texture = short_depth_texture(context, (6, 3))
    framebuffer = context.gl.framebuffer(depth_attachment=texture)
    framebuffer.clear(depth=0.4)
    assert read_depths(context, texture, (6, 3)).tolist() == [[round(0.4 * 65535)] * 6] * 3
    framebuffer.release()
    texture.release()


def test_what_is_written_is_read(context: Context) -> None:
    depths = np.arange(21, dtype=np.uint16).reshape(3, 7) * 3000  # rows of an odd length have no padding
    texture = short_depth_texture(context, (7, 3))
    write_depths(context, texture, depths)
    assert np.array_equal(read_depths(context, texture, (7, 3)), depths)
    framebuffer = context.gl.framebuffer(depth_attachment=texture)
    framebuffer.clear(depth=1.0)
    assert (read_depths(context, texture, (7, 3)) == 65535).all()
    framebuffer.release()
    texture.release()
    assert context.gl.error == "GL_NO_ERROR"
