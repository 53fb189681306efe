"""The BSDF `standard`, which composes all layers, in float64, as twins.py has the lobes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import thin_film
from microfacet_twins import (
    compensation,
    ggx_albedo,
    ggx_mean_albedo,
    ggx_reflection,
    hemispherical_mean,
    kulla_conty,
    schlick,
    stretched_albedo,
    stretched_mean_albedo,
    visible_normals,
)
from sheen_twins import charlie_albedos, charlie_lobe, zeltner_albedo, zeltner_lobe
from twins import eon, one_alpha


def standard(m, wo, wi):
    """glTF 2.0, appendix B, compensated by Kulla & Conty 2017, its base by Kelemen & Szirmay-Kalos 2001; one alpha."""
    return _layers(m, np.stack([m["alpha"]] * 2, axis=-1), one_alpha(m), wo, wi)


def standard_anisotropic(m, wo, wi):
    """The same with facets stretched along x, whose albedo depends on the azimuth."""
    (alpha_t,) = np.unique(m["alpha_t"])
    alphas = np.stack([m["alpha_t"], m["alpha"]], axis=-1)
    return _layers(m, alphas, (float(alpha_t), one_alpha(m)), wo, wi)


def standard_rough(m, wo, wi):
    """The base is EON, and gets back what the interface changes of its albedo: its dimming of light at grazing angles,
    x ((1 - mu)^5 - 1/21), integrated over EON, for both directions."""
    alpha = one_alpha(m)
    mean_b = ggx_mean_albedo(alpha, 0.0, 1.0)
    F_mean, E_mean, f0 = m["f0"] + (1 - m["f0"]) / 21, ggx_mean_albedo(alpha), m["f0"]
    multiple = F_mean**2 * E_mean / (1 - F_mean * (1 - E_mean)) * (1 - E_mean)
    through = 1 - (f0 * (E_mean - mean_b) + mean_b + multiple).max(axis=-1)
    x = 21 * mean_b * (1 - f0.max(axis=-1)) / np.maximum(through, 1e-3) * (1 + 42 * mean_b) / 3
    sigma = m["diffuse_roughness"]
    A = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * sigma)
    q = np.interp(wo[..., 2], *_dimming()) + np.interp(wi[..., 2], *_dimming())
    base = eon({"sigma": sigma, "albedo": m["base_color"]}, wo, wi)
    base = base + m["base_color"] / np.pi * (x * sigma * A * q)[..., None]
    return _layers(m, np.stack([m["alpha"]] * 2, axis=-1), alpha, wo, wi, base)


def standard_translucent(m, wo, wi):
    """KHR_materials_diffuse_transmission: mix(diffuse_brdf(base colour), diffuse_btdf(colour), factor) under the
    interface, which dims what comes from below as it does what comes from above."""
    return _translucent(m, wo, wi, m["base_color"])


def standard_scattering(m, wo, wi):
    """KHR_materials_scatter of a thin wall: what it scatters back has the colour of what goes through."""
    back = m["scattered_back"][..., None]
    return _translucent(m, wo, wi, (1 - back) * m["base_color"] + back * m["diffuse_transmission_color"])


def _translucent(m, wo, wi, above_color):
    alpha, t = one_alpha(m), m["diffuse_transmission"][..., None]
    alphas, up = np.stack([m["alpha"]] * 2, axis=-1), wi * np.where(wi[..., 2:] < 0, [1, 1, -1], 1)
    above = _layers(m, alphas, alpha, wo, up, (1 - t) * above_color / np.pi)
    bare, lit = (_layers(m, alphas, alpha, wo, up, base + 0 * above) for base in (
        0, t * m["diffuse_transmission_color"] / np.pi))
    return np.where(wi[..., 2:] < 0, lit - bare, above)


@lru_cache(maxsize=1)
def _dimming():
    """Cosines of wo, and int ((1 - mu)^5 - 1/21) f mu dwi / A of white EON with sigma = 1, on a grid of wi."""
    x, weight = np.polynomial.legendre.leggauss(48)
    mu, phi = (x + 1) / 2, (np.arange(128) + 0.5) / 128 * 2 * np.pi
    s = np.sqrt(1 - mu**2)[:, None]
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), mu[:, None] + 0 * phi], axis=-1)
    white = {"sigma": np.ones(1), "albedo": np.ones(3)}
    weights = (weight / 2 * mu * ((1 - mu) ** 5 - 1 / 21))[:, None] * 2 * np.pi / 128
    cosines = np.linspace(0.01, 1, 100)
    found = [(eon(white, np.array([np.sqrt(1 - c * c), 0, c]), wi)[..., 0] * weights).sum() for c in cosines]
    return cosines, np.array(found) * (1 + 0.5 - 2 / (3 * np.pi))


def standard_zeltner_sheen(m, wo, wi):
    (r,) = np.unique(m["sheen_roughness"])
    return _fibres_over(m, wo, wi, zeltner_lobe(wo, wi, r), lambda mu: zeltner_albedo(mu, r))


def standard_sheen(m, wo, wi):
    (r,) = np.unique(m["sheen_roughness"])
    return _fibres_over(m, wo, wi, charlie_lobe(wo, wi, r), lambda mu: np.interp(mu, *charlie_albedos(float(r))))


def _fibres_over(m, wo, wi, lobe, albedo):
    """Fibres over all. The diffuse base is dimmed for both directions, over the mean of what reaches it."""
    largest, (x, weight) = m["sheen_color"].max(axis=-1), np.polynomial.legendre.leggauss(24)

    def through(mu):
        return 1 - largest * albedo(mu)

    def interface(mu):  # what the interface lets through, of its brightest channel
        alpha, f90 = one_alpha(m), m["f90"][..., None]
        white, grazing, E_mean = ggx_albedo(mu, alpha), ggx_albedo(mu, alpha, 0.0, 1.0), ggx_mean_albedo(alpha)
        mean = m["f0"] + (f90 - m["f0"]) / 21
        multiple = mean**2 * E_mean / (1 - mean * (1 - E_mean)) * (1 - white)
        return 1 - (m["f0"] * (white - grazing) + f90 * grazing + multiple).max(axis=-1)

    nodes = [(w * t, through(t), interface(t)) for t, w in zip((x + 1) / 2, weight)]
    passed = sum(w * F for w, _, F in nodes)  # to the base, none in a perfect mirror
    mean = np.where(passed > 1e-6, sum(w * T * F for w, T, F in nodes) / np.maximum(passed, 1e-6), 1)
    black = {**m, "base_color": np.where(m["metallic"][..., None] < 1, 0 * m["base_color"], m["base_color"])}
    metal = (m["metallic"][..., None] > 0) * m["metallic"][..., None]
    whole, below = standard(m, wo, wi), standard({**black, "metallic": 0 * m["metallic"]}, wo, wi)
    pure = standard({**m, "metallic": 1 + 0 * m["metallic"]}, wo, wi)
    diffuse = whole - metal * pure - (1 - metal) * below
    o, i = through(wo[..., 2])[..., None], (through(wi[..., 2]) / mean)[..., None]
    return m["sheen_color"] * lobe[..., None] + o * (metal * pure + (1 - metal) * below + diffuse * i)


def standard_iridescent(m, wo, wi):
    """KHR_materials_iridescence: a film over dielectric and metal, whose colour is missing in what enters below. Only
    what the viewer sees of the base is dimmed by it."""
    alpha = one_alpha(m)
    alphas = np.stack([m["alpha"]] * 2, axis=-1)
    return _layers(m, alphas, alpha, wo, wi, film=lambda F, mu, ior: film_over(m, F, mu, ior))


def film_over(m, F, mu, ior):
    """F (N, ..., 3) of N surfaces below their films, for cosines (N, ...). `ior` is 0 for metal."""
    ior, film_ior, thickness, walls, weight = (np.asarray(value)[(..., *[None] * (np.ndim(mu) - 1))] for value in (
        ior, m["film_ior"], m["film_thickness"], m["film_walls"], m["film"]))
    walls, weight = walls[..., None], weight[..., None]
    one = F / (1 + walls * (1 - F))
    film = thin_film.reflectance(one, mu, ior, film_ior, thickness)
    return F + weight * (film * (1 + walls) / (1 + walls * film) - F)


def standard_coated(m, wo, wi):
    """KHR_materials_clearcoat: an interface of index 1.5 over all, which lets 1 less its directional albedo through."""
    base, (coat_alpha,) = standard(m, wo, wi), np.unique(m["coat_alpha"])
    weight, coat_alpha = m["coat"][..., None], float(coat_alpha)
    dv, VoH = ggx_reflection(np.full((*wo.shape[:-1], 2), coat_alpha), wo, wi)
    mean = weight * (0.04 + 0.96 / 21)
    coat = schlick(0.04 * weight, weight, VoH) * dv[..., None]
    coat = coat + kulla_conty(coat_alpha, mean, wo[..., 2], wi[..., 2])
    E = ggx_albedo(wo[..., 2], coat_alpha)[..., None]
    E_mean = ggx_mean_albedo(coat_alpha)
    multiple = mean**2 * E_mean / (1 - mean * (1 - E_mean)) * (1 - E)
    return coat + (1 - weight * ggx_albedo(wo[..., 2], coat_alpha, 0.04, 1.0)[..., None] - multiple) * base


def _layers(m, alphas, alpha, wo, wi, base=None, film=None):
    """`alphas` are those of D V, (..., 2); `alpha` that of the albedo, for all, or both; `base` that is not Lambert's;
    `film` as `film_over`."""
    dv, VoH = ggx_reflection(alphas, wo, wi)
    f0, f90, NoV = m["f0"], m["f90"][..., None], wo[..., 2]
    mean_albedo = stretched_mean_albedo if isinstance(alpha, tuple) else ggx_mean_albedo
    E_mean = mean_albedo(alpha)

    def albedo(w, *f):
        return stretched_albedo(w, alpha, *f) if isinstance(alpha, tuple) else ggx_albedo(w[..., 2], alpha, *f)

    E_o, E_i = albedo(wo), albedo(wi)

    def multiple(mean):
        return mean**2 * E_mean / (1 - mean * (1 - E_mean))

    def interface(f0, f90, ior):
        F, mean = schlick(f0, f90, VoH), f0 + (f90 - f0) / 21
        if film:
            F, mean = film(F, VoH, ior), hemispherical_mean(
                lambda mu: film(schlick(f0, f90, mu * np.ones(len(f0))), mu * np.ones(len(f0)), ior), 16)
        return F * dv[..., None] + compensation(mean, E_mean, E_o, E_i), mean

    def through(white, grazing):
        """1 less all that is reflected, of the brightest channel; `white` at F = 1, `grazing` at f0 = 0, f90 = 1."""
        white, grazing = np.asarray(white)[..., None], np.asarray(grazing)[..., None]
        lost = multiple(f0 + (f90 - f0) / 21) * (1 - white)
        return 1 - (f0 * (white - grazing) + f90 * grazing + lost).max(axis=-1, keepdims=True)

    o, i = (through(E, albedo(w, 0.0, 1.0)) for E, w in ((E_o, wo), (E_i, wi)))
    mean = through(E_mean, mean_albedo(alpha, 0.0, 1.0))
    base = m["base_color"] / np.pi if base is None else base
    ior = np.where(f0.max(axis=-1) > 0.35, 0, m["ior"])
    dielectric_, mean_film = interface(f0, f90, ior)
    if film:
        grid = np.linspace(0.002, 1, 150)
        bare = schlick(f0[:, None], f90[:, None], np.tile(grid, (len(f0), 1)))
        curves = film(bare, np.tile(grid, (len(f0), 1)), ior) - bare
        seen = [visible_normals(float(mu), alpha) for mu in NoV]
        added = [[(share * np.interp(VoH, grid, curve)).sum() for curve in curves_.T]
                 for (VoH, share), curves_ in zip(seen, curves)]
        ms = (multiple(mean_film) - multiple(f0 + (f90 - f0) / 21)) * (1 - ggx_albedo(NoV, alpha))[..., None]
        o = np.maximum(o - added - ms, 0)
    dielectric_ = dielectric_ + o * i / np.maximum(mean, 1e-4) * base
    return dielectric_ + m["metallic"][..., None] * (interface(m["base_color"], 1.0, 0 * ior)[0] - dielectric_)
