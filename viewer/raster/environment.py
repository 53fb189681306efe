"""The environment on the GPU: what surfaces reflect, and what stands behind them."""

from __future__ import annotations

import math
from dataclasses import replace

import moderngl
import numpy as np

from ..bake.dominant import ambient_and_key
from ..bake.environment import bake_environment
from ..plan import Plan
from ..scene.environment import Environment
from ..scene.light import Light
from ..settings import Settings
from .display import fullscreen
from .frame import Frame, uniform
from .programs import Programs, set_uniform
from .floats import float_texture
from .surfaces import UNIT_BACKGROUND, UNIT_IRRADIANCE, UNIT_PREFILTERED


class EnvironmentLight:
    """Textures and uniforms of one environment, each made when a plan first asks for it.

    `environment` may be replaced by one that differs in rotation and intensity only.
    """

    def __init__(self, gl: moderngl.Context, environment: Environment, settings: Settings, use_cache: bool) -> None:
        self._gl, self.environment = gl, environment
        self._ndf = settings.ndf
        self._baked = bake_environment(environment, ndf=settings.ndf, cache=use_cache)
        self._prefiltered: moderngl.Texture | None = None
        self._irradiance: moderngl.Texture | None = None
        self._background: moderngl.Texture | None = None

    def holds(self, environment: Environment, settings: Settings) -> bool:
        """Whether this is that environment, turned and scaled at most."""
        return self.environment.source is environment.source and self._ndf == settings.ndf

    def lights(self, settings: Settings) -> list[Light]:
        """The environment's suns; in Phong mode, which reflects no environment, also its dominant direction."""
        turn = rotation_about_y(self.environment.rotation).T
        lights = list(self._baked.suns)
        if settings.mode == "phong":
            key = ambient_and_key(self._baked.irradiance)[1]
            lights.append(replace(key, intensity=key.intensity * self._baked.scale))
        return [
            replace(light, direction=tuple(turn @ light.direction), intensity=light.intensity * self.environment.intensity)
            for light in lights
        ]

    def uniforms(self, plan: Plan) -> dict[str, object]:
        """What surfaces need; binds the textures."""
        values: dict[str, object] = {}
        if plan.ambient:
            ambient = ambient_and_key(self._baked.irradiance)[0] * self._baked.scale * self.environment.intensity
            values["u_ambient"] = tuple(ambient.tolist())
        if plan.environment:
            angle = self.environment.rotation
            values["u_environment_intensity"] = self.environment.intensity * self._baked.scale
            values["u_environment_rotation"] = (math.cos(angle), math.sin(angle))
            if self._irradiance is None:
                self._irradiance = float_texture(self._gl, self._baked.irradiance)
                self._irradiance.repeat_x = True
            self._irradiance.use(UNIT_IRRADIANCE)
            values["u_irradiance"] = UNIT_IRRADIANCE
            if self._prefiltered is None:
                self._prefiltered = _mip_texture(self._gl, self._baked.levels)
            self._prefiltered.use(UNIT_PREFILTERED)
            values["u_prefiltered"] = UNIT_PREFILTERED
        return values

    def draw_background(self, programs: Programs, frame: Frame, half_target: bool) -> None:
        program = programs.get("display/fullscreen.vert", "raster/background.frag", {"HALF_TARGET": int(half_target)})
        if self._background is None:
            self._background = _background_texture(self._gl, self.environment.radiance)
        self._background.use(UNIT_BACKGROUND)
        texel_angle = math.pi / self._background.height
        set_uniform(program, "u_background", UNIT_BACKGROUND)
        set_uniform(program, "u_ray", uniform(rotation_about_y(self.environment.rotation) @ frame.ray))
        set_uniform(program, "u_lod", max(0.0, math.log2(max(frame.pixel_angle / texel_angle, 1e-6))))
        set_uniform(program, "u_environment_intensity", self.environment.intensity)
        self._gl.enable_only(moderngl.DEPTH_TEST)
        self._gl.depth_func = "<="
        fullscreen(self._gl, program).render(vertices=3)
        self._gl.depth_func = "<"

    def release(self) -> None:
        for texture in (self._prefiltered, self._irradiance, self._background):
            if texture is not None:
                texture.release()


def rotation_about_y(angle: float) -> np.ndarray:
    """World direction to the direction looked up in an environment turned by `angle`, (3, 3): to_environment() in GLSL."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def _background_texture(gl: moderngl.Context, radiance: np.ndarray) -> moderngl.Texture:
    """In half floats where nothing is lost by it: a sun above their range keeps its single ones."""
    dtype = np.float16 if radiance.max() < 65504 else np.float32
    texture = float_texture(gl, radiance.astype(dtype))
    texture.repeat_x = True
    texture.build_mipmaps()
    return texture


def _mip_texture(gl: moderngl.Context, levels: list[np.ndarray]) -> moderngl.Texture:
    """A texture whose mip levels are given, each half the size of the one before."""
    texture = float_texture(gl, levels[0])
    texture.build_mipmaps(max_level=len(levels) - 1)
    for level, pixels in enumerate(levels[1:], start=1):
        texture.write(np.ascontiguousarray(pixels), level=level, alignment=1)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.repeat_x = True
    return texture
