"""Light inside media on coarse grids about them, which do not depend on the camera.

For each cell, a pass finds the light that arrives there without a collision: from lights, past the meshes in the way,
and from directions sampled from the environment (shaders/raster/media_bake.frag). From it a diffusion equation gives
the light that is scattered many times (viewer/bake/diffusion.py). A grid of volumes also has their optical depth
towards each light.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import moderngl
import numpy as np

from ..bake.diffusion import scattered_light
from ..bake.many_lights import ManyLights, uniform_lights
from ..gpu.programs import Programs, matrix_uniform
from ..plan.media import SKY_LIGHTS, MediaPlan
from ..plan.model import Program
from ..scene.medium import Medium
from ..scene.phase import mean_cosine
from .computed import compute
from .lit_patches import lit_patches
from .shadows import ShadowMaps
from .units import UNIT_VOLUME_DEPTH

SIDE, DEPTH_SIDE = 32, 48
_POINTS = 4096
"""On a sphere, by which parts of it are measured."""


@dataclass(frozen=True)
class Grid:
    """A cube with a medium in it: its lowest corner and its length in the space of the uniforms that place the rest."""

    corner: tuple[float, float, float]
    length: float
    medium: Medium

    @property
    def uniform(self) -> tuple[float, ...]:
        return *self.corner, 1 / self.length


class MediaLight:
    """`texture` has three parts along z for each grid: scattered radiance, and the opacity of the media as
    a + b . direction, before the light of the environment and all around. With meshes, one or two more parts follow for
    each grid, and for that about the meshes: the mean radiance of what they reflect of lights, with what they leave of
    the scattered radiance; and where they stand before the environment, the opacity of both before its light. The last
    part is the mean radiance of what volumes emit themselves, where they scatter it. `depths` has a part for every four
    lights, and is None without volumes or lights."""

    def __init__(self, gl: moderngl.Context, parts: int, lights: int) -> None:
        self._gl = gl
        self.texture = _cubes(gl, SIDE, parts)
        self._middle = np.zeros((3, 4))
        self.depths = _cubes(gl, DEPTH_SIDE, -(-lights // 4)) if lights else None

    def bake(self, programs: Programs, plan: MediaPlan, grids: Sequence[Grid], around_meshes: Sequence[Grid],
             sky: ManyLights | None, shadows: ShadowMaps | None, uniforms: dict[str, object]) -> None:
        """Fill the grids. `sky` is the environment's light in SKY_LIGHTS directions, None without one, and `shadows`
        has the maps of lights, None without any."""
        uniforms = uniforms | _sky_uniforms(sky)
        if self.depths is not None:
            steps = self.depths.size[2] // DEPTH_SIDE
            parts = [self._draw(programs, plan.depth, 1, DEPTH_SIDE, uniforms | {"u_first": 4 * k}, grids[-1])[0]
                     for k in range(steps)]
            self.depths.write(np.stack(parts))
            self.depths.use(UNIT_VOLUME_DEPTH)
        off_meshes = self._off_meshes(programs, plan, [*grids, *around_meshes], shadows, uniforms)
        outputs, layers, past_meshes = 7 + plan.has_sky_shadows, [], []
        for grid, reflected in zip(grids, off_meshes):
            is_fog = plan.has_fog and grid is grids[0]
            uniforms["u_light_count"] = plan.bake["LIGHT_COUNT"] - plan.bake["VOLUME_LIGHTS"] * (not is_fog)
            unscattered, hidden, opacity, extinction, *flux = self._draw(
                programs, plan.bake, outputs, SIDE, uniforms, grid)
            past_meshes += _past_meshes(plan, reflected[0], extinction, flux[3:])
            scattered = np.zeros((SIDE, SIDE, SIDE, 4), np.float32)
            if plan.scatters_again:
                arriving, along = unscattered, np.stack(flux[:3])
                if is_fog or not plan.has_fog:  # in the grid of volumes, the fog beside it would count for too much
                    arriving, along = arriving + reflected[0], along + reflected[1:]
                light = scattered_light(
                    extinction[..., 0], _finite(arriving), _finite(along), opacity[..., 0], grid.length / SIDE,
                    grid.medium.albedo, mean_cosine(grid.medium))
                scattered[..., :3] = light.fluence / (4 * np.pi)
                opacity = opacity.copy()
                opacity[..., 1:] += opacity[..., :1] * light.origin
            layers += [scattered, hidden, opacity]
        for grid, reflected in zip(around_meshes, off_meshes[len(grids):]):
            extinction = hidden = np.ones((SIDE, SIDE, SIDE, 4), np.float32)
            if plan.has_sky_shadows:
                _, _, _, extinction, _, _, _, hidden = self._draw(programs, plan.bake, outputs, SIDE, uniforms, grid)
            past_meshes += _past_meshes(plan, reflected[0], extinction, [hidden])
        if plan.glow is not None:
            past_meshes.append(_glow(self._draw(programs, plan.glow, outputs, SIDE, uniforms, grids[-1]), grids[-1],
                                     uniforms["u_volume_emission"]))
        self.texture.write(np.stack([*layers, *past_meshes]))
        middle = slice(SIDE // 2 - 1, SIDE // 2 + 1)
        self._middle = np.stack(layers[:3])[:, middle, middle, middle].mean(axis=(1, 2, 3), dtype=np.float64)

    def arriving(self, sky: ManyLights) -> ManyLights:
        """The environment's light `sky` as it arrives in the middle of the first grid, with what media scatter there
        from the directions around each light."""
        scattered, hidden, opacity = self._middle
        basis = np.concatenate([np.ones((len(sky.directions), 1)), sky.directions], axis=1)
        transmittance = 1 - np.clip(basis @ hidden, 0, 1)
        from_there = np.maximum(basis @ opacity, 0) / max(opacity[0], 1e-20) * sky.solid_angles
        return replace(sky, irradiance=sky.irradiance * transmittance[:, None] + from_there[:, None] * scattered[:3])

    def _off_meshes(self, programs: Programs, plan: MediaPlan, grids: Sequence[Grid], shadows: ShadowMaps | None,
                    uniforms: dict[str, object]) -> list[np.ndarray]:
        """Light that meshes reflect, (4, SIDE, SIDE, SIDE, 4) for each grid: fluence, and flux along x, y and z. It
        changes slowly with the place, so it is found at every second cell along each axis."""
        if plan.lit is None or plan.off_meshes is None or shadows is None or not any(uniforms["u_reflectance"]):
            return [np.zeros((4, SIDE, SIDE, SIDE, 4), np.float32)] * len(grids)
        with lit_patches(self._gl, programs, plan.lit, shadows, uniforms) as lit:
            drawn = [np.stack(self._draw(programs, plan.off_meshes, 4, SIDE // 2, lit, grid)) for grid in grids]
        return [_between_cells(_finite(light)) for light in drawn]

    def _draw(self, programs: Programs, planned: Program, outputs: int, side: int, uniforms: dict[str, object],
              grid: Grid) -> list[np.ndarray]:
        """The outputs of a pass over the cells of a grid, each (side, side, side, 4) float32."""
        arrays = compute(self._gl, programs, planned, (side, side * side), outputs,
                         uniforms | {"u_side": side, "u_grid": grid.uniform})
        return [array.reshape(side, side, side, 4) for array in arrays]

    def release(self) -> None:
        for texture in (self.texture, self.depths):
            if texture is not None:
                texture.release()


def _past_meshes(plan: MediaPlan, reflected: np.ndarray, extinction: np.ndarray,
                 hidden: Sequence[np.ndarray]) -> list[np.ndarray]:
    """The parts of a grid that shaders/raster/past_meshes.glsl reads."""
    light = reflected / (4 * np.pi)
    light[..., 3] = extinction[..., 3] if plan.has_sky_shadows else 1.0
    return [light, *hidden][:plan.parts_past_meshes]


def _glow(drawn: Sequence[np.ndarray], grid: Grid, emission: Sequence[float]) -> np.ndarray:
    """The mean radiance over all directions of light that a medium emits itself, with what it scatters of it: (SIDE,
    SIDE, SIDE, 4). What emits the radiance e for each optical depth sends e (1 - exp(-depth)) from a direction: e times
    its opacity, a + b . d. So its fluence is 4 pi a e, and its flux -4/3 pi b e."""
    unscattered, _, opacity, extinction, *flux = drawn
    own, own_flux = unscattered.copy(), np.stack(flux[:3])
    own[..., :3] = 4 * np.pi * np.maximum(opacity[..., :1], 0) * np.float32(emission)
    for axis, part in enumerate(own_flux):
        part[..., :3] = -4 / 3 * np.pi * opacity[..., 1 + axis, None] * np.float32(emission)
    light = scattered_light(extinction[..., 0], _finite(own), _finite(own_flux), opacity[..., 0], grid.length / SIDE,
                            grid.medium.albedo, mean_cosine(grid.medium))
    result = np.zeros((SIDE, SIDE, SIDE, 4), np.float32)
    result[..., :3] = (light.fluence + own[..., :3]) / (4 * np.pi)
    return result


def _between_cells(light: np.ndarray) -> np.ndarray:
    """Light (..., n, n, n, 4) at the cells of a grid that is twice as fine, (..., 2 n, 2 n, 2 n, 4), linearly."""
    for axis in (-4, -3, -2):
        cells = np.moveaxis(light, axis, 0)
        before, after = np.concatenate([cells[:1], cells[:-1]]), np.concatenate([cells[1:], cells[-1:]])
        finer = np.stack([0.75 * cells + 0.25 * before, 0.75 * cells + 0.25 * after], axis=1)
        light = np.moveaxis(finer.reshape(-1, *cells.shape[1:]), 0, axis)
    return light


def _finite(light: np.ndarray) -> np.ndarray:
    return np.clip(np.nan_to_num(light, nan=0.0), -1e36, 1e36)  # a lamp has up to 1e30, and more close to it


def _cubes(gl: moderngl.Context, side: int, count: int) -> moderngl.Texture3D:
    texture = gl.texture3d((side, side, count * side), 4, dtype="f4")
    texture.filter = moderngl.LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = texture.repeat_z = False
    return texture


def _sky_uniforms(sky: ManyLights | None) -> dict[str, object]:
    """Directions with their irradiance, their shares of the environment's light and of the sphere, and what fits
    a + b . direction to values at them by least squares with these weights."""
    lights = sky if sky is not None else uniform_lights(SKY_LIGHTS, (1.0, 1.0, 1.0))
    shares = lights.irradiance.sum(axis=1)
    shares = shares / max(shares.sum(), 1e-300) + 1e-3 / SKY_LIGHTS
    shares /= shares.sum()
    solid_angles = _nearest_shares(lights.directions)
    irradiance = np.clip(lights.irradiance, 0, 1e30) * (sky is not None)
    return {"u_sky_directions": np.float32(np.concatenate([lights.directions, shares[:, None]], axis=1)).tobytes(),
            "u_sky_irradiance": np.float32(np.concatenate([irradiance, solid_angles[:, None]], axis=1)).tobytes(),
            "u_light_fit": _fit(lights.directions, shares), "u_sphere_fit": _fit(lights.directions, solid_angles)}


def _nearest_shares(directions: np.ndarray) -> np.ndarray:
    """The share (N,) of the sphere to which each of these (N, 3) directions is the nearest."""
    points = uniform_lights(_POINTS, (1.0, 1.0, 1.0)).directions
    return np.bincount((points @ directions.T).argmax(axis=1), minlength=len(directions)) / _POINTS


def _fit(directions: np.ndarray, weights: np.ndarray) -> tuple[float, ...]:
    basis = np.concatenate([np.ones((len(directions), 1)), directions], axis=1)
    return matrix_uniform(np.linalg.inv((basis * weights[:, None]).T @ basis))
