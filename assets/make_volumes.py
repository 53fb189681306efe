"""Makes `volumes/*.vdb`, a small cloud and a small smoke: python assets/make_volumes.py"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from vdb import VdbGrid, vdb_bytes

Field = Callable[[np.ndarray], np.ndarray]
STEPS = 64
"""Densities are rounded to a 64th, which halves the file."""


def noise(seed: int) -> Field:
    """Value noise in [-1, 1] of points (..., 3), smooth between random values at whole coordinates."""
    table = np.random.default_rng(seed).uniform(-1, 1, (32, 32, 32)).astype(np.float32)

    def at(points: np.ndarray) -> np.ndarray:
        cell = np.floor(points).astype(int)
        t = (points - cell).astype(np.float32)
        t = t * t * t * (t * (6 * t - 15) + 10)
        total = np.zeros(points.shape[:-1], np.float32)
        for corner in np.ndindex(2, 2, 2):
            weight = np.where(corner, t, 1 - t).prod(axis=-1)
            total += weight * table[tuple(((cell + corner) % 32)[..., k] for k in range(3))]
        return total

    return at


def octaves(points: np.ndarray, seed: int, count: int, gain: float = 0.5) -> np.ndarray:
    """Noise of `count` frequencies, each twice that of the one before."""
    fields = [noise(seed + k) for k in range(count)]
    return sum((gain**k * field(points * 2.0**k) for k, field in enumerate(fields)), np.zeros(points.shape[:-1]))


def ramp(values: np.ndarray, low: float, high: float) -> np.ndarray:
    t = np.clip((values - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def grid_points(shape: tuple[int, int, int], low: tuple[float, ...], step: float) -> np.ndarray:
    return np.stack(np.meshgrid(*(a + step * np.arange(n) for a, n in zip(low, shape)), indexing="ij"), axis=-1)


def cloud() -> VdbGrid:
    """A cumulus of 32 metres: balls over a flat base, whose surface the noise billows."""
    shape, low, step = (108, 62, 84), (-16.2, -6.0, -12.6), 0.3
    points = grid_points(shape, low, step)
    balls = [((-8, -1, 1), 5.5), ((-2, 1.5, -1), 7.5), ((5, 0, 1), 6.5), ((10, -2, -2), 4), ((1, -1, 5), 5.5),
             ((-4, -1.5, -6), 4.5), ((2.5, 5, -0.5), 4.5)]
    depth = np.max([1 - np.linalg.norm(points - center, axis=-1) / radius for center, radius in balls], axis=0)
    billow = 0.55 - np.abs(octaves(points / 6.0, 1, 5, 0.55))
    density = ramp(depth + 0.4 * billow, 0.08, 0.45) * ramp(points[..., 1], -5.0, -3.0)
    return finished(density, low, step)


def smoke() -> VdbGrid:
    """A plume of 8 metres, which leans, widens and thins as it rises."""
    shape, low, step = (62, 112, 68), (-2.1, 0.0, -3.0), 0.075
    points = grid_points(shape, low, step)
    height = points[..., 1]
    turbulent = np.stack([octaves(points * (0.9, 0.6, 0.9), seed, 4) for seed in (11, 21)], axis=-1)
    middle = np.stack([0.05 * height**1.5 + 0.35 * np.sin(0.9 * height), 0.3 * np.sin(0.7 * height + 1)], axis=-1)
    away = points[..., [0, 2]] - middle + turbulent * (0.12 + 0.1 * height)[..., None]
    width = 0.28 + 0.16 * height
    density = np.exp(-2 * (away**2).sum(axis=-1) / width**2) * (0.75 + 0.5 * octaves(points * 1.7, 31, 4))
    density = np.clip(density, 0, 1) * ramp(height, 0, 0.4) * ramp(-height, -8, -5)
    return finished(ramp(density, 0.04, 1.0), low, step)


def finished(density: np.ndarray, low: tuple[float, float, float], step: float) -> VdbGrid:
    matrix = np.diag([step, step, step, 1.0])
    matrix[:3, 3] = low
    return VdbGrid("density", (np.round(STEPS * density) / STEPS).astype(np.float32), index_to_world=matrix, half=True)


if __name__ == "__main__":
    folder = Path(__file__).parent / "volumes"
    folder.mkdir(exist_ok=True)
    for name, make in (("cloud", cloud), ("smoke", smoke)):
        (folder / f"{name}.vdb").write_bytes(vdb_bytes([make()]))
