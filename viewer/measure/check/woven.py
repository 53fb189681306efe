"""Checks of woven cloth: no light is created or lost, light may be reversed, samples follow their pdf, and all numbers
are finite at extreme parameters.

The BSDF of shaders/bsdf/weave/woven.glsl scatters to both sides. A share goes straight on; its samples alone have it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...bake.yarn import SLICES, max_rise, weave_table
from ...gpu.call import call_glsl
from ...scene.weave import WEAVES, Weave, Yarn
from .checks import Check
from .chi_squared import critical_value, statistic
from .energy import directions
from .lobes import DELTA

FILE = "bsdf/weave/woven.glsl"
COSINES = (1.0, 0.6, 0.2, 0.03)
SAMPLES = 1 << 13
BINS, NODES = 16, 10
"""Of the cosine and of the azimuth; and the quadrature nodes in each bin, along each."""
GAIN_BOUND, LOSS_BOUND, ALBEDO_BOUND, RECIPROCITY_BOUND = 4e-3, 0.01, 0.02, 1e-4
"""The share that is mirrored once is interpolated between nodes, least exactly at grazing angles."""


def check_woven() -> Iterator[Check]:
    """Rows for each kind of place in a cloth."""
    for case, m, table in _places():
        yield from _check_place(f"woven, {case}", m, table)


def check_woven_extremes() -> Iterator[Check]:
    """How many numbers are not finite where every parameter is at one of its ends."""
    rng = np.random.default_rng(13)
    count = 1 << 14
    (_, m, table), *_ = _places()
    tilt = rng.choice([0, 0.5, np.pi / 2], count)
    m = m | {"axis": np.stack([np.cos(tilt), 0 * tilt, np.sin(tilt)], axis=-1),
             "normal": np.stack([-np.sin(tilt), 0 * tilt, np.cos(tilt)], axis=-1),
             **{name: rng.choice(ends, (count, 3)) for name, ends in (
                 ("specular", (0, 0.5)), ("passed", (0, 1)), ("returned", (0, 1)), ("diffuse", (0, 0.5, 1)),
                 ("below", (0, 0.5, 1)))},
             **{name: rng.choice(ends, count) for name, ends in (
                 ("alpha", (0, 0.02, 1)), ("thickness", (0, 1e-6, 8, 1e4)), ("through", (0, 0.5, 1)),
                 ("below_through", (0, 0.5, 1)), ("horizon", (0, 1, 1e6)))},
             "gap": rng.choice([-1, 0, 1, 1e3], (count, 2))}
    wo, wi = (directions((1.0, 0.5, 0.01, 1e-6))[rng.integers(4, size=count)] * rng.choice([-1, 1], (count, 1))
              for _ in range(2))
    u = rng.choice(np.array([0, 2**-24, 0.5, 1 - 2**-24], np.float32), (count, 3))
    drawn = _call("sample(Woven, vec3, vec3, sampler2D)", m, table, wo=wo, u=u)
    found = [*(drawn[name] for name in ("wi", "weight", "pdf")), _call("eval", m, table, wo=wo, wi=wi),
             _call("pdf", m, table, wo=wo, wi=wi), _call("albedo", m, table, wo=wo)]
    yield Check("no NaN, no Inf", "woven at extreme parameters", sum(int((~np.isfinite(x)).sum()) for x in found), 0)


def _places() -> list[tuple[str, dict[str, Any], np.ndarray]]:
    """White places in a cloth: their parameters, and the table of what is mirrored."""
    warp, weft = Yarn(roughness=0.15, thickness=4.0, bend=40.0), Yarn(roughness=1.0, thickness=0.7, bend=40.0)
    table = weave_table(Weave(WEAVES["plain"].draft, warp, weft))
    found = []
    for case, yarn, rise, lean, horizon, gap in (
            ("flat yarn", warp, 0.0, 0.0, 1e6, (-1, -1)), ("steep yarn", warp, -0.5, 0.0, 1e6, (-1, -1)),
            ("side of a yarn", warp, 0.2, 1.5, 0.5, (-1, -1)), ("thin yarn", weft, 0.4, 0.3, 3.0, (-1, -1)),
            ("gap", weft, 0.0, 0.0, 1e6, (0.4, 2.5))):
        normal = np.array([lean * 0.6 - np.sin(rise), lean * 0.8, np.cos(rise)])
        steps = abs(np.sin(rise)) / max_rise(yarn) * (SLICES - 1)
        found.append((case, {
            "axis": np.array([np.cos(rise), 0, np.sin(rise)]), "normal": normal / np.linalg.norm(normal),
            "alpha": yarn.roughness, "thickness": yarn.thickness, "specular": 0.5,
            "passed": 1.0, "returned": 1.0, "diffuse": 1.0, "through": 0.3,
            "below": np.ones(3), "below_through": 0.4, "slice": (0 if yarn is warp else SLICES) + steps,
            "horizon": horizon, "gap": np.array(gap, float)}, table))
    return found


def _check_place(case: str, white: dict[str, Any], table: np.ndarray) -> Iterator[Check]:
    wo = np.concatenate([_turned(directions(COSINES), turn) for turn in (0.1, 1.6)])
    straight = _call("view(Woven, vec3, sampler2D)", white, table, wo=wo)["straight"]
    total = _over_bins("eval", white, table, wo).sum(axis=1)[:, 0] + straight
    yield Check("reflects at most all", case, float(total.max() - 1), GAIN_BOUND)
    yield Check("white furnace", case, float(1 - total.min()), LOSS_BOUND)

    colored = white | {"specular": np.array([0.1, 0.3, 0.5]), "passed": np.array([0.9, 0.8, 0.6]),
                       "returned": np.array([0.8, 0.6, 0.4]), "diffuse": np.array([0.8, 0.4, 0.1])}
    light = _over_bins("eval", colored, table, wo).sum(axis=1)
    albedo = _call("albedo", colored, table, wo=wo)
    yield Check("albedo", case, float(np.abs(albedo - light).max()), LOSS_BOUND)
    rng = np.random.default_rng(14)
    a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in rng.normal(size=(2, 4096, 3)))
    steep = np.minimum(np.abs(a[:, 2]), np.abs(b[:, 2])) > 0.05
    forth, back = (_call("eval", colored, table, wo=x[steep], wi=y[steep]) for x, y in ((a, b), (b, a)))
    error = np.abs(forth - back) / np.maximum(np.maximum(forth, back), 1e-2)
    yield Check("reciprocity", case, float(error.max()), RECIPROCITY_BOUND)

    u = rng.random((len(wo), SAMPLES, 3), np.float32)
    drawn = _call("sample(Woven, vec3, vec3, sampler2D)", colored, table, wo=wo[:, None], u=u)
    share = _over_bins("pdf", colored, table, wo)[..., 0]
    scattered = (drawn["flags"] != 0) & (drawn["flags"] & DELTA == 0)
    worst = 0.0
    for wi, kept, part in zip(drawn["wi"], scattered, share):
        place = wi[kept][:, 2], np.arctan2(wi[kept][:, 1], wi[kept][:, 0]) % (2 * np.pi)
        counts = np.histogram2d(*place, BINS, [(-1, 1), (0, 2 * np.pi)])[0].ravel()
        chi2, degrees = statistic(counts, SAMPLES * part)
        worst = max(worst, chi2 / critical_value(degrees, len(wo) * 5))
    yield Check("samples follow pdf", case, worst, 1.0, note="chi-squared over its threshold")
    mean = np.where(scattered[..., None], drawn["weight"], 0).mean(axis=1)
    yield Check("mean weight of samples = albedo", case, float(np.abs(mean - albedo).max()), ALBEDO_BOUND)


def _over_bins(function: str, m: dict[str, Any], table: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """The integrals of eval |cos| or of the pdf over the bins of the sphere, (N, BINS^2, channels)."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    place = (np.arange(BINS)[:, None] + (node + 1) / 2).ravel() / BINS
    z, phi = np.meshgrid(2 * place - 1, 2 * np.pi * place, indexing="ij")
    s = np.sqrt(1 - z * z)
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)
    found = _call(function, m, table, wo=wo[:, None, None], wi=wi).astype(np.float64)
    if function == "eval":
        found *= np.abs(z)[..., None]
    parts = found.reshape(len(wo), BINS, NODES, BINS, NODES, -1)
    return np.einsum("naibjc,i,j->nabc", parts, weight * np.pi / BINS**2, weight).reshape(len(wo), BINS**2, -1)


def _turned(w: np.ndarray, angle: float) -> np.ndarray:
    """`w` turned about the z axis."""
    c, s = np.cos(angle), np.sin(angle)
    return w @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def _call(function: str, m: dict[str, Any], table: np.ndarray, **arrays: Any) -> Any:
    return call_glsl(FILE, f"woven_{function}", m=m, table=table, **arrays)
