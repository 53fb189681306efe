"""Passes over all of a target: one triangle, whose corners a vertex shader makes of their numbers."""

from __future__ import annotations

import moderngl


def fullscreen(gl: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
    """The vertex array, without attributes, that display/fullscreen.vert wants."""
    if program.extra is None:
        program.extra = gl.vertex_array(program, [])
    return program.extra
