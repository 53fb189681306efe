"""Measures how far real-time pictures are from a path-traced one, and saves all of them side by side.

    python examples/raster_against_paths.py [OUT]

relMSE is the mean of (picture - reference)^2 / (reference^2 + 0.01). The reference is noisy itself: even a perfect
picture would have the relMSE that is printed as the floor.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import viewer

MODEL = Path(__file__).parents[1] / "assets" / "demo.glb"
METHODS = {"plain": "off", "shadows of the environment": "64"}


def main(out: str = "beside.png", *, size: tuple[int, int] = (320, 240), spp: int = 64) -> None:
    scene = viewer.load(MODEL)
    reference = viewer.render(scene, size, mode="path", spp=spp, aov=["variance"])
    light = np.asarray(reference)[..., :3]
    pictures = [reference]
    for name, shadows in METHODS.items():
        pictures.append(viewer.render(scene, size, environment_shadows=shadows))
        error = np.mean((np.asarray(pictures[-1])[..., :3] - light) ** 2 / (light**2 + 0.01))
        print(f"{name:27} relMSE {error:.4f}")
    print(f"{'floor':27} relMSE {np.mean(reference.layers['variance'] / (light**2 + 0.01)):.4f}")
    viewer.Image.from_srgb(np.concatenate([picture.srgb for picture in pictures], axis=1)).save(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
