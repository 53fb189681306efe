"""Shadow maps of the environment for light in media, one in each of the directions that stand for its light."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ..bake.many_lights import ManyLights
from ..plan.media import SKY_LIGHTS
from ..plan.model import Draw, Plan
from ..scene.color import LUMINANCE
from ..scene.material import Material
from ..scene.scene import Scene
from .shadows import Atlas, Casters, directional_tiles
from .units import UNIT_SKY_SHADOWS

_TILE = 256


class SkyShadows:
    """The maps of `sky`, whose directions are in world axes. `texture` is bound to the unit of `uniforms`, those of
    shaders/raster/media_bake.frag about the centre of the scene. Meshes in the way reflect `reflectance`, (3,)."""

    def __init__(self, gl: moderngl.Context, scene: Scene, plan: Plan, sky: ManyLights, casters: Casters,
                 reflectance: np.ndarray) -> None:
        self._atlas = Atlas(gl, SKY_LIGHTS, _TILE)
        tiles = directional_tiles(-sky.directions, scene, self._atlas.tile_size)
        self._atlas.draw(scene, tiles, [draw for draw in plan.draws if draw.hides_sky], casters)
        rows = np.stack([(tile.matrix[:3] + np.eye(4)[3]) / 2 for tile in tiles])
        self.texture = self._atlas.texture
        self.texture.compare_func = ""
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.uniforms: dict[str, object] = {
            "u_sky_atlas": UNIT_SKY_SHADOWS, "u_sky_shadows": np.float32(rows).tobytes(),
            "u_sky_tiles": self._atlas.tiles,
            "u_sky_reflected": np.float32(reflected(sky, reflectance)).tobytes()}

    def release(self) -> None:
        self._atlas.release()


@dataclass(frozen=True, eq=False)
class MeanSurface:
    """Of the instances of triangles, weighted by the surfaces of their boxes and by how much light they hide."""

    reflectance: np.ndarray
    """(3,)."""
    emission: np.ndarray
    """Radiance, (3,)."""
    width: float
    """The radius of a disc as large as the mean side of the boxes, in scene units."""


def mean_surface(scene: Scene, draws: Sequence[Draw], mean: Callable[[Draw, str], np.ndarray]) -> MeanSurface:
    """`mean` gives that of a map."""
    sizes = np.ptp(scene.corners, axis=1) / scene.radius
    areas = (sizes * np.roll(sizes, 1, axis=1)).sum(axis=1)
    parts = [areas[list(draw.instances)] if draw.instances else areas[[draw.instance]] for draw in draws]
    shares = np.array([_hidden_share(draw.surface) for draw in draws])
    weights = np.array([part.sum() for part in parts]) * shares
    sides = np.array([(part**2).sum() / 3 for part in parts]) * shares
    total = max(weights.sum(), 1e-300)
    reflectance, emission = (np.reshape([_mean_color(draw, name, mean) for draw in draws], (-1, 3)).T @ weights / total
                             for name in ("base_color", "emissive"))
    return MeanSurface(reflectance, emission, math.sqrt(sides.sum() / total / math.pi))


def _mean_color(draw: Draw, name: str, mean: Callable[[Draw, str], np.ndarray]) -> np.ndarray:
    color = np.array(getattr(draw.surface, name)[:3], np.float64)
    texture = getattr(draw.surface, f"{name}_texture")
    return color * mean(draw, name)[:3] if texture is not None and name in draw.maps else color


def _hidden_share(material: Material) -> float:
    """Of the light that meets a surface, by its alpha but for textures."""
    if material.alpha_mode == "blend":
        return material.base_color[3]
    is_cut = material.alpha_mode == "mask" and material.base_color[3] < material.alpha_cutoff
    return float(not (material.is_seen_through or is_cut))


def reflected(sky: ManyLights, reflectance: np.ndarray) -> np.ndarray:
    """The irradiance (N, 3) that takes the place of each light's where a mesh stands before it, and its luminance as a
    share of that of all lights, (N, 1).

    The mesh is taken to face the point, and to get the mean radiance of the half of the sky before it, by the cosine:
    in a white furnace, a white mesh changes nothing. The media about it are taken to be those before the sky.
    """
    facing = np.maximum(-sky.directions @ sky.directions.T, 0)
    light = np.clip(sky.irradiance, 0, 1e30)
    radiance = reflectance * (facing @ light) / np.maximum(facing @ sky.solid_angles, 1e-30)[:, None]
    instead = radiance * sky.solid_angles[:, None]
    return np.concatenate([instead, instead @ LUMINANCE[:, None] / max((light @ LUMINANCE).sum(), 1e-300)], axis=1)
