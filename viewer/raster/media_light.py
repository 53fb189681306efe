"""Light inside media on a coarse grid about them, which does not depend on the camera.

For each cell, a pass finds the light that arrives there without a collision: from lights, past the meshes in the way,
and from directions sampled from the environment (shaders/raster/media_bake.frag). From it a diffusion equation gives
the light that is scattered many times (viewer/bake/diffusion.py).
"""

from __future__ import annotations

import moderngl
import numpy as np

from ..bake.diffusion import scattered_fluence
from ..bake.many_lights import ManyLights, uniform_lights
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.media import SKY_LIGHTS, MediaPlan
from ..scene.medium import Medium

SIDE = 32


class MediaLight:
    """The grid's texture. It has two halves along z: scattered radiance below, and above the opacity of the media
    before the sky as a + b . direction."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self.texture = gl.texture3d((SIDE, SIDE, 2 * SIDE), 4, dtype="f4")
        self.texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self.texture.repeat_x = self.texture.repeat_y = self.texture.repeat_z = False
        self._targets = [gl.texture((SIDE, SIDE * SIDE), 4, dtype="f4") for _ in range(3)]
        self._framebuffer = gl.framebuffer(self._targets)

    def bake(self, programs: Programs, plan: MediaPlan, medium: Medium, length: float,
             sky: ManyLights | None, uniforms: dict[str, object]) -> None:
        """Fill the grid. `length` is that of its side in the units of `uniforms`, which place media, lights and grid in
        a space of their own. `sky` is the environment's light in that many directions, None without one."""
        program = programs.get("display/fullscreen.vert", plan.bake.fragment, dict(plan.bake.switches))
        for name, value in (uniforms | _sky_uniforms(sky) | {"u_side": SIDE}).items():
            set_uniform(program, name, value)
        for binding, name in enumerate(("Lights", "Shadows")):
            if name in program:
                program[name].binding = binding
        self._framebuffer.use()
        self._gl.enable_only(moderngl.NOTHING)
        fullscreen(self._gl, program).render(vertices=3)
        unscattered, hidden, extinction = (np.frombuffer(texture.read(), np.float32).reshape(SIDE, SIDE, SIDE, 4)
                                 for texture in self._targets)
        grid = np.zeros((2, SIDE, SIDE, SIDE, 4), np.float32)
        grid[1] = hidden
        if plan.scatters_again:
            light = np.clip(np.nan_to_num(unscattered, nan=0.0, posinf=1e30), 0, 1e30)
            fluence = scattered_fluence(extinction[..., 0], light, hidden[..., 0], length / SIDE, medium.albedo,
                                        medium.g)
            grid[0, ..., :3] = fluence / (4 * np.pi)
        self.texture.write(grid)

    def release(self) -> None:
        for thing in (self._framebuffer, *self._targets, self.texture):
            thing.release()


def _sky_uniforms(sky: ManyLights | None) -> dict[str, object]:
    """Directions, their irradiance, and what fits a + b . direction to values at them by weighted least squares."""
    lights = sky if sky is not None else uniform_lights(SKY_LIGHTS, (1.0, 1.0, 1.0))
    weights = lights.irradiance.sum(axis=1)
    weights = weights / max(weights.sum(), 1e-300) + 1e-3 / SKY_LIGHTS
    basis = np.concatenate([np.ones((SKY_LIGHTS, 1)), lights.directions], axis=1)
    moments = (basis * weights[:, None]).T @ basis
    irradiance = np.clip(lights.irradiance, 0, 1e30) * (sky is not None)
    return {"u_sky_directions": np.float32(np.concatenate([lights.directions, weights[:, None]], axis=1)).tobytes(),
            "u_sky_irradiance": np.float32(irradiance).tobytes(),
            "u_sky_fit": matrix_uniform(np.linalg.inv(moments))}
