"""Ours as one of the programs: `python -m benchmarks.ours MODEL HDR WxH OUT.png [--frames N]`.

Draws one picture, then N timed frames with the camera moved before each and the displayed pixels read back, and
prints one line of JSON.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import time
from importlib.metadata import version

import numpy as np

from . import shot

WARM_UP = 2


def main() -> None:
    options = _parse()
    width, height = (int(side) for side in options.size.split("x"))
    from viewer.api import load
    from viewer.gpu.context import open_context
    from viewer.image import Image
    from viewer.raster.renderer import Renderer
    from viewer.scene.camera import Camera
    from viewer.settings import Settings

    scene = load(options.model, options.environment)
    settings = Settings.of(antialias=options.antialias)
    with open_context(options.backend) as context:
        renderer = Renderer(context)

        def camera(frame: int) -> Camera:
            eye = shot.eye(scene.bounds, frame)
            return Camera.look_at(eye, scene.center, fov_y=math.radians(shot.FOV_Y))

        def displayed(frame: int) -> np.ndarray:
            renderer.draw(scene, camera(frame), settings, (width, height))
            return renderer.read_display(settings)

        Image.from_srgb(displayed(0)).save(options.picture)
        times = []
        for frame in range(1, WARM_UP + options.frames + 1):
            start = time.perf_counter()
            displayed(frame)
            times.append((time.perf_counter() - start) * 1e3)
        report = {"version": version("pbr-viewer"), "renderer": f"{context.renderer}, {context.backend}"}
    times = times[WARM_UP:]
    if times:
        report |= {"frame_median_ms": round(statistics.median(times), 3), "frame_ms": [round(ms, 3) for ms in times]}
    print(json.dumps(report))


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ours")
    parser.add_argument("model")
    parser.add_argument("environment")
    parser.add_argument("size", metavar="WxH")
    parser.add_argument("picture")
    parser.add_argument("--frames", type=int, default=0)
    parser.add_argument("--backend", default="auto")
    parser.add_argument("--antialias", default="auto", help="as in --set antialias=")
    return parser.parse_args()


if __name__ == "__main__":
    main()
