"""Light that fibres scatter to each other, by diffusion on a grid of their density.

Many thin fibres are a medium. A fibre of radius r and length l in a volume V adds 2 r l <sin> / V to its extinction,
where <sin> = pi / 4 is the mean sine of the angle between a fibre and light from all around. The albedo and the mean
cosine of its phase function are those of the fibre's BCSDF (viewer/bake/fibre.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..scene.curve_segments import segments
from ..scene.curves import Curves
from ..scene.fibre import Fibre
from ..scene.light import Light
from .diffusion import scattered_light
from .fibre import ABSORPTIONS, ANGLES, COSINES, HALF_ABSORPTION, fibre_table
from .many_lights import ManyLights, uniform_lights

CELLS = 1 << 15
"""About so many cells, as cubes, in the box about all curves."""
_DIRECTIONS = 32


@dataclass(frozen=True, eq=False)
class FibreGrid:
    """Extinction (nz, ny, nx) per unit of length, in cells of side `cell` from the corner `low` (x, y, z) on."""

    low: np.ndarray
    cell: float
    extinction: np.ndarray

    @property
    def centers(self) -> np.ndarray:
        """(cells, 3), x fastest."""
        z, y, x = np.indices(self.extinction.shape).reshape(3, -1)
        return self.low + self.cell * (np.stack([x, y, z], axis=1) + 0.5)

    def depth(self, direction: np.ndarray) -> np.ndarray:
        """The optical depth from the centre of each cell along `direction` (x, y, z), (nz, ny, nx).

        It is carried from slice to slice along the axis that the direction follows most, and interpolated within them.
        """
        along = np.asarray(direction, np.float64)[::-1]  # z, y, x
        axis = int(np.abs(along).argmax())
        slices = np.moveaxis(self.extinction, axis, 0)
        slices = slices[::-1] if along[axis] > 0 else slices  # the first is the last that the ray passes
        halves = slices * (self.cell / abs(along[axis]) / 2)
        slopes = np.delete(along, axis) / abs(along[axis])
        out = np.empty_like(halves)
        behind = np.zeros(halves.shape[1:])
        for k, half in enumerate(halves):
            out[k] = _moved(behind, slopes) + half
            behind = out[k] + half
        return np.moveaxis(out[::-1] if along[axis] > 0 else out, 0, axis)

    def depth_to(self, point: np.ndarray) -> np.ndarray:
        """The optical depth from the centre of each cell to a point, (nz, ny, nx), by steps of a cell."""
        shape = np.array(self.extinction.shape[::-1])
        way = point - self.centers
        reach = np.maximum(np.linalg.norm(way, axis=1), 1e-30)
        steps = (way / reach[:, None]).astype(np.float32)
        padded = np.pad(self.extinction, 1)
        at = ((self.centers - self.low) / self.cell + 0.5 + 0.5 * steps).astype(np.float32)  # centres at whole numbers
        depth = np.zeros(len(at))
        for step in range(int(np.ceil(np.linalg.norm(shape)))):
            inside = np.clip(at, 0, shape + 0.999)
            low = inside.astype(np.int32)
            x, y, z = low.T
            a, b, c = (inside - low).T
            lines = [(1 - a) * padded[z + k, y + j, x] + a * padded[z + k, y + j, x + 1]
                     for k in (0, 1) for j in (0, 1)]
            here = (1 - c) * ((1 - b) * lines[0] + b * lines[1]) + c * ((1 - b) * lines[2] + b * lines[3])
            depth += here * ((step + 0.5) * self.cell < reach)
            at += steps
        return (depth * self.cell).reshape(self.extinction.shape)


def _moved(values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """`values` (n, m) at a place that lies by `slopes`, at most 1, farther along both axes; 0 beyond the edges."""
    padded = np.pad(values, 1)
    low = np.floor(slopes).astype(int)
    a, b = slopes - low
    n, m = values.shape
    parts = [[padded[1 + y:1 + y + n, 1 + x:1 + x + m] for x in (low[1], min(low[1] + 1, 1))]
             for y in (low[0], min(low[0] + 1, 1))]
    moved: np.ndarray = ((1 - a) * ((1 - b) * parts[0][0] + b * parts[0][1])
                         + a * ((1 - b) * parts[1][0] + b * parts[1][1]))
    return moved


@dataclass(frozen=True, eq=False)
class HairLight:
    """What reaches a fibre, on a grid.

    `scattered` (nz, ny, nx, 3) is the mean radiance of light that other fibres have scattered. `hidden` (nz, ny, nx, 4)
    says how much they hide in a direction d: a + b . d, with a in the first channel. `depths` has the optical depth
    (nz, ny, nx) to each light. All count what goes through fibres straight on as not scattered; `onward` is what that
    leaves of the extinction.
    """

    scattered: np.ndarray
    hidden: np.ndarray
    depths: list[np.ndarray]
    onward: float


def fibre_grid(all_curves: Sequence[Curves]) -> FibreGrid:
    """The density of all curves' fibres."""
    corners = np.concatenate([curves.corners for curves in all_curves])
    low, high = corners.min(axis=0), corners.max(axis=0)
    sides = np.maximum(high - low, 1e-3 * (high - low).max() + 1e-30)
    cell = float(np.cbrt(sides.prod() / CELLS))
    cell = max(cell, float(sides.max()) / 256)
    shape = np.ceil(sides / cell).astype(int) + 2
    low = (low + high) / 2 - shape * cell / 2
    total = np.zeros(shape.prod())
    for curves in all_curves:
        ends = segments(curves).ends.astype(np.float64)
        way = np.linalg.norm(ends[:, 1, :3] - ends[:, 0, :3], axis=1)
        count = np.clip(np.ceil(2 * way / cell), 1, 512).astype(np.int64)
        which = np.repeat(np.arange(len(way)), count)
        t = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[which]
        points = ends[which, 0] + t[:, None] * (ends[which, 1] - ends[which, 0])
        x, y, z = np.clip(((points[:, :3] - low) / cell).astype(np.int64), 0, shape - 1).T
        area = 2 * points[:, 3] * (way / count)[which]
        total += np.bincount((z * shape[1] + y) * shape[0] + x, area, len(total))
    return FibreGrid(low, cell, (total * (math.pi / 4) / cell**3).reshape(shape[::-1]))


def fibre_medium(fibre: Fibre) -> tuple[tuple[float, float, float], float]:
    """The albedo, RGB, and the mean cosine g of the fibre in light from all around.

    At the inclination theta light goes on at the angle with cosine sin^2 theta - cos^2 theta cos phi. Of all light,
    cos^2 theta d theta meets the fibre there.
    """
    table = fibre_table(fibre.beta_n, fibre.ior).sum(axis=3, dtype=np.float64) * (2 * math.pi / ANGLES)
    cosine = np.arange(COSINES) / (COSINES - 1)
    # cos^2 theta d theta = cos^2 theta d cos theta / sin theta: as differences of (theta + sin theta cos theta) / 2.
    edges = np.arccos(np.clip((np.arange(COSINES + 1) - 0.5) / (COSINES - 1), 0, 1))
    weights = -np.diff(edges + np.sin(edges) * np.cos(edges))
    weights /= weights.sum()
    phi = (np.arange(ANGLES) + 0.5) * math.pi / ANGLES
    turned = (1 - cosine[:, None]**2) - cosine[:, None]**2 * np.cos(phi)
    x = np.array(fibre.sigma_a) / (np.array(fibre.sigma_a) + HALF_ABSORPTION) * (ABSORPTIONS - 1)
    scattered = np.einsum("kji,j->k", table, weights)
    forward = np.einsum("kji,ji,j->k", table, turned, weights)
    albedo = [float(np.interp(v, np.arange(ABSORPTIONS), scattered)) for v in x]
    onward = [float(np.interp(v, np.arange(ABSORPTIONS), forward)) for v in x]
    red, green, blue = np.clip(albedo, 0, 1).tolist()
    return (red, green, blue), sum(onward) / max(sum(albedo), 1e-9)


def hair_light(grid: FibreGrid, fibre: Fibre, lights: Iterable[Light],
               sky: ManyLights | None) -> HairLight:
    """The light between fibres under `lights` and the environment, `sky`.

    The share f = g^2 of what is scattered counts as light that goes on as it came (delta-Eddington, Joseph and others
    1976), since most of it goes through fibres, almost straight on. What is left has the extinction
    sigma_t (1 - albedo f), the albedo albedo (1 - f) / (1 - albedo f) and the mean cosine g / (1 + g).
    """
    albedo, g = fibre_medium(fibre)
    f = g * g
    onward = 1 - f * sum(albedo) / 3
    red, green, blue = (min(a * (1 - f) / onward, 1.0) for a in albedo)
    grid = replace(grid, extinction=grid.extinction * onward)
    depths = []
    hidden = np.zeros((*grid.extinction.shape, 4))
    around = uniform_lights(_DIRECTIONS, np.ones(3)).directions
    light, flux = np.zeros_like(hidden), np.zeros((3, *hidden.shape))

    def add(arriving: np.ndarray, direction: np.ndarray) -> None:
        """Light (nz, ny, nx, channels) from `direction`, (3,) or (nz, ny, nx, 3)."""
        part = slice(0, 3) if arriving.shape[-1] == 3 else slice(3, 4)
        light[..., part] += arriving
        for axis in range(3):
            flux[axis][..., part] -= arriving * np.asarray(direction)[..., axis, None]

    for direction in around:
        opacity = -np.expm1(-grid.depth(direction))
        add((1 - opacity)[..., None] / len(around), direction)  # of the fluence 1 from all around
        hidden += opacity[..., None] * np.array([1.0, *(3 * direction)]) / len(around)
    if sky is not None:
        for direction, irradiance in zip(sky.directions, sky.irradiance, strict=True):
            add(np.exp(-grid.depth(direction))[..., None] * irradiance, direction)
    for source in lights:
        depth = grid.depth(-np.array(source.direction)) if source.kind == "directional" else grid.depth_to(
            np.array(source.position))
        depths.append(depth)
        arriving = _irradiance(source, grid.centers).reshape(depth.shape) * np.exp(-depth)
        towards = -np.array(source.direction) if source.kind == "directional" else (
            np.array(source.position) - grid.centers).reshape(*depth.shape, 3)
        add(arriving[..., None] * np.array(source.color),
            towards / np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-30))
    found = scattered_light(grid.extinction, light, flux, hidden[..., 0], grid.cell, (red, green, blue), g / (1 + g))
    return HairLight(found.fluence / (4 * math.pi), hidden, depths, onward)


def _irradiance(light: Light, points: np.ndarray) -> np.ndarray:
    """Of a light on a surface that faces it at each of `points`, before any fibre, (points,)."""
    if light.kind == "directional":
        return np.full(len(points), light.intensity)
    way = np.asarray(light.position) - points
    distance = np.maximum(np.linalg.norm(way, axis=1), 1e-30)
    irradiance = light.intensity / distance**2
    if light.range:
        irradiance *= np.clip(1 - (distance / light.range)**4, 0, 1)
    if light.kind == "spot":
        outer = math.cos(light.outer_cone)
        cosine = -(way @ np.asarray(light.direction)) / distance
        irradiance *= np.clip((cosine - outer) / max(1e-4, math.cos(light.inner_cone) - outer), 0, 1)**2
    return irradiance
