"""How many bytes of textures and buffers a program of ours makes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from viewer.gpu.context import Context


@contextmanager
def counted_bytes() -> Iterator[list[float]]:
    """Bytes of the textures, depth maps and buffers that are made meanwhile, in the list's one entry."""
    total = [0.0]
    makers = {name: getattr(moderngl.Context, name) for name in ("texture", "depth_texture", "buffer")}
    function = Context.function

    def texture(self, size, components, *args, dtype="f1", samples=0, **kwargs):
        total[0] += size[0] * size[1] * components * max(int(dtype[-1]), 1) * max(samples, 1)
        return makers["texture"](self, size, components, *args, dtype=dtype, samples=samples, **kwargs)

    def depth_texture(self, size, *args, **kwargs):
        total[0] += size[0] * size[1] * 4
        return makers["depth_texture"](self, size, *args, **kwargs)

    def buffer(self, *args, **kwargs):
        made = makers["buffer"](self, *args, **kwargs)
        total[0] += made.size
        return made

    def counting(self, name, *arguments):
        call = function(self, name, *arguments)
        if name != "glTexImage2D":
            return call

        def image(target, level, internal, width, height, border, form, kind, data):
            total[0] += width * height * _COMPONENTS[form] * _SIZES[kind]
            return call(target, level, internal, width, height, border, form, kind, data)

        return image

    moderngl.Context.texture, moderngl.Context.depth_texture, moderngl.Context.buffer = texture, depth_texture, buffer
    Context.function = counting
    try:
        yield total
    finally:
        for name, maker in makers.items():
            setattr(moderngl.Context, name, maker)
        Context.function = function


_COMPONENTS = {0x1903: 1, 0x8227: 2, 0x1907: 3, 0x1908: 4, 0x1902: 1}
_SIZES = {0x1401: 1, 0x1403: 2, 0x140B: 2, 0x1406: 4}
