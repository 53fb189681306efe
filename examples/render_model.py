"""Renders a model file to a picture, from a camera of your own.

    python examples/render_model.py [OUT [MODEL]]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import viewer

MODEL = Path(__file__).parents[1] / "assets" / "demo.glb"


def main(out: str = "model.png", model: str | Path = MODEL, *, size: tuple[int, int] = (1280, 720)) -> None:
    scene = viewer.load(model, environment="sky")
    camera = scene.framing_camera(size[0] / size[1], azimuth=math.radians(-20))
    image = viewer.render(scene, size, camera, exposure=0.5, tonemap="agx", environment_shadows="64")
    image.save(out)  # .png, .jpg and .webp hold the displayed picture, .exr linear light
    for warning in scene.warnings:
        print(warning)
    print(f"{scene.name}: {scene.triangle_count} triangles, {len(scene.materials)} materials; the picture is {out}")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except viewer.ViewerError as error:  # one line, for instance which place of which file is wrong
        sys.exit(f"{error}")
