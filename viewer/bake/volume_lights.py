"""Point lights for the light that volumes emit: what a fire sends onto the surfaces around it.

Photons start where volumes emit and walk until they leave them (delta tracking, Woodcock et al. 1965), so that what
smoke absorbs of the light, and what it spreads, is counted. The place where one set out for the last time is a little
light (instant radiosity, Keller 1997). Those of a part of the volume are added up to one in its middle, and the parts
are what is nearest to one of these (Lloyd 1982, "Least Squares Quantization in PCM").
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..scene.light import Light
from ..scene.medium import Medium
from ..scene.phase import mean_cosine
from ..scene.volume import Volume

COUNT = 8
"""Lights. Four are as near to the truth, but their shadows overlap in steps."""
_PHOTONS = 8192
_MOST_STEPS = 256
"""Of a walk, collisions and others. What is still inside then counts as if it left there."""
_LEAST_WEIGHT = 1e-3
_ROUNDS = 6
"""How often the lights move."""


def volume_lights(volumes: Sequence[Volume], medium: Medium, count: int = COUNT) -> tuple[Light, ...]:
    """At most `count` point lights, as bright together as the light that leaves `volumes`, in which `medium` is met
    where the density is 1."""
    if not any(medium.emission):
        return ()
    rng = np.random.default_rng(0)
    powers = np.array([volume.density.sum(dtype=np.float64) * abs(np.linalg.det(volume.index_to_world[:3, :3]))
                       for volume in volumes])
    if not powers.any():
        return ()
    shares = np.round(_PHOTONS * powers / powers.sum()).astype(int)
    points = np.concatenate([_where_it_emits(volume, share, rng)
                             for volume, share in zip(volumes, shares, strict=True)])
    places, weights = _walk(points, volumes, medium, rng)
    # emitted radiance per length, in all directions
    weights *= 4 * math.pi * powers.sum() / len(points) * np.array(medium.emission)
    return tuple(_gathered(places, weights, count, rng))


def _where_it_emits(volume: Volume, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points (count, 3) in world space, distributed like the density: first over the rows, then within a row."""
    nz, ny, nx = volume.density.shape
    rows = volume.density.reshape(nz * ny, nx)
    sums = np.cumsum(rows.sum(axis=1, dtype=np.float64))
    if not count or sums[-1] <= 0:
        return np.empty((0, 3))
    wanted = (np.arange(count) + rng.random()) / count * sums[-1]
    row = np.searchsorted(sums, wanted, side="right").clip(0, len(rows) - 1)
    along = np.cumsum(rows[row], axis=1, dtype=np.float64)
    x = (along <= rng.random((count, 1)) * along[:, -1:]).sum(axis=1).clip(0, nx - 1)
    indices = np.stack([x, row % ny, row // ny], axis=1) + rng.random((count, 3)) - 0.5
    points: np.ndarray = indices @ volume.index_to_world[:3, :3].T + volume.index_to_world[:3, 3]
    return points


def _walk(points: np.ndarray, volumes: Sequence[Volume], medium: Medium,
          rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Where each of the photons set out for the last time (N, 3), and what of it has come out (N, 3)."""
    # what goes nearly straight on counts as not scattered (similarity): the rest goes on anywhere
    g = max(mean_cosine(medium), 0.0)
    kept = 1 - max(medium.albedo) * g
    extinction, albedo = kept * medium.sigma_t[0], (1 - g) / kept * np.array(medium.albedo)
    majorant = extinction * sum(volume.maximum for volume in volumes)
    corners = np.concatenate([volume.corners for volume in volumes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    places, at, directions = points.copy(), points.copy(), _directions(len(points), rng)
    weights, walking = np.ones((len(points), 3)), np.arange(len(points))
    for _ in range(_MOST_STEPS):
        if not len(walking) or majorant <= 0:
            break
        at[walking] += rng.exponential(1 / majorant, len(walking))[:, None] * directions[walking]
        walking = walking[((at[walking] >= low) & (at[walking] <= high)).all(axis=1)]
        here = np.sum([_density(volume, at[walking]) for volume in volumes], axis=0)
        hit = walking[rng.random(len(walking)) * majorant < extinction * here]
        weights[hit] *= albedo
        places[hit] = at[hit]
        directions[hit] = _directions(len(hit), rng)
        weights[weights.max(axis=1) < _LEAST_WEIGHT] = 0
        walking = walking[weights[walking].any(axis=1)]
    return places, weights


def _directions(count: int, rng: np.random.Generator) -> np.ndarray:
    """Unit vectors (count, 3), anywhere on the sphere."""
    vectors = rng.normal(size=(count, 3))
    directions: np.ndarray = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return directions


def _density(volume: Volume, points: np.ndarray) -> np.ndarray:
    """That of the voxels in which the points (N, 3) lie, 0 outside."""
    to_index = np.linalg.inv(volume.index_to_world)
    index = np.round(points @ to_index[:3, :3].T + to_index[:3, 3]).astype(int)
    shape = np.array(volume.density.shape[::-1])
    inside = np.all((index >= 0) & (index < shape), axis=1)
    x, y, z = (index * inside.reshape(-1, 1)).T
    return np.where(inside, volume.density[z, y, x], 0).astype(np.float64)


def _gathered(places: np.ndarray, weights: np.ndarray, count: int, rng: np.random.Generator) -> list[Light]:
    """Lights in the middle of the parts of `places` (N, 3) that are nearest to each, with the `weights` (N, 3)."""
    power = weights.max(axis=1)
    places, weights, power = places[power > 0], weights[power > 0], power[power > 0]
    if not len(power):
        return []
    middles = places[:1]
    squares = ((places - middles[0]) ** 2).sum(axis=1)
    while len(middles) < min(count, len(places)):  # each begins far from those before
        middles = np.concatenate([middles, places[[np.argmax(squares * power)]]])
        squares = np.minimum(squares, ((places - middles[-1]) ** 2).sum(axis=1))
    for _ in range(_ROUNDS):
        nearest = ((places[:, None] - middles) ** 2).sum(axis=2).argmin(axis=1)
        sums = np.bincount(nearest, power, len(middles))
        moved = np.stack([np.bincount(nearest, power * axis, len(middles)) for axis in places.T], axis=1)
        middles = np.where(sums[:, None] > 0, moved / np.maximum(sums, 1e-300)[:, None], middles)
    lights = []
    for k, middle in enumerate(middles):
        own = np.flatnonzero(nearest == k)
        candela = weights[own].sum(axis=0) / (4 * math.pi)
        if not candela.any():
            continue
        spread = np.average(((places[own] - middle) ** 2).sum(axis=1), weights=power[own])
        # a ball's points have the mean square 3/5 r^2 from its middle
        lights.append(Light("point", tuple(candela / candela.max()), float(candela.max()), tuple(middle),
                            radius=math.sqrt(spread * 5 / 3), name="emission of volumes"))
    return lights
