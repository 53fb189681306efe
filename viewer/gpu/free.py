"""Frees what was made with an OpenGL context."""

from __future__ import annotations

import moderngl

from ..base.reusable import Releasable


def free(gl: moderngl.Context, *things: Releasable | None) -> None:
    """Free these; no framebuffer is in use afterwards."""
    gl.screen.use()  # moderngl goes back to the framebuffer last used, be it gone
    for thing in things:
        if thing is not None:
            thing.release()
