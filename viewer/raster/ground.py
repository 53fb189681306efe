"""The pass that draws the shadow which the model casts on the ground below it (shaders/raster/ground.frag)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import moderngl
import numpy as np

from ..bake.many_lights import ManyLights
from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.ground import FAR_LIGHTS
from ..plan.model import Plan
from ..scene.color import LUMINANCE
from ..scene.frame import Frame
from ..scene.ground import ground_height
from ..scene.scene import Scene
from .depth import Depth
from .environment import EnvironmentLight
from .shadows import Atlas, Casters, directional_tiles
from .surfaces import bind_blocks
from .units import UNIT_BACKGROUND

_SAMPLES = 160
"""Lights that stand for the whole environment. Those below the horizon do not light the ground."""
_TILE = 256
_BINDING = 2
"""That of the uniform block, after those of lights and shadows."""


class GroundPass:
    """Owns the shadow maps of the lights that stand for the environment."""

    def __init__(self, context: Context, programs: Programs, depth: Depth, casters: Casters) -> None:
        self._gl, self._programs, self._depth, self._casters = context.gl, programs, depth, casters
        self._atlas: Atlas | None = None
        self._key: tuple[object, ...] = ()
        self._source: object = None  # held, so that its id is that of no other
        self._scene: Scene | None = None
        self._block: moderngl.Buffer | None = None

    def prepare(self, scene: Scene, plan: Plan, environment: EnvironmentLight | None) -> None:
        """Draw the shadow maps of `plan`, unless they show this scene and its environment already."""
        if plan.ground is None or not plan.ground["FAR_LIGHTS"] or environment is None:
            return
        sky = environment.environment
        key = id(sky.source), sky.rotation, sky.intensity, plan.ambient
        if key == self._key and self._scene is not None and scene.has_surfaces_of(self._scene):
            return
        self.release()
        self._key, self._scene, self._source = key, scene, sky.source
        lights = environment.sky_lights(plan, _SAMPLES)
        above = np.flatnonzero(lights.directions[:, 1] > 0)[:FAR_LIGHTS]
        lights = replace(lights, directions=lights.directions[above], irradiance=lights.irradiance[above])
        self._atlas = Atlas(self._gl, max(len(above), 1), _TILE)
        tiles = directional_tiles(-lights.directions, scene, self._atlas.tile_size)
        self._atlas.draw(scene, tiles, [draw for draw in plan.draws if draw.hides_sky], self._casters)
        rows = _rows(scene, self._atlas, lights, [tile.matrix for tile in tiles])
        self._block = self._gl.buffer(rows.astype(np.float32))

    def draw(self, frame: Frame, plan: Plan, uniforms: dict[str, object]) -> None:
        """Darken what is behind all surfaces of the framebuffer in use, within `Depth.test()`."""
        assert plan.ground is not None
        program = self._programs.get("display/fullscreen.vert", plan.ground.fragment, dict(plan.ground.switches))
        scene, height = frame.scene, ground_height(frame.scene)
        below = frame.position((scene.center[0], height, scene.center[2]))
        for name, value in (uniforms | {"u_height": float(below[1]), "u_below": tuple(below)}).items():
            set_uniform(program, name, value)
        set_uniform(program, "u_ray", matrix_uniform(frame.ray))
        set_uniform(program, "u_ray_origin", matrix_uniform(frame.ray_origin))
        bind_blocks(program)
        if self._block is not None and self._atlas is not None and "GroundLights" in program:
            self._block.bind_to_uniform_block(_BINDING)
            program["GroundLights"].binding = _BINDING
            self._atlas.texture.use(UNIT_BACKGROUND)
            set_uniform(program, "u_atlas", UNIT_BACKGROUND)
        self._gl.enable_only(moderngl.DEPTH_TEST | (moderngl.BLEND if plan.fills_behind else 0))
        self._gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        with self._depth.behind_surfaces():
            fullscreen(self._gl, program).render(vertices=3)

    def release(self) -> None:
        for thing in (self._atlas, self._block):
            if thing is not None:
                thing.release()
        self._atlas = self._block = self._scene = None


def _rows(scene: Scene, atlas: Atlas, lights: ManyLights, matrices: Sequence[np.ndarray]) -> np.ndarray:
    """The uniform block, (FAR_LIGHTS, 4, 4), black beyond the last light. `matrices` take points about the scene's
    centre, in its radius, to clip space."""
    width, height = atlas.size
    from_below = np.eye(4)
    from_below[1, 3] = (ground_height(scene) - scene.center[1]) / scene.radius
    rows = np.zeros((FAR_LIGHTS, 4, 4))
    for k, matrix in enumerate(matrices):
        rows[k, :2] = (matrix @ from_below)[:2] / 2
        rows[k, :2, 3] += 0.5
        rows[k, 2] = (*np.divide(atlas.corner(k), (width, height)), atlas.tile_size / width, atlas.tile_size / height)
    rows[:len(matrices), 3, 0] = lights.irradiance @ LUMINANCE * lights.directions[:, 1]
    return rows
