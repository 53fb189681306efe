"""Light that fibres scatter to each other, on the GPU: 3D textures over the box of all curves."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from ..bake.fibre_grid import fibre_grid
from ..bake.hair_light import HairMedium
from ..plan.curves import has_colors
from ..plan.model import Plan
from ..scene.curves import Curves
from ..scene.fibre import Fibre, gives_color, hair_fibre, sigma_a_of_color
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..scene.yarn.spun import dense_curves, yarn_kind
from ..settings import Settings
from .environment import EnvironmentLight

UNIT_HAIR = 3
_MOST = 6e4
"""A half float holds a little more."""


def medium_key(scene: Scene, settings: Settings) -> tuple[object, ...]:
    """All that the medium depends on. It is worked out for each frame, and so without a look at the curves' points."""
    yarn = yarn_kind(settings) if settings.yarn != "off" else None
    return scene.curves, yarn, hair_fibre(settings), gives_color(settings)


def hair_medium(scene: Scene, settings: Settings) -> HairMedium:
    """The medium that the scene's curves are."""
    are_yarns = settings.yarn != "off"
    grid = fibre_grid(dense_curves(scene, settings), are_yarns)
    return HairMedium(grid, mean_fibre(scene, settings), are_yarns)


def light_key(plan: Plan, environment: EnvironmentLight | None) -> tuple[object, ...]:
    """All else that the light depends on. Environments are compared by identity."""
    sky = environment and (environment, environment.environment.rotation, environment.environment.intensity)
    return plan.lights, sky


class HairLight:
    def __init__(self, gl: moderngl.Context, hair: HairMedium, plan: Plan,
                 environment: EnvironmentLight | None) -> None:
        self.medium, self.key = hair, light_key(plan, environment)
        light = hair.lit(plan.lights, environment.sky_lights(plan) if environment is not None else None)
        self._kept, self._spread = tuple(hair.medium.kept.tolist()), hair.medium.spread
        self._low, self._sides = hair.grid.low, hair.grid.cell * np.array(hair.grid.shape[::-1])
        scattered = np.concatenate([np.minimum(light.scattered, _MOST), hair.grid.filled_by_others[..., None]], axis=-1)
        across = np.concatenate([light.across, hair.open[..., 4:]], axis=-1)
        # The depths to all lights lie one above the other along z.
        depths = np.concatenate(light.depths)[..., None] if light.depths else np.zeros((1, 1, 1, 1))
        self._textures = [_texture(gl, values) for values in (
            scattered, light.inclined, across, hair.open[..., :4], np.minimum(depths, _MOST))]

    def bind(self, frame: Frame) -> dict[str, object]:
        """The uniforms of shaders/raster/curve_light.glsl; binds the textures."""
        units = {}
        for k, name in enumerate(("scattered", "inclined", "across", "open", "depths")):
            self._textures[k].use(UNIT_HAIR + k)
            units[f"u_hair_{name}"] = UNIT_HAIR + k
        return units | {"u_hair_kept": self._kept, "u_hair_spread": self._spread,
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
