"""Checks of media: phase functions and distances between collisions lose no light and are sampled as they say.

The shaders compute them in float32; what they should give is known on paper.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...gpu.call import call_glsl
from .checks import Check
from .chi_squared import critical_value, statistic

G = (-0.99, -0.6, -1e-3, 0.0, 1e-6, 1e-3, 0.3, 0.6, 0.9, 0.99)
DIAMETERS = (5.0, 10.0, 20.0, 50.0)
"""Of droplets, in micrometres: the range of the fit."""
TAU = (0.0, 1e-6, 1e-4, 0.01, 1.0, 30.0, 1e4)
RATIOS = ((1.0, 1.0, 1.0), (1.0, 0.1, 1e-3), (0.0, 1.0, 1.0), (1e-3, 1e-3, 1.0))
"""Of the extinction of the channels to the largest."""
SAMPLES = 1 << 15
RINGS, TURNS = 32, 8
BALANCE_BOUND = 1e-5
_AXIS = np.array([0.48, 0.64, -0.6])


@dataclass(frozen=True)
class _Phase:
    """A phase function of the shaders: `g` of its sharpest lobe, its file, functions, and their first argument."""

    name: str
    g: float
    file: str
    eval: str
    sample: str
    first: dict[str, Any]

    @cached_property
    def rings(self) -> np.ndarray:
        """Edges in 1 - cos of the angle to the peak, (RINGS + 1,), dense there."""
        width = (1 - abs(self.g)) ** 2
        edges: np.ndarray = width * np.expm1(np.linspace(0, np.log1p(2 / width), RINGS + 1))
        return edges

    def shares(self) -> tuple[np.ndarray, np.ndarray]:
        """The integrals of the density over the rings, (RINGS,), and of the density times the cosine."""
        s, weight = np.polynomial.legendre.leggauss(16)
        low, high = self.rings[:-1, None], self.rings[1:, None]
        x = (low + high + (high - low) * s) / 2
        angle = 2 * np.arcsin(np.sqrt(np.minimum(x / 2, 1)))
        after = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
        before = np.array([-1.0 if self.g < 0 else 1.0, 0, 0])
        p = call_glsl(self.file, self.eval, before=before, after=after, **self.first).astype(np.float64)
        area = 2 * np.pi * weight * (high - low) / 2
        return (p * area).sum(axis=1), (p * area * (1 - x)).sum(axis=1)


def _phases() -> Iterator[_Phase]:
    for g in G:
        yield _Phase(f"Henyey-Greenstein, g {g:g}", g, "media/phase.glsl", "phase_between", "phase_sample", {"g": g})
    for d in DIAMETERS:
        m = {name: float(value) for name, value in call_glsl("media/droplets.glsl", "droplets", diameter=d).items()}
        yield _Phase(f"droplets of {d:g} micrometres", m["g"], "media/droplets.glsl", "droplets_between",
                     "droplets_sample", {"m": m})


def check_media() -> Iterator[Check]:
    """Rows for every phase function and for distances at optical depths from 0 to 1e4."""
    for phase in _phases():
        yield from _check_phase(phase)
    for ratios in RATIOS:
        yield from _check_distances(ratios)


def _check_phase(phase: _Phase) -> Iterator[Check]:
    shares, cosines = phase.shares()
    yield Check("phase integrates to 1", phase.name, abs(float(shares.sum()) - 1), BALANCE_BOUND)
    if "g" in phase.first:
        mean = float(cosines.sum()) * (-1 if phase.g < 0 else 1)
        yield Check("mean cosine is g", phase.name, abs(mean - phase.g), BALANCE_BOUND)
    u = np.random.default_rng(11).random((SAMPLES, 2), np.float32)
    drawn = call_glsl(phase.file, phase.sample, direction=_AXIS, u=u, **phase.first).astype(np.float64)
    axis = -_AXIS if phase.g < 0 else _AXIS
    # Not by the dot product, which loses the digits of small angles
    x = ((drawn / np.linalg.norm(drawn, axis=1, keepdims=True) - axis) ** 2).sum(axis=1) / 2
    side = np.cross(_AXIS, [0.0, 0, 1]) / np.linalg.norm(np.cross(_AXIS, [0.0, 0, 1]))
    turn = np.arctan2(drawn @ np.cross(_AXIS, side), drawn @ side)
    edges = np.append(phase.rings[:-1], 2 + 1e-6)
    counts = np.histogram2d(x, turn, [edges, np.linspace(-np.pi, np.pi, TURNS + 1)])[0]
    chi2, degrees = statistic(counts.ravel(), np.repeat(shares / TURNS, TURNS) * SAMPLES)
    tests = len(G) + len(DIAMETERS)
    yield Check("samples follow phase", phase.name, chi2 / critical_value(degrees, tests), 1.0,
                note=f"chi-squared over its threshold, {tests} tests")


def _check_distances(ratios: tuple[float, ...]) -> Iterator[Check]:
    """Light that collides before a distance of 1 and light that passes it are all the light, in each channel."""
    chances = np.full(3, 1 / 3)
    u = (np.arange(SAMPLES) + 0.5) / SAMPLES
    worst, where, broken = 0.0, 0.0, 0
    for tau in TAU:
        sigma_t = tau * np.array(ratios)
        given: dict[str, Any] = {"sigma_t": sigma_t, "chances": chances}
        t = call_glsl("media/distance.glsl", "free_distance", u=u, **given).astype(np.float64)
        collided = call_glsl("media/distance.glsl", "collision_weight", distance=np.minimum(t, 1), **given)
        passed = call_glsl("media/distance.glsl", "passing_weight", distance=1.0, **given)
        weight = np.where((t < 1)[:, None], collided, passed).astype(np.float64)
        broken += int((~np.isfinite(weight)).sum())
        lost = np.abs(weight.mean(axis=0) - 1).max()
        if lost > worst:
            worst, where = float(lost), tau
    name = "extinction " + ", ".join(f"{r:g}" for r in ratios)
    # A mean of stratified samples; the weights are at most 3.
    yield Check("distances keep all light", name, worst, 2e-4, note=f"worst at optical depth {where:g}")
    yield Check("no NaN, no Inf", f"distances, {name}", broken, 0)
