"""A thin film against the spectral integral in float64, and what no film may change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import thin_film
from microfacet_twins import f82_tint, fresnel, schlick

from viewer.gpu.call import call_glsl
from viewer.measure.check.energy import directions
from viewer.measure.check.half_vector import reflected_grid
from viewer.measure.check.lobes import LOBES

SURFACE = next(lobe for lobe in LOBES if lobe.name == "standard iridescent")
MU = np.concatenate([np.linspace(0.05, 1, 24), [1e-3, 1e-6]])
INDICES, THICKNESSES = (1.1, 1.33, 1.8, 2.5, 3.0), (1e-3, 20, 100, 250, 400, 700, 1500, 5000, 1e5, 1e6)


def film(F: np.ndarray, mu: np.ndarray, ior: float, film_ior: float, thickness: float) -> np.ndarray:
    """What the shaders reflect, (N, 3), of N reflectances F of the bare interface."""
    layer = {"weight": 1.0, "ior": film_ior, "thickness": thickness, "walls": 0.0}
    return call_glsl("bsdf/film.glsl", "film_over", film=layer, mu=mu, F=F, ior=ior)


def integral(thickness: float) -> np.ndarray:
    """Wavelengths for the integral: more where a thick film turns the phase faster."""
    return np.arange(380.0, 781.0, 0.02 if thickness > 1e4 else 1.0)


@pytest.mark.parametrize(("ior", "mean", "most"), [
    (1.0001, 0.01, 0.2), (1.33, 1e-3, 0.02), (1.5, 1e-3, 0.02), (2.4, 2e-3, 0.05), (3.0, 2e-3, 0.06)])
def test_over_a_dielectric_it_is_the_integral_by_fresnels_amplitudes(ior, mean, most):
    """A film in air keeps light that grazes it for more orders than are summed: there the cosine is at least 0.2."""
    errors = []
    for film_ior in INDICES:
        for thickness in THICKNESSES[:8]:
            F = np.repeat(fresnel(MU, ior)[:, None], 3, axis=1)
            expected = np.clip(thin_film.airy(MU, ior, film_ior, thickness, integral(thickness)), 0, 1)
            errors.append(np.abs(film(F, MU, ior, film_ior, thickness) - expected))
    least = 0.2 if ior < 1.1 else 0.0
    counted = np.array(errors)[:, least <= MU]
    assert np.sqrt(np.mean(np.square(counted))) < mean and counted.max() < most


@pytest.mark.parametrize("thickness", [1e5, 1e6])
def test_a_thick_film_has_the_mean_of_all_phases(thickness):
    """Airy's mean over the phase: two faces whose light does not interfere."""
    for film_ior in INDICES:
        F = np.repeat(fresnel(MU, 1.5)[:, None], 3, axis=1)
        mean = 0.0
        for r12, r13 in zip(thin_film.amplitudes(MU, film_ior), thin_film.amplitudes(MU, 1.5)):
            r23 = (r13 - r12) / (1 - r12 * r13)
            mean = mean + (1 - (1 - r12**2) * (1 - r23**2) / (1 - (r12 * r23) ** 2)) / 2
        found = film(F, MU, 1.5, film_ior, thickness)
        np.testing.assert_allclose(found, np.repeat(mean[:, None], 3, axis=1), atol=2e-5)


@pytest.mark.parametrize("base", ["schlick, glass", "schlick, gold", "tinted titanium"])
def test_over_any_curve_it_is_the_integral_with_that_curve(base):
    f0, ior = {"schlick, glass": ((0.04,) * 3, 1.5), "schlick, gold": ((1.0, 0.77, 0.34), 0.0),
               "tinted titanium": ((0.54, 0.5, 0.45), 0.0)}[base]
    F = f82_tint(np.array(f0), np.array([0.9, 0.8, 0.7]), MU) if "tinted" in base else schlick(np.array(f0), 1.0, MU)
    errors = []
    for film_ior in INDICES:
        for thickness in THICKNESSES[:8]:
            expected = thin_film.reflectance(F, MU, ior, film_ior, thickness, integral(thickness))
            errors.append(np.abs(film(F, MU, ior, film_ior, thickness) - expected))
    assert np.sqrt(np.mean(np.square(errors))) < 4e-3 and np.max(errors) < 0.08


def test_a_film_without_thickness_or_contrast_is_the_bare_interface_bit_for_bit():
    rng = np.random.default_rng(1)
    F, mu = rng.random((500, 3)).astype(np.float32), rng.random(500).astype(np.float32)
    for ior in (0.0, 1.0, 1.5, 2.5):
        assert np.array_equal(film(F, mu, ior, 1.8, 0.0), F)
        assert np.array_equal(film(F, mu, ior, 1.0, 400.0), F)
        nearly = [film(F, mu, ior, 1.8, thickness) - F for thickness in (0.01, 0.02)]
        assert 1e-9 < np.abs(nearly[0]).max() < 1e-3 and np.abs(nearly[1]).max() < 5 * np.abs(nearly[0]).max()


def test_extremes_are_finite_and_within_0_and_1():
    rng = np.random.default_rng(2)
    F = rng.choice([0.0, 1e-7, 0.04, 0.5, 1.0], (400, 3))
    mu = rng.choice([0.0, 1e-7, 1e-3, 0.5, 1.0], 400)
    for ior in (0.0, 1.0, 1.5, 3.0):
        for film_ior in (1.0, 1.0 + 1e-6, 3.0):
            for thickness in (0.0, 1e-3, 400.0, 1e6, 1e12):
                found = film(F, mu, ior, film_ior, thickness)
                assert np.isfinite(found).all() and (found >= 0).all() and (found <= 1).all()


def test_the_observer_is_near_that_of_1931():
    """CIE 1931's tables of the 2 degree observer, every 50 nm from 400 on."""
    table = np.array([[0.0143, 0.0004, 0.0679], [0.3362, 0.0380, 1.7721], [0.0049, 0.3230, 0.2720],
                      [0.4334, 0.9950, 0.0087], [1.0622, 0.6310, 0.0008], [0.2835, 0.1070, 0.0], [0.0114, 0.0041, 0.0]])
    found = thin_film.color_matching(np.arange(400.0, 701.0, 50.0)).T
    assert np.abs(found - table).max() < 0.03


@pytest.mark.parametrize("alpha", [0.02, 0.15, 0.5, 1.0])
def test_all_channels_of_white_below_a_film_stay_white(alpha):
    """Of light and of its complement: to a hundredth, and never above 1 by more than the albedo's error."""
    cosines = (1.0, 0.6, 0.3, 0.1)
    sets = [(film_ior, thickness, NoV) for film_ior in (1.2, 1.5, 2.2) for thickness in (20.0, 150.0, 300.0, 700.0)
            for NoV in cosines]
    film_ior, thickness, NoV = (np.array(value)[:, None] for value in zip(*sets))
    wo = directions(NoV[:, 0])
    grid = reflected_grid(wo, 48)
    m = SURFACE.struct(film_ior=film_ior, film_thickness=thickness, alpha=alpha, alpha_t=alpha)
    light = SURFACE.eval(m, wo[:, None], grid.wi) * (grid.solid_angle * np.abs(grid.wi[..., 2]))[..., None]
    total = np.where(grid.solid_angle[..., None] > 0, light, 0).sum(axis=1)
    assert total.min() > 0.99 and total.max() < 1.008


def test_the_exact_curve_below_a_film_is_the_integral_of_the_index():
    lobe = replace(SURFACE, defines={**SURFACE.defines, "FRESNEL": 1})
    mu = MU[:24]
    wo = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], axis=-1)
    m = lobe.struct(base_color=0.0, f0=0.04, ior=1.5, alpha=0.0, film_ior=1.8, film_thickness=300.0)
    found = lobe.sample(m, wo, np.zeros(3))
    expected = np.clip(thin_film.airy(mu, 1.5, 1.8, 300.0), 0, 1)
    np.testing.assert_allclose(found["weight"] * found["pdf"][:, None], expected, atol=2e-3)


@pytest.mark.parametrize("name", ["dielectric", "thin_dielectric"])
def test_smooth_glass_with_a_film_reflects_and_transmits_all(name):
    (lobe,) = (lobe for lobe in LOBES if lobe.name == f"{name} with a film")
    mu = MU[:24]
    wo = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], axis=-1)
    for eta in (1.0, 1.5, 1 / 1.5) if name == "dielectric" else (1.0, 1.5):
        m = lobe.struct(eta=eta, alpha=0.0, f0=((eta - 1) / (eta + 1)) ** 2, film_ior=1.7)
        R, T = (lobe.sample(m, wo, np.array([0, 0, u])) for u in (0.0, 1 - 2**-24))
        reflected = R["weight"] * R["pdf"][:, None]
        outside = np.sqrt(np.maximum(1 - (1 - mu**2) / min(eta, 1) ** 2, 0))
        expected = np.clip(thin_film.airy(outside, max(eta, 1 / eta), 1.7, 350.0), 0, 1)
        if name == "thin_dielectric":
            expected = 2 * expected / (1 + expected)
        leaves = outside > 0
        np.testing.assert_allclose(reflected[leaves], expected[leaves], atol=3e-3 if eta != 1 else 1e-2)
        assert (reflected[~leaves] == 1).all()
        transmitted = T["weight"] * T["pdf"][:, None] * (T["eta"] ** 2)[:, None]
        np.testing.assert_allclose(reflected[leaves] + transmitted[leaves], 1, atol=1e-5)
