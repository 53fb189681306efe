"""What the choices of antialiasing cost, and how near they come to many samples: python -m benchmarks.antialias.

Frames are drawn in turn in one process, with the camera moved before each, and measured by processor time, which the
other work of the machine changes less. The clock stops when the displayed pixels are in memory.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from pathlib import Path

import numpy as np

import viewer
from viewer.gpu.context import Context, open_context
from viewer.image.image import Image
from viewer.measure.compare.difference import compare
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings

from . import shot
from .machine import here

CHOICES = ("none", "msaa-4", "deferred-4", "ssaa-4")
SIZES = ((512, 512), (1280, 720))
OURS, REFERENCE = "msaa-4", "ssaa-16"
Size = tuple[int, int]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.antialias", description=__doc__)
    parser.add_argument("models", nargs="*", default=[shot.default_model()])
    parser.add_argument("--env", default=shot.default_environment())
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("-o", "--output", type=Path, help="also write the table there")
    options = parser.parse_args()
    loads, rows = [os.getloadavg()[0]], []
    with open_context() as context:
        renderer_name = context.renderer
        for model in options.models:
            scene = viewer.load(model, environment=options.env)
            for size in SIZES:
                rows += _rows(context, Path(model).stem, scene, size, options.frames)
                loads.append(os.getloadavg()[0])
    about = here() | {"load average": f"{min(loads):.1f} to {max(loads):.1f}", "renderer": renderer_name,
                      "environment": Path(options.env).name, "frames": options.frames}
    lines = [f"- {name}: {value}" for name, value in about.items()]
    lines += ["", "Time is processor time, a ratio the median of those within rounds. FLIP is of the first frame.", "",
              "| model | size | antialias | ms | of msaa-4 | of none | FLIP to msaa-4 | FLIP to ssaa-16 |",
              "|---|---|---|---|---|---|---|---|", *rows]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.output:
        options.output.write_text(text)


def _rows(context: Context, name: str, scene: Scene, size: Size, frames: int) -> list[str]:
    renderers = {choice: Renderer(context) for choice in CHOICES}
    times: dict[str, list[float]] = {choice: [] for choice in CHOICES}
    pictures: dict[str, np.ndarray] = {}
    for frame in range(frames + 1):
        for choice in CHOICES[frame % len(CHOICES):] + CHOICES[:frame % len(CHOICES)]:
            renderer, settings = renderers[choice], Settings.of(antialias=choice)
            context.gl.finish()
            start = time.process_time()
            renderer.draw(scene, _camera(scene, frame), settings, size)
            shown = renderer.read_display(settings)
            if frame:
                times[choice].append(1e3 * (time.process_time() - start))
            else:
                pictures[choice] = shown
    reference = None
    if size == SIZES[0]:  # sixteen points of more pixels take much memory
        settings = Settings.of(antialias=REFERENCE)
        renderers["ssaa-4"].draw(scene, _camera(scene, 0), settings, size)
        reference = renderers["ssaa-4"].read_display(settings)
    rows = []
    for choice in CHOICES:
        ratios = [np.median(np.divide(times[choice], times[other])) for other in (OURS, "none")]
        errors = [f"{compare(Image.from_srgb(pictures[choice]), Image.from_srgb(other)).flip:.4f}"
                  if other is not None else "" for other in (pictures[OURS], reference)]
        rows.append(f"| {name} | {size[0]}x{size[1]} | {choice} | {np.median(times[choice]):.0f} | {ratios[0]:.2f} | "
                    f"{ratios[1]:.2f} | {errors[0]} | {errors[1]} |")
    for renderer in renderers.values():
        renderer.release()
    return rows


def _camera(scene: Scene, frame: int) -> Camera:
    return Camera.look_at(shot.eye(scene.bounds, frame), scene.center, fov_y=math.radians(shot.FOV_Y))


if __name__ == "__main__":
    main()
