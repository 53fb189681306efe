"""The reflectance of a thin film in float64: Airy's sum for both polarisations, integrated over wavelengths.

The observer is CIE 1931's by the fits of Wyman, Sloan & Shirley 2013, "Simple Analytic Approximations to the CIE XYZ
Color Matching Functions", which are within 0.03 of the tables, and the light has the spectrum of equal energy. Each
channel of linear Rec. 709 is divided by its own integral, so that a constant reflectance gives its own value. An
interface below has, for each channel, that channel's reflectance at all wavelengths.
"""

from __future__ import annotations

import numpy as np

WAVELENGTHS = np.arange(380.0, 781.0, 2.0)
"""In nm. Between two of them a film of 3 micrometres turns the phase by a tenth of a turn."""
_TO_REC709 = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                       [0.0556434, -0.2040259, 1.0572252]])


def _lobe(wavelengths, height, center, below, above):
    t = (wavelengths - center) * np.where(wavelengths < center, below, above)
    return height * np.exp(-t * t / 2)


def color_matching(wavelengths):
    """The functions x, y and z, (3, N)."""
    return np.stack([sum(_lobe(wavelengths, *lobe) for lobe in lobes) for lobes in (
        [(1.056, 599.8, 0.0264, 0.0323), (0.362, 442.0, 0.0624, 0.0374), (-0.065, 501.1, 0.0490, 0.0382)],
        [(0.821, 568.8, 0.0213, 0.0247), (0.286, 530.9, 0.0613, 0.0322)],
        [(1.217, 437.0, 0.0845, 0.0278), (0.681, 459.0, 0.0385, 0.0725)])])


def weights(wavelengths=WAVELENGTHS):
    """Of each wavelength in red, green and blue, (3, N), each row with the sum 1."""
    rgb = _TO_REC709 @ color_matching(wavelengths)
    return rgb / rgb.sum(axis=1, keepdims=True)


def amplitudes(mu, index):
    """r_s and r_p from the index 1 to `index`; both are negative for a denser medium at normal incidence."""
    inner = np.sqrt(np.maximum(1 - (1 - mu**2) / index**2, 0))
    with np.errstate(invalid="ignore"):
        s, p = (mu - index * inner) / (mu + index * inner), (inner - index * mu) / (inner + index * mu)
    return np.nan_to_num(s), np.nan_to_num(p)  # nothing is reflected where the indices are equal


def base_amplitudes(F, mu, ior):
    """r_s and r_p, (..., 3), of the reflectance F (..., 3): in the ratio that they have for the index `ior`, as far as
    none exceeds 1, or for `ior` 0 both alike."""
    s, p = amplitudes(mu, np.maximum(ior, 1 + 1e-9))
    exact = np.maximum((s**2 + p**2) / 2, 1e-300)
    apart = np.where(ior >= 1, (s**2 - p**2) / 2 / exact, 0)[..., None]
    apart = np.minimum(F * apart, 1 - F)
    side = np.where((ior >= 1) & (p > 0), -1, 1)[..., None]
    return -np.sqrt(np.clip(F + apart, 0, 1)), -side * np.sqrt(np.clip(F - apart, 0, 1))


def reflectance(F, mu, ior, film_ior, thickness, wavelengths=WAVELENGTHS, is_clamped=True):
    """(..., 3) of a film over an interface that reflects F (..., 3) without it; all others are (...)."""
    F, mu, ior, film_ior, thickness = np.broadcast_arrays(
        F, *(np.asarray(value, float)[..., None] for value in (mu, ior, film_ior, thickness)))
    shape, F = F.shape, F.reshape(-1, 3)
    mu, ior, film_ior, thickness = (value[..., 0].reshape(-1) for value in (mu, ior, film_ior, thickness))
    weight = weights(wavelengths)
    out = np.empty(F.shape)
    for first in range(0, len(F), 4096):
        k = slice(first, first + 4096)
        opd = 2 * thickness[k] * np.sqrt(film_ior[k] ** 2 - 1 + mu[k] ** 2)
        turn = np.exp(2j * np.pi * opd[:, None] / wavelengths)
        total = 0.0
        for r12, r13 in zip(amplitudes(mu[k], film_ior[k]), base_amplitudes(F[k], mu[k], ior[k])):
            r12 = r12[:, None]
            with np.errstate(invalid="ignore", divide="ignore"):
                r23 = (r13 - r12) / (1 - r12 * r13)  # so that without a film r13 is left
                r23 = np.clip(np.nan_to_num(r23), -1 + 1e-12, 1 - 1e-12)
                for c in range(3):
                    there = r23[:, c:c + 1] * turn
                    sums = np.abs((r12 + there) / (1 + r12 * there)) ** 2 @ weight[c]
                    total = total + np.where(np.arange(3) == c, sums[:, None], 0)
        out[k] = total / 2
    return np.clip(out, 0, 1).reshape(shape) if is_clamped else out.reshape(shape)


def airy(mu, ior, film_ior, thickness, wavelengths=WAVELENGTHS):
    """(..., 3) of a film over a dielectric of the index `ior`, by Fresnel's amplitudes of both faces, which need no
    bare interface. All are (...). Born & Wolf 1999, section 7.6."""
    c1 = np.asarray(mu, float)[..., None]
    ior, film_ior, thickness = (np.asarray(value, float)[..., None] for value in (ior, film_ior, thickness))
    c2, c3 = (np.sqrt(1 - (1 - c1**2) / n**2) for n in (film_ior, ior))
    turn = np.exp(4j * np.pi * film_ior * thickness * c2 / wavelengths)
    R = 0.0
    for upper, lower in (((c1, film_ior * c2), (film_ior * c2, ior * c3)),
                         ((film_ior * c1, c2), (ior * c2, film_ior * c3))):
        r12, r23 = ((a - b) / (a + b) for a, b in (upper, lower))
        R = R + np.abs((r12 + r23 * turn) / (1 + r12 * r23 * turn)) ** 2 / 2
    return R @ weights(wavelengths).T
