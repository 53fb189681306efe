"""A scale of colours for maps of errors."""

from __future__ import annotations

import numpy as np

# Magma as a polynomial of degree 6 (Zucker 2019, public domain); within 0.022 of the table.
_MAGMA = np.array([
    [-0.0021364, -0.0007496, -0.0053861], [0.2516605, 0.6775232, 2.4940266], [8.3537173, -3.5777195, 0.3144679],
    [-27.6687331, 14.2647308, -13.6492132], [52.1761398, -27.9436061, 12.9441694],
    [-50.7685254, 29.0465828, 4.234153], [18.6557051, -11.4897735, -5.6019615]])


def magma(values: np.ndarray) -> np.ndarray:
    """(H, W) in [0, 1] as colours, (H, W, 3) uint8: black, purple, orange, pale yellow."""
    colors = np.polynomial.polynomial.polyval(values, _MAGMA).transpose(1, 2, 0)
    return (np.clip(colors, 0, 1) * 255 + 0.5).astype(np.uint8)
