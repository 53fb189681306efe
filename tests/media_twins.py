"""What shaders/media should give, in float64 from the papers."""

from __future__ import annotations

import numpy as np


def henyey_greenstein(g, one_minus_mu):
    """Henyey & Greenstein 1941, by 1 - mu so that small angles keep their digits; normalised over the sphere."""
    return (1 - g**2) / (4 * np.pi * ((1 - g) ** 2 + 2 * g * one_minus_mu) ** 1.5)


def henyey_greenstein_one_minus_mu(g, u):
    """1 - mu at which the distribution function, from -1, is u (Witt 1977, in long double, and the limit at g = 0)."""
    g, u = np.longdouble(g), np.longdouble(u)
    with np.errstate(divide="ignore", invalid="ignore"):
        witt = 1 - (1 + g**2 - ((1 - g**2) / (1 - g + 2 * g * u)) ** 2) / (2 * g)
    near_0 = 2 - 2 * u - 2 * g * u * (1 - u)  # up to terms in g^2
    return np.where(np.abs(g) < 1e-5, near_0, witt).astype(float)


def droplets(d):
    """g of the Henyey-Greenstein lobe; g, alpha and share of Draine's (Jendersie & d'Eon 2023, for 5 < d < 50 um)."""
    return (np.exp(-0.0990567 / (d - 1.67154)), np.exp(-2.20679 / (d + 3.91029) - 0.428934),
            np.exp(3.62489 - 8.29288 / (d + 5.52825)), np.exp(-0.599085 / (d - 0.641583) - 0.665888))


def draine(g, a, one_minus_mu):
    """Draine 2003, eq. 4."""
    factor = (1 + a * (1 - one_minus_mu) ** 2) / (1 + a * (1 + 2 * g**2) / 3)
    return henyey_greenstein(g, one_minus_mu) * factor


def droplet_phase(d, one_minus_mu):
    g, g_wide, a, share = droplets(d)
    return (1 - share) * henyey_greenstein(g, one_minus_mu) + share * draine(g_wide, a, one_minus_mu)


def equiangular(closest, start, limit, u):
    """Distance along the ray and its density (Kulla & Fajardo 2012, section 5.1), in long double."""
    closest, start, limit, u = (np.longdouble(v) for v in (closest, start, limit, u))
    a, b = np.arctan(start / closest), np.arctan((start + limit) / closest)
    t = closest * np.tan((1 - u) * a + u * b)
    return (t - start).astype(float), (closest / ((b - a) * (closest**2 + t**2))).astype(float)
