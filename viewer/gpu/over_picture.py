"""Draws a program over every pixel of a framebuffer, from textures of the same size."""

from __future__ import annotations

from collections.abc import Mapping

import moderngl

from .fullscreen import fullscreen
from .programs import set_uniform


def draw_over(gl: moderngl.Context, program: moderngl.Program, target: moderngl.Framebuffer,
              sources: Mapping[str, moderngl.Texture], flags: int = moderngl.NOTHING,
              uniforms: Mapping[str, object] | None = None) -> None:
    """`sources` are by the names of their samplers, on the first texture units. With the flag BLEND the colours are
    added."""
    target.use()
    gl.enable_only(flags)
    if flags & moderngl.BLEND:
        gl.blend_func = moderngl.ONE, moderngl.ONE
    for unit, (sampler, texture) in enumerate(sources.items()):
        texture.use(unit)
        set_uniform(program, sampler, unit)
    for uniform, value in (uniforms or {}).items():
        set_uniform(program, uniform, value)
    fullscreen(gl, program).render(vertices=3)
    gl.enable_only(moderngl.NOTHING)
