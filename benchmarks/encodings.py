"""How other engines encode their pictures of the scenarios, and ACES, the tone curve of these, both ways."""

from __future__ import annotations

import numpy as np

from viewer.scene.color import linear_to_srgb

Picture = tuple[np.ndarray, np.ndarray]
"""Colour over white, (H, W, 3), and alpha, (H, W), float32 in [0, 1]."""

POWER_CODED = ("blender-cycles", "vray", "stellar", "dspbr-pt", "babylon", "gltf-sample-viewer")
"""Engines whose pictures are encoded by pow(1 / 2.2)."""
ROUNDED_DOWN = ("blender-cycles", "vray", "stellar")
"""Engines whose codes are rounded down, so that they are half a code too dark on average."""

_TO_RRT = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_FROM_ODT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
"""ACES, as shaders/display/tonemap.glsl has it."""


def coded_as(picture: Picture, engine: str) -> Picture:
    """An sRGB picture, encoded as `engine` does. Where it is not opaque, which is not scored, it is not exact."""
    rgb, alpha = picture
    if engine in POWER_CODED:
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        rgb = np.clip(linear, 0, 1) ** (1 / 2.2)
    if engine in ROUNDED_DOWN:
        rgb = np.maximum(rgb - 0.5 / 255, 0)
    return rgb.astype(np.float32), alpha


def srgb_coded(picture: Picture, engine: str) -> Picture:
    """The inverse of `coded_as`."""
    rgb, alpha = picture
    if engine in ROUNDED_DOWN:
        rgb = rgb + 0.5 / 255
    if engine in POWER_CODED:
        linear = np.clip(rgb, 0, 1) ** 2.2
        rgb = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.clip(rgb, 0, 1).astype(np.float32), alpha


def shown(light: np.ndarray, alpha: np.ndarray) -> Picture:
    """Linear light, (H, W, 3), not associated with its alpha, (H, W): by ACES, as sRGB, over white."""
    x = np.maximum(light, 0) / 0.6 @ _TO_RRT.T
    y = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081)
    rgb = linear_to_srgb(np.clip(y @ _FROM_ODT.T, 0, 1)) * alpha[..., None] + (1 - alpha[..., None])
    return rgb.astype(np.float32), alpha.astype(np.float32)


def radiance(picture: Picture) -> np.ndarray:
    """Linear light before the tone curve of the scenarios, (H, W, 3), of an sRGB picture: the inverse of ACES."""
    rgb = picture[0].astype(np.float64)
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    y = np.clip(linear @ np.linalg.inv(_FROM_ODT).T, 1e-5, 0.98)
    a, b, c = 1 - 0.983729 * y, 0.0245786 - 0.4329510 * y, -0.000090537 - 0.238081 * y
    return (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a) @ np.linalg.inv(_TO_RRT).T * 0.6
