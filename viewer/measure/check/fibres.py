"""Checks of the scattering of fibres: no light is created or lost, samples follow their pdf, and float32 suffices.

A fibre scatters over the whole sphere, and light counts by the cosine to its normal plane, which `fibre_eval` includes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...gpu.call import call_glsl
from .checks import Check
from .chi_squared import critical_value, statistic

FILE = "bsdf/fibre/fibre.glsl"
ROUGHNESSES = ((0.2, 0.2), (0.3, 0.3), (0.5, 1.0), (1.0, 0.5))
"""Pairs of beta_m and beta_n, rough enough for the quadrature over the sphere."""
BALANCE_BOUND = 2e-3
SAMPLES = 1 << 14
BINS, NODES = 16, 10
"""Of the sine of the inclination and of the azimuth; and the quadrature nodes in each bin, along each."""
EXTREMES: dict[str, tuple[float, ...]] = {
    "sigma_a": (0, 1e-6, 1, 80, 1e6, 1e30), "beta_m": (0, 1e-3, 0.3, 1), "beta_n": (0, 1e-3, 0.3, 1),
    "tilt": (0, 0.035, -0.5), "eta": (1, 1.0001, 1.55, 100)}
OFFSETS = (0.0, 0.4, -0.9, 0.999, 1.0, -1.0, 1 + 1e-6)
INCLINATIONS = (0.0, 0.6, -1.3, np.pi / 2)


@dataclass(frozen=True)
class _Case:
    """Fibres of one roughness: offsets (N,) and directions wo (N, 3) at which light is asked for."""

    beta_m: float
    beta_n: float

    def __str__(self) -> str:
        return f"fibre, roughness {self.beta_m:g} along and {self.beta_n:g} about it"

    def fibre(self, sigma_a: Any) -> dict[str, Any]:
        return {"sigma_a": np.asarray(sigma_a, float), "beta_m": self.beta_m, "beta_n": self.beta_n, "tilt": 0.035,
                "eta": 1.55}


def check_fibres() -> Iterator[Check]:
    """Rows for each roughness: the white furnace, the albedo, the pdf, the samples and their weights."""
    for beta_m, beta_n in ROUGHNESSES:
        yield from _check_case(_Case(beta_m, beta_n))


def check_fibre_extremes() -> Iterator[Check]:
    """How many numbers are not finite where every parameter is at one of its ends."""
    rng = np.random.default_rng(9)
    count = 1 << 15
    f = {name: rng.choice(ends, (count, 3) if name == "sigma_a" else count) for name, ends in EXTREMES.items()}
    h = rng.choice(OFFSETS, count)
    wo, wi = (_direction(rng.choice(INCLINATIONS, count), rng.choice([0.0, 1.0, np.pi], count)) for _ in range(2))
    wo[::7] = 1.0, 0.0, 0.0  # exactly along the fibre
    u = rng.choice(np.array([0, 2**-24, 0.5, 1 - 2**-24], np.float32), (count, 4))
    found = [*call_glsl(FILE, "fibre_sample", f=f, h=h, wo=wo, u=u).values(),
             call_glsl(FILE, "fibre_eval", f=f, h=h, wo=wo, wi=wi),
             call_glsl(FILE, "fibre_pdf", f=f, h=h, wo=wo, wi=wi), call_glsl(FILE, "fibre_albedo", f=f, h=h, wo=wo)]
    yield Check("no NaN, no Inf", "fibre at extreme parameters", sum(int((~np.isfinite(x)).sum()) for x in found), 0)


def _check_case(case: _Case) -> Iterator[Check]:
    h, theta = (grid.ravel() for grid in np.meshgrid([0.0, 0.5, -0.95], [0.0, 0.7, -1.3], indexing="ij"))
    wo = _direction(theta, 0.7)
    colored = case.fibre((0.05, 0.5, 3.0))
    pdf = _over_bins("fibre_pdf", colored, h, wo)
    light = _over_bins("fibre_eval", colored, h, wo).sum(axis=1)
    white = _over_bins("fibre_eval", case.fibre(0.0), h, wo).sum(axis=1)
    albedo = call_glsl(FILE, "fibre_albedo", f=colored, h=h, wo=wo)
    yield Check("white furnace", str(case), float(np.abs(white - 1).max()), BALANCE_BOUND)
    yield Check("albedo", str(case), float(np.abs(albedo - light).max()), BALANCE_BOUND)
    yield Check("pdf integrates to 1", str(case), float(np.abs(pdf.sum(axis=1) - 1).max()), BALANCE_BOUND)

    u = np.random.default_rng(12).random((len(h), SAMPLES, 4), np.float32)
    drawn = call_glsl(FILE, "fibre_sample", f=colored, h=h[:, None], wo=wo[:, None], u=u)
    worst = 0.0
    for wi, share in zip(drawn["wi"], pdf[..., 0]):
        place = wi[:, 0], np.arctan2(wi[:, 2], wi[:, 1])
        counts = np.histogram2d(*place, BINS, [(-1, 1), (-np.pi, np.pi)])[0].ravel()
        chi2, degrees = statistic(counts, SAMPLES * share)
        worst = max(worst, chi2 / critical_value(degrees, len(h) * len(ROUGHNESSES)))
    yield Check("samples follow pdf", str(case), worst, 1.0, note="chi-squared over its threshold")

    at = {"f": colored, "h": h[:, None], "wo": wo[:, None], "wi": drawn["wi"]}
    density = call_glsl(FILE, "fibre_pdf", **at)
    weight = call_glsl(FILE, "fibre_eval", **at) / density[..., None]
    yield Check("weight = f cos / pdf", str(case), float(np.abs(drawn["return"] - weight).max()), 0.01)
    yield Check("sample's pdf = pdf", str(case), float(np.abs(drawn["pdf"] / density - 1).max()), 0.01)


def _over_bins(function: str, f: dict[str, Any], h: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """The integrals of a function over the bins of the sphere, (N, BINS^2, channels), by Gauss-Legendre quadrature."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    place = (np.arange(BINS)[:, None] + (node + 1) / 2).ravel() / BINS
    sine, phi = np.meshgrid(2 * place - 1, 2 * np.pi * place - np.pi, indexing="ij")
    found = call_glsl(FILE, function, f=f, h=h[:, None, None], wo=wo[:, None, None],
                      wi=_direction(np.arcsin(sine), phi)).astype(np.float64)
    area = np.pi / BINS**2 * weight
    parts = found.reshape(len(h), BINS, NODES, BINS, NODES, -1)
    return np.einsum("naibjc,i,j->nabc", parts, area, weight).reshape(len(h), BINS**2, -1)


def _direction(theta: Any, phi: Any) -> np.ndarray:
    """Unit vectors (..., 3) at the inclination theta from the normal plane, and the azimuth phi about the x axis."""
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta), np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi)], axis=-1)
