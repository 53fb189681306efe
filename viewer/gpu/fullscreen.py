"""Full-screen passes: one triangle, whose corners the vertex shader computes from gl_VertexID."""

from __future__ import annotations

import moderngl


def fullscreen(gl: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
    """A vertex array without attributes, for shaders/display/fullscreen.vert. It is made once for each program."""
    if program.extra is None:
        program.extra = gl.vertex_array(program, [])
    return program.extra
