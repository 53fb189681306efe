"""The shaders' lobes in float64, from the papers: slopes, complex indices and plain quotients where GLSL has none.

Directions are (..., 3) in the local frame, z the normal; functions without a struct take arrays of one shape.

These are deliberately independent of viewer/measure/check/reference.py, which users run: neither imports the other, so
that a slip would have to be made twice to go unnoticed.
"""

from __future__ import annotations

import numpy as np
import thin_film
from microfacet_twins import (
    beta,
    dot,
    f82_tint,
    fresnel,
    ggx_albedo,
    ggx_d,
    ggx_lambda,
    ggx_reflection,
    hemispherical_mean,
    kulla_conty,
    schlick,
    unit,
)


def lambert(m, wo, wi):
    return m["albedo"] / np.pi


def burley(m, wo, wi):
    """Burley 2012, section 5.3."""
    cos_d = dot(wi, unit(wo + wi))
    f90 = 0.5 + 2 * m["perceptual_roughness"] * cos_d**2
    light, view = (1 + (f90 - 1) * (1 - w[..., 2]) ** 5 for w in (wi, wo))
    return m["albedo"] / np.pi * (light * view)[..., None]


def eon(m, wo, wi):
    """Portsmouth, Kutz & Hill 2024: single scattering of eq. 13 with its A, and the multiple one of eqs. 18 to 29."""
    sigma, rho = m["sigma"], m["albedo"]
    A = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * sigma)
    mu_i, mu_o = wi[..., 2], wo[..., 2]
    s = dot(wi, wo) - mu_i * mu_o
    s_over_t = np.where(s > 0, s / np.maximum(mu_i, mu_o), s)
    single = rho / np.pi * (A * (1 + sigma * s_over_t))[..., None]

    def E(mu):
        theta = np.arccos(mu)
        G = np.sin(theta) * (theta - np.sin(theta) * np.cos(theta))
        G += 2 / 3 * (np.tan(theta) * (1 - np.sin(theta) ** 3) - np.sin(theta))
        return A * (1 + sigma / np.pi * G)

    E_mean = A * (1 + (2 / 3 - 28 / (15 * np.pi)) * sigma)
    rho_ms = rho**2 * E_mean[..., None] / (1 - rho * (1 - E_mean)[..., None])
    with np.errstate(invalid="ignore"):
        multiple = rho_ms / np.pi * ((1 - E(mu_i)) * (1 - E(mu_o)) / (1 - E_mean))[..., None]
    return single + np.where(sigma[..., None] > 1e-4, multiple, 0)


def phong(m, wo, wi):
    """Lafortune & Willems 1994, eq. 8, about the mirrored wo."""
    c = dot(wi, wo * [-1, -1, 1])
    power = np.where(c > 0, np.maximum(c, 1e-300) ** m["shininess"], 0)
    return m["specular"] * ((m["shininess"] + 2) / (2 * np.pi) * power)[..., None]


def plain_phong(m, wo, wi):
    """Phong 1975: what is reflected, over the irradiance it came with."""
    return phong(m, wo, wi) * (2 * np.pi / (m["shininess"] + 2) / wi[..., 2])[..., None]


def blinn(m, wo, wi):
    c = unit(wo + wi)[..., 2]
    return m["specular"] * ((m["shininess"] + 8) / (8 * np.pi) * c ** m["shininess"])[..., None]


def normalized_blinn(m, wo, wi):
    """Giesen 2009."""
    s, c = m["shininess"], unit(wo + wi)[..., 2]
    return m["specular"] * ((s + 2) * (s + 4) / (8 * np.pi * (2 ** (-s / 2) + s)) * c**s)[..., None]


def ggx(m, wo, wi):
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    return dv[..., None] * schlick(m["f0"], m["f90"], VoH)


def turquin(m, wo, wi):
    """Turquin 2019, eq. 16, with E at F = 1; one isotropic alpha for all."""
    E = ggx_albedo(wo[..., 2], one_alpha(m))[..., None]
    return ggx(m, wo, wi) * (1 + m["f0"] * (1 - E) / E)


def fdez_aguera(m, wo, wi):
    """Fdez-Aguera 2019, eq. 18; one isotropic alpha for all."""
    alpha = one_alpha(m)
    E_white = ggx_albedo(wo[..., 2], alpha)[..., None]
    b = ggx_albedo(wo[..., 2], alpha, 0.0, 1.0)[..., None]
    single = m["f0"] * (E_white - b) + m["f90"] * b
    mean = m["f0"] + (m["f90"] - m["f0"]) / 21
    return ggx(m, wo, wi) + single * mean * (1 - E_white) / (1 - mean * (1 - E_white)) / np.pi


def metal(m, wo, wi):
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    mean = hemispherical_mean(lambda mu: f82_tint(m["f0"], m["tint"], mu))
    return dv[..., None] * f82_tint(m["f0"], m["tint"], VoH) + kulla_conty(one_alpha(m), mean, wo[..., 2], wi[..., 2])


def conductor(m, wo, wi):
    index = m["eta"] + 1j * m["k"]
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    mean = hemispherical_mean(lambda mu: fresnel(mu, index))
    return dv[..., None] * fresnel(VoH[..., None], index) + kulla_conty(one_alpha(m), mean, wo[..., 2], wi[..., 2])


def separable(alpha, wo, wi):
    """G1(o) G1(i), Heitz 2014, eq. 98."""
    return 1 / ((1 + ggx_lambda(wo, alpha)) * (1 + ggx_lambda(wi, alpha)))


def glass_reflection(alpha, wo, wi, is_separable):
    """D G2 / (4 NoV NoL) and VoH, under either masking."""
    dv, VoH = ggx_reflection(alpha, wo, wi)
    if is_separable:
        dv = ggx_d(unit(wo + wi), alpha) * separable(alpha, wo, wi) / (4 * wo[..., 2] * wi[..., 2])
    return dv, VoH


def dielectric(m, wo, wi, is_separable=False):
    """Walter et al. 2007, eqs. 20 and 21, light from wi (index eta) to wo (index 1), with Heitz 2016's masking."""
    eta, alpha = m["eta"], m["alpha"]
    reflected, VoH = glass_reflection(alpha, wo, wi, is_separable)
    reflected = reflected[..., None] * glass_fresnel(m, VoH)
    h = -unit(wo + eta[..., None] * wi)
    h = h * np.sign(h[..., 2:])
    o_h, i_h = dot(wo, h), dot(wi, h)
    g2 = separable(alpha, wo, wi) if is_separable else beta(1 + ggx_lambda(wo, alpha), 1 + ggx_lambda(wi, alpha))
    through = np.abs(i_h * o_h / (wi[..., 2] * wo[..., 2])) * g2 * ggx_d(h, alpha)
    through = np.where((o_h > 0) & (i_h < 0), through / (eta * i_h + o_h) ** 2, 0)
    return np.where(wi[..., 2:] > 0, reflected, through[..., None] * (1 - glass_fresnel(m, np.abs(o_h))))


def glass_fresnel(m, mu):
    """(..., 1), or of a film (..., 3): Fresnel's curve between f0 and f90 below a film, which light from inside meets
    at the angle that it has outside."""
    eta = m["eta"]
    R = fresnel(mu, eta)[..., None]
    if "film" not in m:
        return R
    eta_f0 = (((eta - 1) / (eta + 1)) ** 2)[..., None]
    F = m["f0"] + (m["f90"] - m["f0"]) * np.clip((R - eta_f0) / (1 - eta_f0), 0, 1)
    outside = np.sqrt(np.maximum(np.where(eta < 1, 1 - (1 - mu**2) / eta**2, mu**2), 0))
    ior = np.where(m["f0"].max(axis=-1) > 0.35, 0, np.maximum(eta, 1 / eta))
    film = thin_film.reflectance(F, outside, ior, m["film_ior"], m["film_thickness"])
    return np.where(R >= 1, 1, F + m["film"][..., None] * (film - F))


def thin_dielectric(m, wo, wi, is_separable=False):
    """KHR_materials_transmission's mirrored lobe, with what goes to and fro inside added up bounce by bounce."""
    dv, VoH = glass_reflection(m["alpha"], wo, wi * np.where(wi[..., 2:] < 0, [1, 1, -1], 1), is_separable)
    R = glass_fresnel(m, VoH)
    there, bounce = np.zeros_like(R), (1 - R) ** 2
    for _ in range(4000):
        there += bounce
        bounce *= R * R
    return dv[..., None] * np.where(wi[..., 2:] > 0, 1 - there, there)


def one_alpha(m) -> float:
    (alpha,) = np.unique(m["alpha"])
    return float(alpha)
