"""Frames of yarns by their distance, how the levels of detail agree, and the time of a path-traced picture:
`python -m benchmarks.yarns MODEL`.

A frame is one of the window while its camera moves, 512 x 512, and its time that of drawing until the GPU is done: the
median of five, by the wall clock and by processor time on all threads. The levels are compared by the mean radiance of
`assets/curves`, in a view where a yarn is as wide as the finest level asks for; mode path has no hairs there, as the
rasterizer has none.
"""

from __future__ import annotations

import argparse
import resource
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from unittest.mock import patch

import numpy as np

import viewer
from viewer.gpu.context import Context, open_context
from viewer.raster import yarns
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment_presets import make_preset
from viewer.scene.frame import Frame
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.yarn.spun import as_yarns, spun, yarn_kind
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import tracing
from .shot import REPOSITORY

SIZE = (512, 512)
LEVELS = {"tubes": (1e9, 1e9), "plies": (0.0, 1e9), "fibres": (0.0, 0.0)}
FRAMES = {"view": "view", "tubes": "tubes:,", "plies": "plies:,", "fibres": "fibres:,", "ms": "wall:.0f",
          "processor ms": "processor:.0f"}
AGREEMENT = {"yarns": "yarns", "light": "light", **{name: f"{name}:.4f" for name in (*LEVELS, "path")}}
PICTURES = {"model": "model", "yarn": "yarn", "segments": "segments:,", "rays": "rays:,", "s": "wall:.1f",
            "processor s": "processor:.1f", "most memory of the process, MB": "resident:.0f"}
LIGHTS = {"sun": (None, (Light.from_angles(0.6, 0.7, 2.0),)), "sky": ("sky", ()), "all around": ("furnace", ())}


def main() -> None:
    options = _parse()
    with open_context() as context:
        tracer, renderer = Tracer(context), Renderer(context)
        frames = _frames(context, renderer, options.model, options.yarn)
        agreement = [_means(renderer, tracer, *pair, light) for pair in (
            ("knit.bcc", "wool"), ("woven.hair", "cotton")) for light in LIGHTS]
        picture = [_picture(tracer, options.model, options.yarn)]
        facts = tracing.conditions(tracer) | {"command": f"python -m benchmarks.yarns {options.model.name}"}
        renderer.release()
        tracer.release()
    text = ["# Yarns", "", f"Frames of {options.model.name}, 512 x 512, yarn={options.yarn}, with what is drawn of "
            "segments of each level:", "", *tracing.table(frames, FRAMES), "",
            "Mean radiance, green, of each level of detail and of mode path:", "",
            *tracing.table(agreement, AGREEMENT), "",
            "Path traced, 64 samples, 256 x 256, from the yarns in memory to the picture:", "",
            *tracing.table(picture, PICTURES)]
    tracing.keep("yarns", facts, [*frames, *agreement, *picture], text, options.results)


def _frames(context: Context, renderer: Renderer, model: Path, yarn: str) -> list[dict[str, object]]:
    scene, settings = viewer.load(model), Settings.of(yarn=yarn)
    buffers = yarns.YarnBuffers(context.gl, as_yarns(scene, settings).curves[0], None, yarn_kind(settings))
    rows = []
    for view, distance in (("all of it", 1.0), ("a quarter", 0.25), ("a sixteenth", 1 / 16), ("a fiftieth", 0.02)):
        framed = scene.framing_camera(1.0, elevation=1.2)
        camera = Camera.look_at(scene.center + distance * (framed.eye - scene.center), scene.center, fov_y=framed.fov_y)
        walls, processors = [], []
        for _ in range(6):
            start, processor = time.perf_counter(), time.process_time()
            renderer.draw(scene, camera, settings, SIZE)
            context.gl.finish()
            walls.append(time.perf_counter() - start)
            processors.append(time.process_time() - processor)
        frame = Frame(scene, camera, SIZE)
        drawn = buffers.counts(frame.view_projection @ frame.model(np.eye(4)), SIZE)
        rows.append({"view": view, **drawn, "wall": 1e3 * median(walls[1:]),
                     "processor": 1e3 * median(processors[1:])})
    buffers.release()
    return rows


def _means(renderer: Renderer, tracer: Tracer, name: str, yarn: str, light: str) -> dict[str, object]:
    preset, lights = LIGHTS[light]
    scene = viewer.load(REPOSITORY / "assets/curves" / name, environment=None)
    scene = replace(scene, lights=lights, environment=None if preset is None else make_preset(preset))
    camera = Camera.look_at(scene.center + 1.65 * scene.radius * np.array([0.3, 0.2, 1.0]), scene.center, fov_y=0.18)
    settings = Settings.of(yarn=yarn, background="none")
    found: dict[str, object] = {"yarns": name, "light": light}
    for level, (plies, fibres) in LEVELS.items():
        with patch.multiple(yarns, PLY_PIXELS=plies, FIBRE_PIXELS=fibres):
            found[level] = _green(renderer.render(scene, camera, settings, (64, 64)).linear)
    traced = replace(settings, mode="path", spp=64, yarn_hairs=0.0)
    return found | {"path": _green(tracer.render(scene, camera, traced, (64, 64)).linear)}


def _green(pixels: np.ndarray) -> float:
    return float(pixels[..., 1].mean())


def _picture(tracer: Tracer, model: Path, yarn: str) -> dict[str, object]:
    scene: Scene = viewer.load(model)
    settings = Settings.of(mode="path", spp=64, yarn=yarn)
    start, processor = time.perf_counter(), time.process_time()
    image = tracer.render(scene, scene.framing_camera(1.0), settings, (256, 256))
    wall, used = time.perf_counter() - start, time.process_time() - processor
    return {"model": model.name, "yarn": yarn, "segments": int(spun(scene, settings).curves[0].spans.sum()),
            "rays": image.stats["rays"], "wall": wall, "processor": used,
            "resident": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3}


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.yarns", description=__doc__)
    parser.add_argument("model", type=Path, help="a file of curves")
    parser.add_argument("--yarn", default="cotton", help="the kind of yarn")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
