"""Error against time on scenes that are noisy for one reason each: `python -m benchmarks.noise`.

Every scene of assets/noise is rendered by sampling the surface alone, the lights alone, both (multiple importance
sampling), both with adaptive sampling, and with the denoisers behind them, for some seconds each. Errors are relMSE
against a long render of our own, of other seeds.
"""

from __future__ import annotations

import argparse
import statistics
from importlib.util import find_spec
from pathlib import Path

import viewer
from viewer.base.resources import resource_folder
from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import relmse
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import MAX_SPP, Settings
from viewer.trace.tracer import Tracer

from . import tracing
from .shot import REPOSITORY

METHODS: dict[str, dict[str, object]] = {
    "surface": {"sampling": "bsdf"},
    "lights": {"sampling": "lights"},
    "mis": {},
    "mis, adaptive": {"error": 1e-5},  # never reached: it only says where the samples go
    "mis, denoised fast": {"denoise": "fast"},
}
if find_spec("pyoidn") is not None:
    METHODS["mis, denoised oidn"] = {"denoise": "oidn"}
REASONS = {"small-lights": "small bright lights", "reflections": "sharp reflections", "caustics": "caustics",
           "indirect": "indirect light", "many-lights": "many lights", "unreachable": "no path finds it"}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with open_context() as context:
        tracer = Tracer(context)
        for name in options.only.split(",") if options.only else REASONS:
            scene = viewer.load(resource_folder("assets") / "noise" / f"{name}.glb", environment=None)
            rows += _scene(tracer, name, scene, scene.cameras[0], options)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}"}
    budgets = {f"{seconds:g} s": f"{seconds:g}:.2e" for seconds in options.seconds}
    columns = {"scene": "scene", "why": "why", "method": "method"} | budgets | {"spp in the longest": "spp:.0f"}
    text = ["# Noise, by its cause and by what is done against it", "",
            f"relMSE after so many seconds, median of {options.rounds}; floor: what the reference's own noise makes.",
            "", *tracing.table(rows, columns)]
    tracing.keep("noise", facts, rows, text, options.results)


def _scene(tracer: Tracer, name: str, scene: Scene, camera: Camera, options: argparse.Namespace,
           ) -> list[dict[str, object]]:
    size = (options.size, options.size)
    both, _ = tracing.halves(tracer, scene, camera, size, seed=1000, spp=options.reference_spp // 2)
    rows = [{"scene": name, "why": REASONS[name], "method": "floor"} | {
        f"{seconds:g}": both.floor(both.mean) for seconds in options.seconds}]
    for method, settings in METHODS.items():
        row: dict[str, object] = {"scene": name, "why": REASONS[name], "method": method}
        tracing.shoot(tracer, scene, camera, Settings.of(mode="path", spp=1, **(settings | {"error": None})), size)
        for seconds in options.seconds:
            shots = [tracing.shoot(tracer, scene, camera, Settings.of(
                mode="path", spp=MAX_SPP, seed=k, **settings), size, seconds) for k in range(options.rounds)]
            row[f"{seconds:g}"] = statistics.median(relmse(shot.pixels, both.mean) for shot in shots)
            row["spp"] = statistics.median(shot.spp for shot in shots)
        rows.append(row)
    return rows


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.noise", description=__doc__)
    parser.add_argument("--size", type=int, default=128, help="of the square pictures, in pixels (128)")
    parser.add_argument("--seconds", type=lambda text: [float(part) for part in text.split(",")],
                        default=[1.0, 4.0, 16.0], help="budgets, with commas (1,4,16)")
    parser.add_argument("--reference-spp", type=int, default=8192, help="samples a pixel of the reference (8192)")
    parser.add_argument("--rounds", type=int, default=3, help="seeds a method (3)")
    parser.add_argument("--only", default="", help="names of scenes, with commas")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
