"""Checks of any BSDF: it conserves energy, is not negative, is reciprocal, and its samples follow its pdf."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .checks import Check
from .chi_squared import critical_value, statistic
from .half_vector import bin_counts, bin_integrals, binned_grid, mirrored, reflected_grid, refracted_grid
from .lobes import DELTA, TRANSMISSION

NOV = (1.0, 0.7, 0.4, 0.15, 0.05)
AZIMUTH = 0.7  # of wo: on neither tangent
SAMPLES = 1 << 14
BINS = (20, 12)
Drawn = Mapping[str, np.ndarray]

FURNACE_BOUND = 5e-3
BALANCE_BOUND = 2e-3
"""How far above 1 float32 and the quadrature may be; sharp lobes cannot be integrated more exactly."""


@dataclass(frozen=True)
class LobeCase:
    """A lobe and the parameter sets at which it is checked: each of `values` has the sets on its first axis.

    `lobe` has eval(m, wo, wi); `provides` names which of sample(m, wo, u), pdf(m, wo, wi) and albedo(m, NoV) it has.

    `white` is true for each set that absorbs nothing, so that all light has to leave, to within `furnace_bound`.
    `expected` names the checks that the model is known to fail. A lobe with `eta` also transmits light, refracted by
    the sets' eta; one that `mirrors` transmits it in the direction of reflection, mirrored at the surface's plane.
    """

    name: str
    lobe: Any
    values: Mapping[str, np.ndarray]
    white: np.ndarray
    expected: Collection[str] = field(default_factory=frozenset)
    furnace_bound: float = FURNACE_BOUND
    albedo_bound: float = 0.01
    provides: frozenset[str] = frozenset({"sample", "pdf", "albedo"})
    eta: np.ndarray | None = None
    mirrors: bool = False

    @property
    def transmits(self) -> bool:
        return self.mirrors or self.eta is not None

    @property
    def sets(self) -> int:
        return len(self.white)

    @property
    def is_anisotropic(self) -> bool:
        alpha = np.asarray(self.values.get("alpha", 0.0))
        across, along = alpha.T if alpha.ndim == 2 else (alpha, np.asarray(self.values.get("alpha_t", alpha)))
        return bool((across != along).any())

    def repeated(self, per_set: int, *, axis: bool = True) -> dict[str, np.ndarray]:
        """Every set `per_set` times over, with an axis for what each case is asked."""
        out = {name: np.repeat(np.asarray(value), per_set, axis=0) for name, value in self.values.items()}
        return {name: value[:, None] if axis else value for name, value in out.items()}


def check_lobe(case: LobeCase) -> Iterator[Check]:
    """Every check that the functions of the lobe allow; each row is the worst of all its parameter sets."""
    wo = np.tile(directions(NOV), (case.sets, 1))
    albedo = _Integral(case, wo)
    yield from _check_balance(case, albedo)
    yield from _check_pairs(case)
    if {"sample", "pdf"} <= case.provides:
        yield from _check_sampling(case, wo, albedo)
    if "albedo" in case.provides:
        NoV = wo[:, 2]
        found = case.lobe.albedo(case.repeated(len(NOV), axis=False), NoV)
        # The light of mirrors is all in one direction, and not in the integral.
        gap = np.abs(found - albedo.of_light).max(axis=-1) / np.maximum(albedo.of_light.max(axis=-1), 1)
        yield _row(case, "albedo", gap * (albedo.of_light.max(axis=-1) > 0), case.albedo_bound, wo)


def directions(cosines: Collection[float]) -> np.ndarray:
    """Unit vectors (N, 3) with these z, all at one azimuth."""
    z = np.asarray(list(cosines), np.float64)
    s = np.sqrt(1 - z**2)
    return np.stack([s * np.cos(AZIMUTH), s * np.sin(AZIMUTH), z], axis=-1)


class _Integral:
    """Integrals over the directions wi of K cases, by quadrature in half vectors."""

    def __init__(self, case: LobeCase, wo: np.ndarray) -> None:
        nodes = 200 if case.is_anisotropic else 64
        grids = [(reflected_grid(wo, nodes), np.ones(len(wo)))]
        if case.eta is not None:
            # Refraction compresses solid angles: beyond the surface radiance is eta^2 times as large.
            eta = np.repeat(case.eta, len(NOV))
            grids.append((refracted_grid(wo, eta, nodes), eta**2))
        if case.mirrors:
            grids.append((mirrored(grids[0][0]), np.ones(len(wo))))
        values = case.repeated(len(NOV))
        self.of_light, self.of_view, self.of_pdf = np.zeros((len(wo), 3)), np.zeros((len(wo), 3)), np.zeros(len(wo))
        for grid, compression in grids:
            weight = grid.solid_angle * np.abs(grid.wi[..., 2]) * compression[:, None]
            forth = case.lobe.eval(values, wo[:, None], grid.wi)
            self.of_light += np.einsum("kqc,kq->kc", _lit(forth, weight), weight)
            if "pdf" in case.provides:
                pdf = _lit(case.lobe.pdf(values, wo[:, None], grid.wi), weight)
                self.of_pdf += (pdf * grid.solid_angle).sum(axis=1)
        grid = grids[0][0]
        weight = grid.solid_angle * np.abs(grid.wi[..., 2])
        back = case.lobe.eval(values, grid.wi, np.broadcast_to(wo[:, None], grid.wi.shape))
        self.of_view = np.einsum("kqc,kq->kc", _lit(back, weight), weight)


def _check_balance(case: LobeCase, albedo: _Integral) -> Iterator[Check]:
    wo = np.tile(directions(NOV), (case.sets, 1))
    white = np.repeat(case.white, len(NOV))
    if white.any():
        # An albedo above 1 is reported by the next row.
        lost = 1 - albedo.of_light.min(axis=-1)
        yield _row(case, "white furnace", np.where(white, lost, -np.inf), case.furnace_bound, wo)
    yield _row(case, "reflects at most all", albedo.of_light.max(axis=-1) - 1, BALANCE_BOUND, wo)
    yield _row(case, "hemisphere balance", albedo.of_view.max(axis=-1) - 1, BALANCE_BOUND, wo)


def _check_pairs(case: LobeCase) -> Iterator[Check]:
    """All pairs of some directions, from the normal down to a cosine of 1e-6."""
    cosines = np.array([1, 0.9, 0.5, 0.1, 1e-3, 1e-6])
    wo = directions(cosines)
    turns = np.linspace(-np.pi, np.pi, 13)[:-1] + 0.05
    s = np.sqrt(1 - cosines**2)
    wi = np.stack([np.multiply.outer(s, np.cos(turns)), np.multiply.outer(s, np.sin(turns)),
                   np.repeat(cosines[:, None], len(turns), axis=1)], axis=-1).reshape(-1, 3)
    if case.transmits:
        wi = np.concatenate([wi, wi * [1, 1, -1]])
    values = case.repeated(len(wo))
    wo_all, wi_all = np.tile(wo, (case.sets, 1))[:, None], np.broadcast_to(wi, (case.sets * len(wo), *wi.shape))
    forth = case.lobe.eval(values, wo_all, wi_all)
    per_case = np.where(np.isfinite(forth), -forth, np.inf).max(axis=(1, 2))
    yield _row(case, "not negative", np.maximum(per_case, 0), 0.0, wo_all[:, 0])
    above = wi[:, 2] > 0
    back = case.lobe.eval(values, wi_all[:, above], np.broadcast_to(wo_all, wi_all[:, above].shape))
    scale = np.maximum(np.maximum(np.abs(forth[:, above]), np.abs(back)), 1e-6)
    yield _row(case, "reciprocity", (np.abs(forth[:, above] - back) / scale).max(axis=(1, 2)), 1e-3, wo_all[:, 0])


def _check_sampling(case: LobeCase, wo: np.ndarray, albedo: _Integral) -> Iterator[Check]:
    random = np.random.default_rng(7)
    values = case.repeated(len(NOV))
    u = random.random((1, SAMPLES, 3), np.float32)
    drawn = case.lobe.sample(values, wo[:, None], np.broadcast_to(u, (len(wo), SAMPLES, 3)))
    kept = (drawn["flags"] & DELTA == 0) & (drawn["flags"] != 0)
    share = kept.mean(axis=1)
    spread = 5 * np.sqrt(np.maximum(share * (1 - share), 1e-4) / SAMPLES)
    yield _row(case, "pdf integrates to 1", np.abs(albedo.of_pdf - share), 0.0, wo, allowed=5e-3 + spread,
               note="without samples below the surface; the bound is 5 standard deviations and 0.005")
    yield from _check_weights(case, wo, drawn, kept)
    yield from _check_histogram(case, wo, drawn, kept)


def _check_weights(case: LobeCase, wo: np.ndarray, drawn: Drawn, kept: np.ndarray) -> Iterator[Check]:
    values = case.repeated(len(NOV))
    few = slice(0, 2048)
    wi, pdf, weight = drawn["wi"][:, few], drawn["pdf"][:, few], drawn["weight"][:, few]
    f = case.lobe.eval(values, wo[:, None], wi)
    asked = case.lobe.pdf(values, wo[:, None], wi)
    with np.errstate(divide="ignore", invalid="ignore"):
        expected = f * np.abs(wi[..., 2:]) / asked[..., None]
        error = np.abs(weight - expected).max(axis=-1) / np.maximum(expected.max(axis=-1), 1e-3)
        pdf_error = np.abs(pdf / asked - 1)
    # Directions are float32, and shift a lobe of width alpha by 6e-8 / alpha of its width: so a quantile is checked.
    for name, errors in (("weight = f cos / pdf", error), ("sample's pdf = pdf", pdf_error)):
        typical = np.array([np.quantile(e[k], 0.99) if k.any() else 0.0 for e, k in zip(errors, kept[:, few])])
        yield _row(case, name, typical, 0.01, wo, note="99 % of the samples")


def _check_histogram(case: LobeCase, wo: np.ndarray, drawn: Drawn, kept: np.ndarray) -> Iterator[Check]:
    tests = []
    values = case.repeated(len(NOV))
    for transmitted in (False, True) if case.transmits else (False,):
        side = (drawn["flags"] & TRANSMISSION != 0) == transmitted
        eta = np.repeat(case.eta, len(NOV)) if transmitted and case.eta is not None else None
        mirror = np.array([1, 1, -1 if transmitted and case.mirrors else 1])
        nodes = (8 if eta is None else 12, 24 if case.is_anisotropic else 6 if eta is None else 10)

        def density(wi: np.ndarray, mirror: np.ndarray = mirror) -> np.ndarray:
            return case.lobe.pdf(values, wo[:, None], wi * mirror)

        expected = bin_integrals(density, binned_grid(wo, BINS, nodes, eta), BINS) * drawn["wi"].shape[1]
        for k, counts in enumerate(bin_counts(wo, drawn["wi"] * mirror, kept & side, BINS, eta)):
            if counts.any() or expected[k].sum() > 1:
                tests.append((k, *statistic(counts, expected[k])))
    ratios = np.full(len(wo), -np.inf)
    for k, chi2, degrees in tests:
        ratios[k] = max(ratios[k], chi2 / critical_value(degrees, len(tests)))
    if tests:
        note = f"chi-squared over its threshold, {len(tests)} tests"
        yield _row(case, "samples follow pdf", ratios, 1.0, wo, note=note)


def _lit(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """`values`, and 0 where the weight is 0: there is no such direction, and the value has no meaning."""
    return np.where(weight[..., None] > 0 if values.ndim > weight.ndim else weight > 0, values, 0.0)


def _row(case: LobeCase, check: str, values: np.ndarray, bound: float, wo: np.ndarray,
         allowed: np.ndarray | None = None, note: str = "") -> Check:
    """The row of the case whose value exceeds its bound most, or is nearest to it."""
    values = np.where(np.isnan(values), np.inf, values)
    worst = int(np.argmax(values if allowed is None else values - allowed))
    chosen = worst // (len(values) // case.sets)
    place = ", ".join(f"{name} {_short(value[chosen])}" for name, value in case.values.items())
    where = f"worst at NoV {wo[worst, 2]:.2g}" + (f", {place}" if place else "")
    return Check(check, case.name, float(values[worst]), float(bound if allowed is None else allowed[worst]),
                 check in case.expected, f"{where}; {note}" if note else where)


def _short(value: Any) -> str:
    return "/".join(f"{number:.3g}" for number in np.unique(np.atleast_1d(value)))
