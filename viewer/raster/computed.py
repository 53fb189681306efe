"""Arrays that a fragment shader computes."""

from __future__ import annotations

from collections.abc import Mapping

import moderngl
import numpy as np

from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..plan.model import Program


def compute(gl: moderngl.Context, programs: Programs, planned: Program, size: tuple[int, int], outputs: int,
            uniforms: Mapping[str, object]) -> list[np.ndarray]:
    """The outputs of a pass over `size` (columns, rows), each (rows, columns, 4) float32. The uniform blocks of lights
    and of shadow maps have the bindings 0 and 1."""
    targets = [gl.texture(size, 4, dtype="f4") for _ in range(outputs)]
    framebuffer = gl.framebuffer(targets)
    program = programs.get("display/fullscreen.vert", planned.fragment, dict(planned.switches))
    for name, value in uniforms.items():
        set_uniform(program, name, value)
    for binding, name in enumerate(("Lights", "Shadows")):
        if name in program:
            program[name].binding = binding
    framebuffer.use()
    gl.enable_only(moderngl.NOTHING)
    fullscreen(gl, program).render(vertices=3)
    arrays = [np.frombuffer(target.read(), np.float32).reshape(size[1], size[0], 4) for target in targets]
    gl.screen.use()  # moderngl goes back to the framebuffer last used, be it gone
    for thing in (framebuffer, *targets):
        thing.release()
    return arrays
