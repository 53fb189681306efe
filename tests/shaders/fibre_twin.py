"""What shaders/bsdf/fibre should give, in float64 from the papers: d'Eon et al. 2011 and Chiang et al. 2016."""

from __future__ import annotations

import numpy as np


def log_bessel_i0(x):
    """log I0(x), x >= 0; beyond 500 by Hankel's series (Abramowitz & Stegun 1964, 9.7.1), good to 1e-13 there."""
    series = 1 + sum(np.prod([(2 * j - 1) ** 2 for j in range(1, k + 1)]) / (np.prod(range(1, k + 1), initial=1.0)
                     * (8 * np.maximum(x, 1)) ** k) for k in range(1, 5))
    far = x - 0.5 * np.log(2 * np.pi * np.maximum(x, 1)) + np.log(series)
    return np.where(x > 500, far, np.log(np.i0(np.minimum(x, 500))))


def variances(beta_m):
    """v of each lobe, Chiang et al., eq. 7 and section 4.1, (4, ...)."""
    v = (0.726 * beta_m + 0.812 * beta_m**2 + 3.7 * beta_m**20) ** 2
    return np.stack([v, v / 4, 4 * v, 4 * v])


def scale(beta_n):
    """Chiang et al., eq. 8, as the scale of a logistic distribution."""
    return np.sqrt(np.pi / 8) * (0.265 * beta_n + 1.194 * beta_n**2 + 5.372 * beta_n**22)


def longitudinal(theta_i, mean, v):
    """M about `mean`, the theta_i of its peak: d'Eon et al., eq. 7, with csch(1 / v) = 2 e^(-1/v) / (1 - e^(-2/v))."""
    a, b = np.cos(theta_i) * np.cos(mean) / v, np.sin(theta_i) * np.sin(mean) / v
    return np.exp(log_bessel_i0(a) + b - 1 / v) / (v * -np.expm1(-2 / v))


def azimuthal(x, s):
    """N: the logistic density over its share between -pi and pi."""
    def cdf(y):
        return np.where(y > 0, 1, np.exp(-np.abs(y) / s)) / (1 + np.exp(-np.abs(y) / s))

    x = np.abs((x + np.pi) % (2 * np.pi) - np.pi)
    e = np.exp(-x / s)
    return e / (s * (1 + e) ** 2) / (cdf(np.pi) - cdf(-np.pi))


def fresnel(mu, eta):
    """Fresnel's equations for unpolarised light."""
    inside = np.sqrt(1 - (1 - mu**2) / eta**2)
    s, p = (mu - eta * inside) / (mu + eta * inside), (eta * mu - inside) / (eta * mu + inside)
    return (s**2 + p**2) / 2


def angles(w):
    """theta from the normal plane and phi in it."""
    return np.arctan2(w[..., 0], np.hypot(w[..., 1], w[..., 2])), np.arctan2(w[..., 2], w[..., 1])


def attenuation(m, h, theta_o):
    """A of each lobe, (4, ..., 3); and gamma_t."""
    inner = np.sqrt(m["eta"] ** 2 - np.sin(theta_o) ** 2)
    gamma_t = np.arcsin(h * np.cos(theta_o) / inner)
    cos_theta_t = np.sqrt(1 - (np.sin(theta_o) / m["eta"]) ** 2)
    T = np.exp(-m["sigma_a"] * (2 * np.cos(gamma_t) / cos_theta_t)[..., None])
    F = fresnel(np.cos(theta_o) * np.sqrt(1 - h**2), m["eta"])[..., None]
    A = [F + 0 * T, (1 - F) ** 2 * T]
    A.append(A[1] * F * T)
    A.append(A[2] * F * T / (1 - F * T))
    return np.stack(A), gamma_t


def densities(m, h, wo, wi):
    """M N of each lobe, (4, ...)."""
    (theta_o, phi_o), (theta_i, phi_i) = angles(wo), angles(wi)
    gamma_t = attenuation(m, h, theta_o)[1]
    v, found = variances(m["beta_m"]), []
    for p, tilt in enumerate((-2, 1, 4, 0)):
        mean = -(theta_o + tilt * m["tilt"])  # beyond a right angle on the other side
        mean = np.arctan2(np.sin(mean), np.abs(np.cos(mean)))
        around = 1 / (2 * np.pi)
        if p < 3:
            turn = 2 * p * gamma_t - 2 * np.arcsin(h) + p * np.pi
            around = azimuthal(phi_i - phi_o - turn, scale(m["beta_n"]))
        found.append(longitudinal(theta_i, mean, v[p]) * around)
    return np.stack(found)


def evaluate(m, h, wo, wi):
    """f |cos theta_i|, (..., 3): the sum of M A N over the lobes."""
    A = attenuation(m, h, angles(wo)[0])[0]
    return (A * densities(m, h, wo, wi)[..., None]).sum(axis=0)


def albedo(m, h, wo):
    return attenuation(m, h, angles(wo)[0])[0].sum(axis=0)
