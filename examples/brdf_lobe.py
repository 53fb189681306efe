"""Plots the lobe of a rough dielectric by calling the GLSL functions of the renderers on arrays.

    python examples/brdf_lobe.py [OUT]

Each of three polar diagrams, smooth to rough, shows how much light a surface reflects to a viewer at 50 degrees on the
left, by the direction that the light comes from. The rougher the surface, the farther the peak lies beyond the mirror
direction.
"""

from __future__ import annotations

import sys

import numpy as np

import viewer

VIEW = np.radians(50)
ALPHA = np.array([0.1, 0.3, 0.6])


def lobe(theta: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """f cos(theta) = D V F cos(theta) in the plane of incidence, `theta` from the normal, the mirror's at +VIEW."""
    half, mu = (theta - VIEW) / 2, np.cos((theta + VIEW) / 2)  # angle from normal to h, cosine from h to the view
    d = viewer.call_glsl("bsdf/ggx.glsl", "d_ggx", NoH=np.cos(half), s2=np.sin(half) ** 2, alpha=alpha)
    v = viewer.call_glsl("bsdf/ggx.glsl", "v_smith_ggx", NoV=np.cos(VIEW), NoL=np.cos(theta), alpha=alpha)
    f = viewer.call_glsl("bsdf/fresnel.glsl", "f_dielectric", mu=mu, eta=1.5)
    return d * v * f * np.cos(theta)


def main(out: str = "lobe.png", *, height: int = 240) -> None:
    theta = np.radians(np.arange(-90, 90, 0.1))
    curves = lobe(theta, ALPHA[:, None])
    for alpha, curve in zip(ALPHA, curves, strict=True):
        print(f"alpha {alpha}: peak {curve.max():.3f} at {np.degrees(theta[curve.argmax()]):.1f} degrees")
    y, x = np.mgrid[1:0:height * 1j, -1:1:2 * height * 1j]
    is_inside = np.hypot(x, y) * curves.max(axis=1)[:, None, None] < lobe(np.arctan2(x, y), ALPHA[:, None, None])
    pixels = np.where(is_inside[..., None], [200, 110, 30], [245, 245, 245]).astype(np.uint8)
    viewer.Image.from_srgb(np.concatenate(pixels, axis=1)).save(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
