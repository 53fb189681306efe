"""Shows an animation of a model as a strip of poses.

    python examples/poses.py [OUT [MODEL]]

`pbr-viewer render MODEL -o film.webp --animation 0` makes a film of it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import viewer

MODEL = Path(__file__).parents[1] / "assets" / "scenes" / "arm.glb"


def main(out: str = "poses.png", model: str | Path = MODEL, *, count: int = 5,
         size: tuple[int, int] = (240, 320)) -> None:
    scene = viewer.load(model)
    animation = scene.animation(0)
    poses = [scene.at(animation.duration * k / count) for k in range(count)]
    # One camera for all, so that nothing but the model moves.
    low, high = np.min([pose.bounds[0] for pose in poses], axis=0), np.max([pose.bounds[1] for pose in poses], axis=0)
    camera = viewer.Camera.framing((low + high) / 2, float(np.linalg.norm(high - low)) / 2, size[0] / size[1])
    pictures = [viewer.render(pose, size, camera) for pose in poses]  # what does not move is uploaded once
    viewer.Image.from_srgb(np.concatenate([picture.srgb for picture in pictures], axis=1)).save(out)
    print(f"{animation.name}: {animation.duration:g} s, {animation.moves}; {count} poses are in {out}")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except viewer.ViewerError as error:
        sys.exit(f"{error}")
