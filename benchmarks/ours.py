"""Ours as one of the programs: `python -m benchmarks.ours MODEL HDR WxH OUT.png [--frames N]`.

Draws one picture, then N timed frames with the camera moved before each and the displayed pixels read back, and
prints one line of JSON: load_s, first_frame_s (baking, decoding, compiling and uploading are in it), frame_ms, and of
the first frame its programs, the lines and kilobytes that the switches leave of their fragment shaders, and the MB of
textures and buffers.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import time
from importlib.metadata import version
from typing import TYPE_CHECKING

from . import shot

if TYPE_CHECKING:
    import numpy as np

    from viewer.plan.model import Plan

WARM_UP = 2


def main() -> None:
    options = _parse()
    width, height = (int(side) for side in options.size.split("x"))
    started = time.perf_counter()
    from viewer.api import load
    from viewer.gpu.context import open_context
    from viewer.image.image import Image
    from viewer.raster.renderer import Renderer
    from viewer.scene.camera import Camera
    from viewer.settings import Settings

    from .gpu_bytes import counted_bytes

    imported = time.perf_counter()
    scene = load(options.model, None if options.environment == "none" else options.environment)
    loaded = time.perf_counter()
    settings = Settings.of(antialias=options.antialias, plan=options.plan)
    with open_context(options.backend) as context:

        def camera(frame: int) -> Camera:
            eye = shot.eye(scene.bounds, frame)
            return Camera.look_at(eye, scene.center, fov_y=math.radians(shot.FOV_Y))

        def displayed(frame: int) -> np.ndarray:
            renderer.draw(scene, camera(frame), settings, (width, height))
            return renderer.read_display(settings)

        opened, processor = time.perf_counter(), time.process_time()
        with counted_bytes() as counted:
            renderer = Renderer(context)
            first = displayed(0)
        report = {"version": version("pbr-viewer"), "renderer": f"{context.renderer}, {context.backend}",
                  "import_s": imported - started, "load_s": loaded - imported, "context_s": opened - loaded,
                  "first_frame_s": time.perf_counter() - opened, "first_frame_cpu_s": time.process_time() - processor,
                  "gpu_mb": counted[0] / 1e6}
        Image.from_srgb(first).save(options.picture)
        times = []
        for frame in range(1, WARM_UP + options.frames + 1):
            start = time.perf_counter()
            displayed(frame)
            times.append((time.perf_counter() - start) * 1e3)
        report |= _shaders(renderer.plan)
    times = times[WARM_UP:]
    if times:
        report |= {"frame_median_ms": statistics.median(times), "frame_ms": [round(ms, 3) for ms in times]}
    print(json.dumps({key: round(value, 4) if isinstance(value, float) else value for key, value in report.items()}))


def _shaders(plan: Plan) -> dict[str, float]:
    """What the compiler sees of the fragment shaders of the surfaces."""
    from .shader_code import lines_left

    code = [line for program in plan.programs for line in lines_left(program.fragment, dict(program.switches))]
    return {"programs": len(plan.programs), "shader_lines": len(code), "shader_kb": sum(map(len, code)) / 1e3}


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ours")
    parser.add_argument("model")
    parser.add_argument("environment", help="a file, the name of one of ours, or none")
    parser.add_argument("size", metavar="WxH")
    parser.add_argument("picture")
    parser.add_argument("--frames", type=int, default=0)
    parser.add_argument("--backend", default="auto")
    parser.add_argument("--antialias", default="auto", help="as in --set antialias=")
    parser.add_argument("--plan", default="needed", help="as in --set plan=")
    return parser.parse_args()


if __name__ == "__main__":
    main()
