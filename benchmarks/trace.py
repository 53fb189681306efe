"""How fast the path tracer is, and beside it Mitsuba in turn, by LLVM or CUDA: `python -m benchmarks.trace`.

Rays and samples a second, error against time, and how the cost of a sample grows from a thousand triangles to a
million. Each renderer's error is relMSE against its own long render, for their materials are not quite the same.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import Halves, relmse
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import mitsuba_scene, tracing
from .shot import REPOSITORY
from .summary import Spread
from .trace_scenes import HILLS, scenes

COLUMNS = {"scene": "scene", "triangles": "triangles:,", "by": "by", "first picture, s": "first:.2f", "spp": "spp:.0f",
           "s, median": "median:.3f", "p10": "p10:.3f", "p90": "p90:.3f", "processor s": "processor:.3f",
           "relMSE": "relmse:.2e", "Msample/s": "mega_samples:.2f", "Mray/s": "mega_rays:.2f"}


OURS, ADAPTIVE, MITSUBA = "pbr-viewer", "pbr-viewer adaptive", "Mitsuba"
LEAST_ERROR = 1e-5
"""Never reached: the samples end the picture, and the error only says that they go where there is noise."""


class Drawn(NamedTuple):
    """A picture, the seconds it took by the clock and of all processors, and its rays (0: not known)."""

    picture: np.ndarray
    seconds: float
    processor: float
    rays: int


@dataclass(frozen=True)
class Renderer:
    """`draw(spp, seed)` draws a picture."""

    name: str
    draw: Callable[[int, int], Drawn]


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with open_context() as context:
        tracer = Tracer(context)
        for name, (scene, camera) in scenes().items():
            if not options.only or any(part in name for part in options.only.split(",")):
                rows += _scene(tracer, name, scene, camera, options)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}"}
    text = ["# Path tracing: speed, and error against time", "", *tracing.table(rows, COLUMNS), "", *_against(rows), "",
            *_growth(rows)]
    tracing.keep("trace", facts, rows, text, options.results)


def _scene(tracer: Tracer, name: str, scene: Scene, camera: Camera, options: argparse.Namespace,
           ) -> list[dict[str, object]]:
    """Both renderers in turn, a round a seed, for each sample count."""
    size, rows = (options.size, options.size), []
    renderers = [ours(tracer, scene, camera, size)]
    if options.adaptive:
        renderers.append(ours(tracer, scene, camera, size, ADAPTIVE))
    if mitsuba_scene.is_installed() and not options.ours:
        renderers.append(mitsubas(scene, camera, size))
    references, first = {}, {}
    for renderer in renderers:
        start = time.perf_counter()
        renderer.draw(1, 0)
        first[renderer.name] = time.perf_counter() - start
        references[renderer.name] = Halves(*(renderer.draw(options.reference_spp // 2, 100 + k).picture
                                             for k in (0, 1)))
    for spp in options.spp:
        drawn: dict[str, list[Drawn]] = {renderer.name: [] for renderer in renderers}
        for seed in range(options.rounds):
            for renderer in renderers:
                drawn[renderer.name].append(renderer.draw(spp, 1 + seed))
        for renderer in renderers:
            pictures, seconds, processor, rays = zip(*drawn[renderer.name])
            reference, spread = references[renderer.name], Spread.of(seconds)
            rows.append({
                "scene": name, "triangles": scene.triangle_count, "by": renderer.name, "first": first[renderer.name],
                "spp": spp, "median": spread.median, "p10": spread.p10, "p90": spread.p90, "n": spread.n,
                "processor": statistics.median(processor),
                "relmse": statistics.median(relmse(picture, reference.mean) for picture in pictures),
                "reference_floor": reference.floor(reference.mean),
                "mega_samples": size[0] * size[1] * spp / spread.median / 1e6,
                "mega_rays": statistics.median(rays) / spread.median / 1e6 if rays[0] else None})
    return rows


def ours(tracer: Tracer, scene: Scene, camera: Camera, size: tuple[int, int], name: str = OURS) -> Renderer:
    """With the name ADAPTIVE as many samples of all pixels together, where there is noise."""
    error = LEAST_ERROR if name == ADAPTIVE else None

    def draw(spp: int, seed: int) -> Drawn:
        start, processor = time.perf_counter(), time.process_time()
        shot = tracing.shoot(tracer, scene, camera, Settings.of(mode="path", spp=spp, seed=seed, error=error),
                              size)
        return Drawn(shot.pixels, time.perf_counter() - start, time.process_time() - processor, shot.rays)

    return Renderer(name, draw)


def mitsubas(scene: Scene, camera: Camera, size: tuple[int, int]) -> Renderer:
    theirs = mitsuba_scene.convert(scene, camera, size)

    def draw(spp: int, seed: int) -> Drawn:
        start, processor = time.perf_counter(), time.process_time()
        picture = mitsuba_scene.render(theirs, spp, seed)
        return Drawn(picture, time.perf_counter() - start, time.process_time() - processor, 0)

    return Renderer(f"{MITSUBA}, {mitsuba_scene.mitsuba().variant()}", draw)


def _against(rows: list[dict[str, object]]) -> list[str]:
    """Our time over Mitsuba's at equal samples, and at equal error: error times time, since relMSE falls as 1 / time.
    Of the largest sample count of each scene, by the clock and by the time of all processors."""
    last = {(str(row["scene"]), str(row["by"]).split(",")[0]): row for row in rows}
    lines = ["| scene | by | equal samples, clock | processor | equal error, clock | processor |",
             "|---|---|---|---|---|---|"]
    for (scene, name), us in last.items():
        them = last.get((scene, MITSUBA))
        if them is not None and name != MITSUBA:
            error = float(us["relmse"]) / float(them["relmse"])
            times = [float(us[key]) / float(them[key]) for key in ("median", "processor")]
            cells = (f"{value:.2f}" for value in (*times, *(error * t for t in times)))
            lines.append(f"| {scene} | {name} | " + " | ".join(cells) + " |")
    return lines if len(lines) > 2 else []


def _growth(rows: list[dict[str, object]]) -> list[str]:
    """The cost of a sample in the hills, over that in the smallest, beside the logarithms of the triangle counts."""
    lines = ["| hills | cost of a sample, of the smallest | logarithm of triangles, of the smallest |", "|---|---|---|"]
    costs: dict[int, float] = {}
    for row in rows:
        if row["by"] == OURS and str(row["scene"]).startswith("hills"):
            costs[int(row["triangles"])] = 1 / float(row["mega_samples"])  # of the largest sample count, the last
    if len(costs) < len(HILLS):
        return []
    base = min(costs)
    return lines + [f"| {count:,} | {costs[count] / costs[base]:.2f} | {np.log(count) / np.log(base):.2f} |"
                    for count in sorted(costs)]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trace", description=__doc__)
    parser.add_argument("--size", type=int, default=256, help="of the square pictures, in pixels (256)")
    parser.add_argument("--spp", type=lambda text: [int(part) for part in text.split(",")], default=[4, 16, 64],
                        help="sample counts, with commas (4,16,64)")
    parser.add_argument("--reference-spp", type=int, default=1024, help="samples a pixel of the references (1024)")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="parts of the scenes' names, with commas")
    parser.add_argument("--adaptive", action="store_true", help="ours with as many samples where there is noise, too")
    parser.add_argument("--ours", action="store_true", help="leave Mitsuba out")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
