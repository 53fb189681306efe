"""The environment on the GPU: its filtered levels and irradiance for surfaces, and the map itself as background."""

from __future__ import annotations

import math
from dataclasses import replace

import moderngl
import numpy as np

from ..bake.background import background_map, blurred, is_magnified
from ..bake.dominant import ambient_and_key, mean_of
from ..bake.environment import BakedEnvironment, bake_environment
from ..bake.many_lights import ManyLights, many_lights, uniform_lights
from ..bake.phase import scattered_sky
from ..gpu.context import Context
from ..gpu.float_texture import float_texture
from ..gpu.fullscreen import fullscreen
from ..gpu.mipmaps import mipmapped_texture
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..gpu.smooth_map import SmoothMap, can_be_smooth
from ..plan.media import SKY_LIGHTS
from ..plan.model import Plan
from ..scene.environment import Environment
from ..scene.frame import Frame
from ..scene.light import Light
from ..scene.medium import Medium
from ..scene.mip_levels import mip_levels
from ..settings import Settings
from .depth import Depth
from .units import UNIT_BACKGROUND, UNIT_IRRADIANCE, UNIT_PREFILTERED, UNIT_SKY_IN_FOG, UNIT_SKY_IN_VOLUMES

_CONSTANT = np.ones((128, 256, 3), np.float32)
"""A level of radiance 1 from everywhere, with its margins."""


class EnvironmentLight:
    """Textures and uniforms of one environment, each made when a plan first needs it.

    `environment` may be replaced by one that differs in rotation and intensity only. Baked arrays are dropped once
    they are uploaded.
    """

    def __init__(self, context: Context, environment: Environment, settings: Settings, use_cache: bool) -> None:
        self._context, self._gl, self.environment = context, context.gl, environment
        self._ndf, self._use_cache = settings.ndf, use_cache
        self._baked: BakedEnvironment | None = None
        self._prefiltered: moderngl.Texture | None = None
        self._irradiance: moderngl.Texture | None = None
        self._background: _Background | None = None
        self._scattered: dict[tuple[float, bool], moderngl.Texture] = {}
        self._many_lights: dict[int, ManyLights] = {}

    def holds(self, environment: Environment, settings: Settings) -> bool:
        """Whether this is that environment, up to rotation and intensity."""
        return self.environment.source is environment.source and self._ndf == settings.ndf

    def bake(self, with_levels: bool) -> None:
        """Bake the irradiance, and `with_levels` the filtered levels for reflection, unless they are there."""
        has_levels = self._prefiltered is not None or bool(self._baked and self._baked.levels)
        if self._baked is None or (with_levels and not has_levels):
            self._baked = bake_environment(self.environment, self._ndf, self._use_cache, with_levels)
            self._many_lights.clear()  # they are in the unit of the old bake
            if self._irradiance is not None:  # its unit is the old bake's scale
                self._irradiance.release()
                self._irradiance = None

    @property
    def scale(self) -> float:
        """Of the radiance in the bake."""
        return self._baked.scale * self.environment.intensity

    def lights(self, settings: Settings) -> list[Light]:
        """The environment's suns; in mode phong, which reflects no environment, also its dominant direction.

        An environment that is not baked has none: it lights nothing.
        """
        if self._baked is None:
            return []
        turn, scale = rotation_about_y(self.environment.rotation).T, self.environment.intensity
        lights = list(self._baked.suns)
        if settings.mode == "phong":
            key = ambient_and_key(self._baked.irradiance)[1]
            lights.append(replace(key, intensity=key.intensity * self._baked.scale))
        return [
            replace(light, direction=tuple(turn @ light.direction), intensity=light.intensity * scale)
            for light in lights
        ]

    def _sky(self) -> np.ndarray:
        """The environment without its suns, the second filtered level, (H, W, 3) float64, in units of the bake's scale.
        """
        baked = self._baked
        if not baked.levels:  # they were dropped after upload, or irradiance alone was baked, which has its own scale
            baked = bake_environment(self.environment, ndf=self._ndf, cache=self._use_cache)
        return baked.levels[1].astype(np.float64) * (baked.scale / self._baked.scale)

    def many_lights(self, count: int) -> ManyLights:
        """The environment without its suns as `count` directional lights, in world axes, in units of `scale`."""
        if count not in self._many_lights:
            self._many_lights[count] = many_lights(self._sky(), count)
        lights = self._many_lights[count]
        return replace(lights, directions=lights.directions @ rotation_about_y(self.environment.rotation))

    def sky_lights(self, plan: Plan, count: int = SKY_LIGHTS) -> ManyLights:
        """The environment without its suns, as `plan` has it, as `count` directional lights in world axes."""
        if plan.ambient:
            return uniform_lights(count, self._ambient_radiance)
        lights = self.many_lights(count)
        return replace(lights, irradiance=lights.irradiance * self.scale)

    def scattered_sky(self, plan: Plan, fog: Medium, volumes: Medium) -> dict[str, object]:
        """The uniforms of shaders/raster/in_scattered.glsl: the environment as media scatter it; binds its maps."""
        media = {medium.phase: medium for medium in (fog, volumes)}
        wanted = {(phase, plan.ambient) for phase in media}
        for key in self._scattered.keys() - wanted:
            self._scattered.pop(key).release()
        for phase, is_constant in wanted - self._scattered.keys():
            level = _CONSTANT if is_constant else self._sky()
            pixels = scattered_sky(level, media[phase])
            texture = self._scattered[phase, is_constant] = float_texture(self._gl, pixels)
            texture.repeat_x = True
        self._scattered[fog.phase, plan.ambient].use(UNIT_SKY_IN_FOG)
        self._scattered[volumes.phase, plan.ambient].use(UNIT_SKY_IN_VOLUMES)
        scale = self._ambient_radiance if plan.ambient else self.scale
        return {"u_sky_in_fog": UNIT_SKY_IN_FOG, "u_sky_in_volumes": UNIT_SKY_IN_VOLUMES,
                "u_sky_intensity": tuple(np.broadcast_to(scale, 3).tolist())}

    @property
    def _ambient_radiance(self) -> np.ndarray:
        """The constant radiance (3,) by which mode phong replaces the environment, beside its main direction."""
        irradiance = ambient_and_key(self._baked.irradiance)[0]
        return irradiance * (self._baked.scale * self.environment.intensity / math.pi)

    def uniforms(self, plan: Plan) -> dict[str, object]:
        """The uniforms of surfaces; binds the textures."""
        values: dict[str, object] = {}
        if plan.ambient:
            ambient = ambient_and_key(self._baked.irradiance)[0] * self._baked.scale * self.environment.intensity
            values["u_ambient"] = tuple(ambient.tolist())
        if plan.environment:
            angle = self.environment.rotation
            values["u_environment_intensity"] = self.scale
            values["u_environment_rotation"] = (math.cos(angle), math.sin(angle))
            if self._irradiance is None:
                widest = self._baked.levels[-1:]
                self._irradiance = mipmapped_texture(self._context, [self._baked.irradiance, *widest])
                self._irradiance.repeat_y = False
            self._irradiance.use(UNIT_IRRADIANCE)
            values["u_irradiance"] = UNIT_IRRADIANCE
        if plan.environment and plan.has_subsurface:
            mean = mean_of(self._baked.irradiance) * self._baked.scale * self.environment.intensity
            values["u_environment_mean"] = tuple(mean.tolist())
        if plan.reflections:
            if self._prefiltered is None:
                self._prefiltered = mipmapped_texture(self._context, self._baked.levels[:-1])
                self._prefiltered.repeat_y = False
                self._baked = replace(self._baked, levels=())
            self._prefiltered.use(UNIT_PREFILTERED)
            values["u_prefiltered"] = UNIT_PREFILTERED
        return values

    def draw_background(self, programs: Programs, depth: Depth, frame: Frame, half_target: bool, plan: Plan,
                        uniforms: dict[str, object]) -> None:
        """Draw the environment behind everything, as `plan` has it; `uniforms` are those of media before it."""
        background = self._background_seen_at(frame.pixel_angle, plan.background_blur)
        program = programs.get("display/fullscreen.vert", "raster/background.frag",
                               {"HALF_TARGET": int(half_target), "SMOOTH": int(background.is_smooth),
                                "MEDIA": int(plan.media is not None)})
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        background.bind(program, frame.pixel_angle)
        set_uniform(program, "u_ray", matrix_uniform(rotation_about_y(self.environment.rotation) @ frame.ray))
        set_uniform(program, "u_environment_intensity", self.environment.intensity)
        self._gl.enable_only(moderngl.DEPTH_TEST)
        with depth.behind_surfaces():
            fullscreen(self._gl, program).render(vertices=3)

    def _background_seen_at(self, pixel_angle: float, blur: float) -> _Background:
        """The map itself, or blurred. It gets mip levels when it is first minified."""
        held = self._background
        if held is not None and held.blur == blur and held.suits(pixel_angle):
            return held
        if held is not None:
            held.release()
            self._background = None
        if blur > 0:
            pixels = background_map(blurred(self.environment.radiance, blur))
        elif self._baked is not None and self._baked.background is not None:
            pixels, self._baked = self._baked.background, replace(self._baked, background=None)
        else:
            pixels = background_map(self.environment.radiance)
        self._background = _Background(self._context, pixels, pixel_angle, blur)
        return self._background

    def release(self) -> None:
        for thing in (self._prefiltered, self._irradiance, self._background, *self._scattered.values()):
            if thing is not None:
                thing.release()


class _Background:
    """The map that is seen: by B-splines where it is magnified, else by trilinear lookups."""

    def __init__(self, context: Context, pixels: np.ndarray, pixel_angle: float, blur: float) -> None:
        self.blur = blur
        self._height, self._can_be_smooth = len(pixels), can_be_smooth(context, pixels)
        self.is_smooth = self._is_smooth_at(pixel_angle)
        self._has_levels = not self.is_smooth and self._lod(pixel_angle) > 0
        self._map: SmoothMap | moderngl.Texture
        if self.is_smooth:
            self._map = SmoothMap(context, pixels)
        else:
            self._map = mipmapped_texture(context, mip_levels(pixels) if self._has_levels else [pixels])
            self._map.repeat_y = False

    def suits(self, pixel_angle: float) -> bool:
        """Whether it is looked up in that way by pixels of that angle, in radians, and has the levels for it."""
        if self._is_smooth_at(pixel_angle):
            return self.is_smooth
        return not self.is_smooth and (self._has_levels or self._lod(pixel_angle) <= 0)

    def bind(self, program: moderngl.Program, pixel_angle: float) -> None:
        """Let `program` look it up for pixels of that angle."""
        if isinstance(self._map, SmoothMap):
            self._map.bind(program, "u_background", UNIT_BACKGROUND)
            return
        self._map.use(UNIT_BACKGROUND)
        set_uniform(program, "u_background", UNIT_BACKGROUND)
        set_uniform(program, "u_lod", self._lod(pixel_angle))

    def _is_smooth_at(self, pixel_angle: float) -> bool:
        return self._can_be_smooth and is_magnified(self._height, pixel_angle)

    def _lod(self, pixel_angle: float) -> float:
        """The level whose texels are as large as a pixel."""
        return math.log2(max(pixel_angle * self._height / math.pi, 1.0))

    def release(self) -> None:
        self._map.release()


def rotation_about_y(angle: float) -> np.ndarray:
    """World directions to those of an environment rotated by `angle`, (3, 3): to_environment() in GLSL."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
