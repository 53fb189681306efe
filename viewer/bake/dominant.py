"""Reduces an environment to what Phong's model uses: one directional light and an ambient term."""

from __future__ import annotations

import numpy as np

from ..scene.color import LUMINANCE
from ..scene.light import Light
from .prefilter import row_angles


def ambient_and_key(irradiance: np.ndarray) -> tuple[np.ndarray, Light]:
    """The ambient irradiance, (3,), and a directional light that together have the same first two bands of spherical
    harmonics as `irradiance`.

    `irradiance` is the map of irradiance / pi from `prefilter`. A directional light of E lux from direction d has the
    irradiance E/4 + E/2 n.d plus higher bands (Ramamoorthi & Hanrahan 2001). So d is the direction of the luminance of
    the linear band, and E follows from its length. The rest of the mean, beyond E/4, is ambient.
    """
    height, width = irradiance.shape[:2]
    theta, phi = row_angles(height), 2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    inside = (theta >= 0) & (theta <= np.pi)
    sine, cosine = np.sin(theta[inside]), np.cos(theta[inside])
    rows = np.pi * irradiance[inside].astype(np.float64)
    weights = sine / sine.sum()  # of the rows, in solid angle
    mean = weights @ rows.mean(axis=1)
    # E(n) = mean + g.n + higher bands, so the average of E n over the sphere is g / 3.
    x = (weights * sine) @ (rows * np.cos(phi)[:, None]).mean(axis=1)
    y = (weights * cosine) @ rows.mean(axis=1)
    z = (weights * sine) @ (rows * np.sin(phi)[:, None]).mean(axis=1)
    linear = 3 * np.stack([x, y, z])
    towards = linear @ LUMINANCE
    length = float(np.linalg.norm(towards))
    towards = towards / length if length > 0 else np.array([0.0, 1.0, 0.0])
    key = np.clip(2 * towards @ linear, 0, 4 * np.maximum(mean, 0))
    peak = float(key.max())
    color = tuple((key / peak).tolist()) if peak > 0 else (1.0, 1.0, 1.0)
    away = tuple((-towards).tolist())
    light = Light("directional", color, peak, direction=away, casts_shadow=False, name="environment")
    return np.maximum(mean - key / 4, 0), light


def mean_of(irradiance: np.ndarray) -> np.ndarray:
    """The mean (3,) over all directions of such a map, which is that of the environment's radiance, too."""
    weights = np.maximum(np.sin(row_angles(len(irradiance))), 0)  # the map has margins beyond the poles
    return weights @ irradiance.mean(axis=1, dtype=np.float64) / weights.sum()
