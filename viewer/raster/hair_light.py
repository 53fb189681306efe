"""Light that fibres scatter to each other, on the GPU: two 3D textures over the box of all curves."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from ..bake.hair_light import fibre_grid, hair_light
from ..plan.curves import has_colors
from ..plan.model import Plan
from ..scene.curves import Curves
from ..scene.fibre import Fibre, hair_fibre, sigma_a_of_color
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..scene.yarn.spun import dense_curves, yarn_kind
from ..settings import Settings
from .environment import EnvironmentLight

UNIT_SCATTERED, UNIT_HIDDEN, UNIT_DEPTHS = 3, 4, 5
_MOST = 6e4
"""A half float holds a little more."""


def light_key(scene: Scene, settings: Settings, plan: Plan, environment: EnvironmentLight | None) -> tuple[object, ...]:
    """All that the light depends on."""
    sky = environment and (environment.environment.source, environment.environment.rotation,
                           environment.environment.intensity)
    yarn = yarn_kind(settings) if settings.yarn != "off" else None
    return scene.curves, yarn, mean_fibre(scene, settings), plan.lights, sky


class HairLight:
    def __init__(self, gl: moderngl.Context, scene: Scene, settings: Settings, plan: Plan,
                 environment: EnvironmentLight | None) -> None:
        self.key = light_key(scene, settings, plan, environment)
        grid = fibre_grid(dense_curves(scene, settings))
        sky = environment.sky_lights(plan) if environment is not None else None
        light = hair_light(grid, mean_fibre(scene, settings), plan.lights, sky)
        padded = np.concatenate([light.scattered, np.zeros((*light.hidden.shape[:3], 1))], axis=3)
        self._onward = light.onward
        self._low, self._sides = grid.low, grid.cell * np.array(grid.extinction.shape[::-1])
        # The depths to all lights lie one above the other along z.
        depths = np.concatenate(light.depths)[..., None] if light.depths else np.zeros((1, 1, 1, 1))
        self._textures = [_texture(gl, np.minimum(values, _MOST)) for values in (padded, light.hidden, depths)]

    def bind(self, frame: Frame) -> dict[str, object]:
        """The uniforms of shaders/raster/curve_light.glsl; binds the textures."""
        for texture, unit in zip(self._textures, (UNIT_SCATTERED, UNIT_HIDDEN, UNIT_DEPTHS), strict=True):
            texture.use(unit)
        return {"u_hair_scattered": UNIT_SCATTERED, "u_hair_hidden": UNIT_HIDDEN, "u_hair_depths": UNIT_DEPTHS,
                "u_hair_onward": self._onward,
                "u_hair_low": tuple(frame.position(self._low)), "u_hair_scale": tuple(frame.unit / self._sides)}

    def release(self) -> None:
        for texture in self._textures:
            texture.release()


def mean_fibre(scene: Scene, settings: Settings) -> Fibre:
    """The fibre that stands for all: that of the set of curves with the most points, in the mean of its colours."""
    curves: Curves = max(scene.curves, key=lambda curves: len(curves.points))
    fibre = curves.fibre or hair_fibre(settings)
    if curves.colors is None or not has_colors(curves, settings):
        return fibre
    red, green, blue = sigma_a_of_color(curves.colors, fibre.beta_n).mean(axis=0).tolist()
    return replace(fibre, sigma_a=(red, green, blue))


def _texture(gl: moderngl.Context, values: np.ndarray) -> moderngl.Texture3D:
    depth, height, width, channels = values.shape
    texture = gl.texture3d((width, height, depth), channels, np.ascontiguousarray(values, np.float16), dtype="f2")
    texture.filter = moderngl.LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = texture.repeat_z = False
    return texture
