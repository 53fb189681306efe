"""The pass that draws the shadow which the model casts on the ground below it (shaders/raster/ground.frag)."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl

from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.model import Plan
from ..scene.color import LUMINANCE
from ..scene.frame import Frame
from ..scene.ground import ground_height
from ..scene.scene import Scene
from .depth import Depth
from .environment import EnvironmentLight
from .ground_map import draw_ground_map
from .kept_maps import KeptMaps
from .shadows import Atlas, Casters, Tile
from .surfaces import bind_blocks
from .units import UNIT_BACKGROUND

_LIGHTS = 160
"""How many stand for the whole environment. Those below the horizon do not light the ground."""


class GroundPass:
    """Owns the map of what the model hides of the environment's light."""

    def __init__(self, context: Context, programs: Programs, depth: Depth, casters: Casters, use_cache: bool) -> None:
        self._context, self._gl, self._programs = context, context.gl, programs
        self._depth, self._casters, self._kept = depth, casters, KeptMaps(context, use_cache)
        self._hidden: moderngl.Texture | None = None
        self._light = 0.0
        """Luminance of the irradiance of the ground by the environment."""
        self._key: tuple[object, ...] = ()
        self._source: object = None  # held, so that its id is that of no other
        self._scene: Scene | None = None

    def prepare(self, scene: Scene, plan: Plan, environment: EnvironmentLight | None) -> None:
        """Draw the map, unless it shows this scene and its environment already."""
        if plan.ground is None or not plan.ground["HAS_ENVIRONMENT"] or environment is None:
            return
        sky = environment.environment
        key = id(sky.source), sky.rotation, sky.intensity, plan.ambient
        if key == self._key and self._scene is not None and scene.has_surfaces_of(self._scene):
            return
        self.release()
        lights = environment.sky_lights(plan, _LIGHTS)
        above = lights.directions[:, 1] > 0
        directions = lights.directions[above]
        luminance = lights.irradiance[above] @ LUMINANCE * directions[:, 1]
        self._light = float(luminance.sum())
        parts = luminance / max(self._light, 1e-300)

        def draw_tiles(atlas: Atlas, tiles: Sequence[Tile]) -> None:
            draws = [draw for draw in plan.draws if draw.hides_sky]
            self._kept.draw(atlas, scene, tiles, draws, self._casters)

        self._hidden = draw_ground_map(self._context, self._programs, scene, directions, parts, draw_tiles)
        self._key, self._scene, self._source = key, scene, sky.source

    def draw(self, frame: Frame, plan: Plan, uniforms: dict[str, object]) -> None:
        """Darken what is behind all surfaces of the framebuffer in use, within `Depth.test()`."""
        assert plan.ground is not None
        program = self._programs.get("display/fullscreen.vert", plan.ground.fragment, dict(plan.ground.switches))
        scene, height = frame.scene, ground_height(frame.scene)
        below = frame.position((scene.center[0], height, scene.center[2]))
        values = {"u_height": float(below[1]), "u_below": tuple(below), "u_far_light": self._light,
                  "u_hidden": UNIT_BACKGROUND, "u_ray": matrix_uniform(frame.ray),
                  "u_ray_origin": matrix_uniform(frame.ray_origin)}
        for name, value in (uniforms | values).items():
            set_uniform(program, name, value)
        bind_blocks(program)
        if self._hidden is not None:
            self._hidden.use(UNIT_BACKGROUND)
        self._gl.enable_only(moderngl.DEPTH_TEST | (moderngl.BLEND if plan.fills_behind else 0))
        self._gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        with self._depth.behind_surfaces():
            fullscreen(self._gl, program).render(vertices=3)

    def release(self) -> None:
        free(self._gl, self._hidden)
        self._hidden = self._scene = None
