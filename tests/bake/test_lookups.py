"""viewer/bake/lookups.py: what the lookups give against the lobes themselves, in float64 and without any image."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.dfg import SIZE, dfg_table
from viewer.bake.irradiance import cosine_spectrum
from viewer.bake.lobe_samples import lobe_samples
from viewer.bake.lookups import fit_lookups
from viewer.bake.prefilter import LEVELS, level_of_roughness, level_spectrum
from viewer.plan.lookups import NARROW_ROUGHNESS

DEGREE = 120
VIEWS = [(NoV, roughness) for NoV in (0.1, 0.3, 0.6, 0.9) for roughness in (0.2, 0.35, 0.5, 0.7, 1.0)]
FILTERS = np.stack([level_spectrum("ggx", k, DEGREE) for k in range(LEVELS)] + [cosine_spectrum(DEGREE)])
NODES, NODE_WEIGHTS = np.polynomial.legendre.leggauss(200)
LEGENDRE = np.polynomial.legendre.legvander(NODES, DEGREE)


def table_at(NoV: float, roughness: float) -> np.ndarray:
    """The four texels as the texture unit interpolates them, (4, 4)."""
    quarters = dfg_table().reshape(4, SIZE, SIZE, 4).astype(np.float64)
    x, y = roughness * (SIZE - 1), np.sqrt(NoV) * (SIZE - 1)
    i, j = min(int(x), SIZE - 2), min(int(y), SIZE - 2)
    left, right = (quarters[:, j, i + k] * (1 - y + j) + quarters[:, j + 1, i + k] * (y - j) for k in (0, 1))
    return left * (1 - x + i) + right * (x - i)


def as_filtered_lobes(NoV: float, lookups: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Direction, spectrum and weights (in a, in b) of each lookup, and of the irradiance."""
    theta, found = np.arccos(NoV), []
    for t, level, *_ in lookups:
        d = np.array([1 - t + t * NoV, t * np.sin(theta), 0.0])
        low = min(int(level), LEVELS - 2)
        found.append((d / np.linalg.norm(d), FILTERS[low] * (1 - level + low) + FILTERS[low + 1] * (level - low)))
    weights = [*lookups[:, 2:], 1 - lookups[:, 2:].sum(axis=0)]
    return [(*lobe, w) for lobe, w in zip([*found, (np.array([1.0, 0, 0]), FILTERS[-1])], weights, strict=True)]


class RandomLight:
    """Soft lights of random places, sizes and powers: L(x) = sum_j p_j exp(k_j (x . c_j - 1))."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        centers = rng.normal(size=(12, 3))
        self.centers = centers / np.linalg.norm(centers, axis=1, keepdims=True)
        self.power, self.sharpness = rng.exponential(size=12), np.exp(rng.uniform(np.log(2), np.log(40), 12))
        lights = np.exp(self.sharpness[:, None] * (NODES - 1))
        self.series = (lights * NODE_WEIGHTS) @ LEGENDRE * (np.arange(DEGREE + 1) + 0.5)  # of P_n

    def seen(self, d: np.ndarray) -> np.ndarray:
        return np.exp(self.sharpness * (d @ self.centers.T - 1)) @ self.power

    def filtered(self, d: np.ndarray, spectrum: np.ndarray) -> float:
        at = np.polynomial.legendre.legvander(self.centers @ d, DEGREE)
        return float(self.power @ (self.series * spectrum * at).sum(axis=1))


def errors(f0: float) -> dict[str, np.ndarray]:
    """Of each view in each of 16 lights, in shares of the light's mean over all of that view."""
    found: dict[str, list] = {"one": [], "two": [], "mean direction": [], "mirror direction": []}
    lights = [RandomLight(seed) for seed in range(16)]
    for NoV, roughness in VIEWS:
        [half], [parts] = lobe_samples("ggx", "smith", np.array([NoV]), roughness**2, 20)
        lobe = parts @ [f0, 1] / 2
        both = np.concatenate([half, half * [1, 1, -1]])
        exact = np.array([light.seen(both) @ np.tile(lobe, 2) for light in lights])
        table, albedo = table_at(NoV, roughness), parts.sum(axis=0) * [f0, 1]
        ways = {"one": as_filtered_lobes(NoV, table[1:2]), "two": as_filtered_lobes(NoV, table[2:])}
        level = float(level_of_roughness(roughness))
        [(mirror, spectrum, ones), _] = as_filtered_lobes(NoV, np.array([[1, level, 1, 1]]))
        mean = (lobe @ half) * [1, 1, 0]
        ways |= {"mean direction": [(mean / np.linalg.norm(mean), spectrum, ones)],
                 "mirror direction": [(mirror, spectrum, ones)]}
        for name, way in ways.items():
            sums = [sum(light.filtered(d, spectrum) * (w @ albedo) for d, spectrum, w in way) for light in lights]
            found[name].append((np.array(sums) - exact) / exact.mean())
    return {name: np.array(values) for name, values in found.items()}


@pytest.mark.parametrize(("f0", "one", "two"), [(0.04, 0.05, 0.038), (0.9, 0.08, 0.053)])
def test_lookups_against_the_lobes_in_random_lights(f0, one, two):
    found = {name: np.sqrt(np.mean(values**2)) for name, values in errors(f0).items()}
    assert found["one"] < one and found["two"] < two
    assert found["two"] < 0.8 * found["one"] and found["one"] < 0.9 * found["mean direction"]
    assert found["mean direction"] < found["mirror direction"]


@pytest.mark.parametrize(("f0", "least", "most"), [(0.04, 0.75, 1.18), (0.9, 0.83, 1.2)])
def test_a_lamp_that_a_grazing_lobe_sees_well_is_seen_as_well(f0, least, most):
    """Light of a lamp that stands in the plane of incidence, anywhere from n to the horizon: of the lobe's."""
    light = RandomLight(0)
    light.power, light.sharpness = np.ones(1), np.full(1, 40.0)
    light.series = (np.exp(40 * (NODES[None] - 1)) * NODE_WEIGHTS) @ LEGENDRE * (np.arange(DEGREE + 1) + 0.5)
    for NoV, roughness in [(NoV, roughness) for NoV in (0.1, 0.2, 0.3) for roughness in (0.3, 0.4, 0.5)]:
        [half], [parts] = lobe_samples("ggx", "smith", np.array([NoV]), roughness**2, 20)
        both, lobe = np.concatenate([half, half * [1, 1, -1]]), np.tile(parts @ [f0, 1] / 2, 2)
        way, albedo = as_filtered_lobes(NoV, table_at(NoV, roughness)[2:]), parts.sum(axis=0) * [f0, 1]
        exact, found = [], []
        for angle in np.linspace(0, np.pi / 2, 31):
            light.centers = np.array([[np.cos(angle), np.sin(angle), 0.0]])
            exact.append(light.seen(both) @ lobe)
            found.append(sum(light.filtered(d, spectrum) * (w @ albedo) for d, spectrum, w in way))
        seen = np.array(exact) > 0.3 * max(exact)
        ratios = np.array(found)[seen] / np.array(exact)[seen]
        assert least < ratios.min() and ratios.max() < most


@pytest.mark.parametrize("f0", [0.04, 0.9])
def test_their_mean_direction_and_their_widths_are_the_lobe_s(f0):
    """First and second moments of the sum, in the plane of incidence and across it."""
    for NoV, roughness in VIEWS:
        [half], [parts] = lobe_samples("ggx", "smith", np.array([NoV]), roughness**2, 20)
        shares = parts.sum(axis=0) * [f0, 1] / (parts @ [f0, 1]).sum()
        weights = parts @ [f0, 1] / (parts @ [f0, 1]).sum()
        mean, square = weights @ half * [1, 1, 0], np.einsum("s,si,sj->ij", weights, half, half)
        found_mean, found_square = np.zeros(3), np.zeros((3, 3))
        for d, spectrum, of_parts in as_filtered_lobes(NoV, table_at(NoV, roughness)[2:]):
            w = of_parts @ shares
            found_mean += w * spectrum[1] * d
            found_square += w * (spectrum[2] * (np.outer(d, d) - np.eye(3) / 3) + np.eye(3) / 3)
        assert np.abs(found_mean - mean).max() < 0.09
        assert np.abs(np.diag(found_square - square)).max() < 0.09


def test_weights_conserve_energy_and_lookups_are_above_the_surface():
    shipped = dfg_table().reshape(4, SIZE, SIZE, 4)[1:].astype(np.float64)
    for found in (shipped[:1].transpose(1, 2, 0, 3), shipped[1:].transpose(1, 2, 0, 3),
                  *fit_lookups("beckmann", "v-cavity")):
        assert np.isfinite(found).all()
        assert found[..., 2:].min() >= 0 and found[..., 2:].sum(axis=2).max() <= 1 + 1e-6
        assert found[..., 1].min() >= 0 and found[..., 1].max() <= LEVELS - 1
        assert np.abs(np.diff(found[:, 2:, :, :2], axis=0)).max() < 1.5  # smooth enough to interpolate


def test_one_lookup_is_the_whole_of_a_narrow_lobe():
    for NoV in (0.0, 0.2, 0.77, 1.0):
        for roughness in (0.0, 0.03, NARROW_ROUGHNESS):
            _, one, first, second = table_at(NoV, roughness)
            assert first == pytest.approx(one * [1, 1, 0.5, 0.5], abs=1e-6) and second == pytest.approx(first, abs=1e-6)
    _, one, first, second = table_at(0.2, NARROW_ROUGHNESS + 0.03)
    assert np.abs(first - second).max() > 0.01
