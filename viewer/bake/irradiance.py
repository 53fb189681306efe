"""Irradiance over all normals as a polynomial in the normal (Ramamoorthi and Hanrahan 2001).

The cosine's spectrum is A = pi, 2 pi/3, pi/4, 0, -pi/24: degree 3 vanishes, so degrees 0, 1, 2 and 4 make 18 terms. Two
degrees (9 terms) would miss by up to 27 % in a room lit by soft boxes, four by 13 %; both are exact on average.
"""

from __future__ import annotations

from math import factorial

import numpy as np

COEFFICIENTS = 18
_COSINE = {0: np.pi, 1: 2 * np.pi / 3, 2: np.pi / 4, 4: -np.pi / 24}

# P_lm(cos theta) / sin^m(theta), without its normalisation, as (power of y, factor), keyed by (l, m).
_POLYNOMIALS = {
    (0, 0): ((0, 1.0),),
    (1, 0): ((1, 1.0),),
    (2, 0): ((2, 1.5), (0, -0.5)),
    (4, 0): ((4, 35 / 8), (2, -30 / 8), (0, 3 / 8)),
    (1, 1): ((0, 1.0),),
    (2, 1): ((1, 3.0),),
    (4, 1): ((3, 17.5), (1, -7.5)),
    (2, 2): ((0, 3.0),),
    (4, 2): ((2, 52.5), (0, -7.5)),
    (4, 3): ((1, 105.0),),
    (4, 4): ((0, 105.0),),
}
# Where the term y^power Re/Im (x + iz)^m stands among the coefficients: (real, imaginary); see irradiance_sh.glsl.
_PLACES = {
    (0, 0): (0, None), (0, 1): (1, None), (0, 2): (2, None), (0, 4): (3, None),
    (1, 0): (4, 7), (1, 1): (5, 8), (1, 3): (6, 9),
    (2, 0): (10, 12), (2, 2): (11, 13),
    (3, 1): (14, 15),
    (4, 0): (16, 17),
}  # fmt: skip


def irradiance_coefficients(harmonics: np.ndarray) -> np.ndarray:
    """The polynomial's coefficients, (18, 3) float32, from a map's harmonics a_lm (5, 5, 3), as `convolve` gives them.

    E(n) = sum_lm A_l (2 - [m = 0]) Re(a_lm P_lm(n.y) e^(i m phi)) / sqrt(2 pi), with e^(i m phi) sin^m = (x + i z)^m.
    """
    out = np.zeros((COEFFICIENTS, 3))
    for (l, m), polynomial in _POLYNOMIALS.items():
        norm = np.sqrt((2 * l + 1) / 2 * factorial(l - m) / factorial(l + m))
        scale = _COSINE[l] * norm * (1 if m == 0 else 2) / np.sqrt(2 * np.pi)
        for power, factor in polynomial:
            real, imaginary = _PLACES[m, power]
            out[real] += scale * factor * harmonics[l, m].real
            if imaginary is not None:
                out[imaginary] -= scale * factor * harmonics[l, m].imag
    return out.astype(np.float32)


def irradiance(normals: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Irradiance for unit normals (..., 3), as the shader evaluates it, (..., 3); not below 0."""
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    powers = [(x + 1j * z) ** m for m in range(5)]
    out = np.zeros(normals.shape)
    for (m, power), (real, imaginary) in _PLACES.items():
        term = y**power * powers[m]
        out += term.real[..., None] * coefficients[real]
        if imaginary is not None:
            out += term.imag[..., None] * coefficients[imaginary]
    return np.maximum(out, 0)
