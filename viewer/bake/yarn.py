"""A table of the light that leaves a yarn's layer of fibres after it met one of them.

The rest of the light is diffuse. Since the share in the table is known exactly, so is the rest, and the same numbers
hold for the direction to the viewer and to the light.

The layer is that of shaders/bsdf/weave/woven.glsl. For fibres that mirror all light, the share of the light from w that
leaves after it is mirrored once is

    m(w) = integral f |cos| = the mean of Lo K(Lo, Li) over the flakes that are seen from w

and for white fibres that mirror nothing, a share n(w) leaves after it has entered one fibre (entered.py).

With the optical thickness and alpha of a yarn it depends on the fibres' rise over the cloth, on w's cosine, and on the
azimuth between both.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..scene.weave import Weave, Yarn
from .cache import key, load, store
from .entered import entered_share

SLICES, AZIMUTHS, COSINES = 12, 16, 24
"""Of the fibres' rise, of the azimuth, and of the cosine: as in shaders/bsdf/weave/mirrored.glsl."""
LEAST = 0.392
"""FLAKES_LEAST of shaders/bsdf/weave/flakes.glsl."""
MEAN = LEAST + (1 - LEAST) * 0.3905
"""Over the width of fibres that are met at a right angle."""
_POINTS = 128
_MIN_COSINE = 1e-4  # at which the values for 0 are taken


@lru_cache(maxsize=4)
def weave_table(weave: Weave) -> np.ndarray:
    """The table of both yarns, (2 SLICES AZIMUTHS + 1, COSINES, 4) float32.

    A block of AZIMUTHS rows is a slice: warp first, by the sine of the fibres' rise, from 0 to that of `max_rise`. In
    it, row j is the azimuth pi j / (AZIMUTHS - 1) and column i the cosine (i / (COSINES - 1))^2. The first two
    channels have m and n, the others those of the next slice, so that one lookup has both. Between its nodes, too, m
    is hardly ever less than it should be, so that no light is created. The last row has a texel for each slice: the
    greatest exp(-T Lambda) + m and exp(-T Lambda) + n, and their means over the hemisphere, weighted by the cosine.
    """
    yarns = [(max(yarn.roughness, 0.02), yarn.thickness, max_rise(yarn)) for yarn in (weave.warp, weave.weft)]
    cache_key = key("weave layer 8", yarns)
    cached = load(cache_key)
    if cached is None:
        cached = {"table": _table(yarns)}
        store(cache_key, cached)
    table = cached["table"]
    table.flags.writeable = False
    return table


def max_rise(yarn: Yarn) -> float:
    """The sine of the steepest fibre of a yarn over the cloth."""
    return math.sin(math.radians(min(yarn.bend + abs(yarn.seen_twist), 90.0)))


def _table(yarns: list[tuple[float, float, float]]) -> np.ndarray:
    shares, statistics = zip(*(_yarn(alpha, thickness, rise) for alpha, thickness, rise in yarns))
    table = np.zeros((2 * SLICES * AZIMUTHS + 1, COSINES, 4), np.float32)
    table[:-1, :, :2] = np.concatenate(shares).reshape(-1, COSINES, 2)
    table[:-1 - AZIMUTHS, :, 2:] = table[AZIMUTHS:-1, :, :2]
    table[-1] = np.concatenate(statistics)
    return table


@lru_cache(maxsize=1)
def _yarn(alpha: float, thickness: float, rise: float) -> tuple[NDArray, NDArray]:
    """m and n at the nodes, (SLICES, AZIMUTHS, COSINES, 2), and the statistics of the slices, (SLICES, 4)."""
    axes = [np.linspace(0, 1, 2 * n - 1) for n in (SLICES, AZIMUTHS, COSINES)]  # nodes, and the middles between them
    sine, azimuth, cosine = np.meshgrid(rise * axes[0], np.pi * axes[1], np.maximum(axes[2] ** 2, _MIN_COSINE),
                                        indexing="ij")
    mirrored, straight = mirrored_share(alpha, thickness, sine, azimuth, cosine)
    # n is smooth, but in the azimuth of directions along the fibres
    entered = _refined(entered_share(alpha, thickness, *(x[::2, :, ::2] for x in (sine, azimuth, cosine))), (0, 2))
    shares = [_raised(exact, 1 - straight) for exact in (mirrored, entered)]

    # Means of what shaders read: over the azimuth by the trapezoidal rule, over mu = t^2 with the weight 2 mu dmu.
    weight = np.full(2 * AZIMUTHS - 1, 1.0)
    weight[[0, -1]] = 0.5
    t = axes[2]
    simpson = np.where(np.arange(len(t)) % 2 == 1, 4.0, 2.0)
    simpson[[0, -1]] = 1.0
    both = np.outer(weight / weight.sum(), simpson * t**3)
    both /= both.sum()
    sums = [straight[::2] + _refined(share)[::2] for share in shares]
    return np.stack(shares, axis=-1), np.stack([*(one.max(axis=(1, 2)) for one in sums),
                                                *((one * both).sum(axis=(1, 2)) for one in sums)], axis=-1)


def _raised(exact: NDArray, most: NDArray) -> NDArray:
    """The values at the nodes, every second along all axes, of a table whose lines between them are hardly ever below
    the exact ones: a line cuts what bulges between two nodes, by which both are raised, up to `most`."""
    share = exact[::2, ::2, ::2].copy()
    missing = np.maximum(exact - _refined(share), 0)
    for axis in range(3):
        padded = np.pad(missing, [(1, 1) if k == axis else (0, 0) for k in range(3)])
        n = missing.shape[axis]
        missing = np.maximum.reduce([padded.take(range(k, k + n, 2), axis) for k in range(3)])
    return np.minimum(share + missing, most[::2, ::2, ::2])


def _refined(values: NDArray, axes: tuple[int, ...] = (0, 1, 2)) -> NDArray:
    """The values at the nodes and, by linear interpolation, in the middles between them, along these axes."""
    for axis in axes:
        values = np.moveaxis(values, axis, 0)
        fine = np.empty((2 * len(values) - 1, *values.shape[1:]))
        fine[::2], fine[1::2] = values, (values[1:] + values[:-1]) / 2
        values = np.moveaxis(fine, 0, axis)
    return values


def mirrored_share(alpha: float, thickness: float, sine: NDArray, azimuth: NDArray, cosine: NDArray,
                   points: int = _POINTS) -> tuple[NDArray, NDArray]:
    """m and exp(-T Lambda), of the sine of the fibres' rise, the azimuth between them and w, and the cosine of w.

    In the frame of the fibres, whose axis is x; the cloth's normal is (sine, 0, b). A flake that is seen from w is a
    point of a disk, stretched as the flakes are (Heitz et al. 2015).
    """
    b, s = np.sqrt(1 - sine**2), np.sqrt(1 - cosine**2)
    w = b * s * np.cos(azimuth) + sine * cosine, s * np.sin(azimuth), b * cosine - sine * s * np.cos(azimuth)
    n = alpha * w[0], w[1], w[2]
    area = np.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
    n = n[0] / area, n[1] / area, n[2] / area
    flat = np.sqrt(np.maximum(n[1] ** 2 + n[2] ** 2, 1e-30))  # t: across n and the axis; u: across both
    t, u = (n[2] / flat, -n[1] / flat), (-flat, n[0] * n[1] / flat, n[0] * n[2] / flat)
    lambda_o = area / cosine
    straight = np.exp(-np.minimum(thickness * lambda_o, 80.0))
    total = np.zeros_like(w[0])
    for x, y, z in _disk(points):
        h = alpha * (x * u[0] + z * n[0]), y * t[0] + x * u[1] + z * n[1], y * t[1] + x * u[2] + z * n[2]
        twice = 2 * (w[0] * h[0] + w[1] * h[1] + w[2] * h[2]) / (h[0] ** 2 + h[1] ** 2 + h[2] ** 2)
        i = twice * h[0] - w[0], twice * h[1] - w[1], twice * h[2] - w[2]
        up = sine * i[0] + b * i[2]
        lambda_i = np.sqrt((alpha * i[0]) ** 2 + i[1] ** 2 + i[2] ** 2) / np.maximum(np.abs(up), 1e-6)
        x_k = np.maximum(np.where(up > 0, np.maximum(lambda_o, lambda_i), np.abs(lambda_o - lambda_i)), 1e-20)
        k = np.where(thickness * x_k < 1e-8, thickness, -np.expm1(-np.minimum(thickness * x_k, 80.0)) / x_k)
        through = np.exp(-np.minimum(thickness * np.minimum(lambda_o, lambda_i), 80.0))
        turn = (w[1] * i[1] + w[2] * i[2]) / np.sqrt(np.maximum((w[1]**2 + w[2]**2) * (i[1]**2 + i[2]**2), 1e-24))
        fresnel = LEAST + (1 - LEAST) * np.sqrt(1 - np.sqrt(np.clip(0.5 + 0.5 * turn, 0, 1)))
        total += lambda_o * k * fresnel * np.where(up > 0, 1.0, through)
    return np.minimum(total / points, 1 - straight), straight


def _disk(points: int) -> list[tuple[float, float, float]]:
    """Points of the unit disk, evenly spread, and their heights under the hemisphere: a Fibonacci spiral."""
    k = np.arange(points)
    r2, angle = (k + 0.5) / points, k * math.pi * (3 - math.sqrt(5))
    r = np.sqrt(r2)
    return list(zip((r * np.cos(angle)).tolist(), (r * np.sin(angle)).tolist(), np.sqrt(1 - r2).tolist()))
