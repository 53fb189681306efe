"""An environment boiled down to what Phong's model knows: one directional light and an ambient term."""

from __future__ import annotations

import numpy as np

from ..scene.light import Light

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def ambient_and_key(coefficients: np.ndarray) -> tuple[np.ndarray, Light]:
    """The ambient irradiance, (3,), and the key light that share the first two bands of an irradiance.

    `coefficients` (18, 3) are those of `irradiance_coefficients`. A directional light of E lux makes E/4 + E/2 n.d plus
    higher bands (Ramamoorthi & Hanrahan 2001), so d points along the luminance of the linear band, E follows from it,
    and what the mean has beyond E/4 is ambient.
    """
    sh = np.asarray(coefficients, np.float64)
    mean = sh[0] + sh[2] / 3 + sh[3] / 5  # of 1, y^2 and y^4 over the sphere; the other terms have none
    linear = sh[[4, 1, 7]]  # x, y, z
    towards = linear @ _LUMINANCE
    length = float(np.linalg.norm(towards))
    towards = towards / length if length > 0 else np.array([0.0, 1.0, 0.0])
    key = np.clip(2 * towards @ linear, 0, 4 * np.maximum(mean, 0))
    peak = float(key.max())
    color = tuple((key / peak).tolist()) if peak > 0 else (1.0, 1.0, 1.0)
    light = Light("directional", color, peak, direction=tuple((-towards).tolist()), name="environment")
    return np.maximum(mean - key / 4, 0), light
