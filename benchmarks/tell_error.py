"""Whether the error that `render --tell-error` tells is true: `python -m benchmarks.tell_error`.

Models of the corpus under two environments, and scenes of ours with lamps, are drawn by several settings of the raster.
For each picture the error is told after 8, 16, 32 and 64 samples a pixel, and compared with the error against a
reference of many samples and other seeds. The reference consists of independent pictures, so that its own noise adds
nothing to the true error on average. `width` is the upper end of the told interval over its lower end, of the relative
error.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import viewer
from viewer.base.resources import resource_folder
from viewer.estimate.neighbourhood import EPSILON
from viewer.estimate.paths import PathGroups, path_settings
from viewer.estimate.raster_error import TRIMMED, raster_error, squared_error
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import corpus, tracing
from .machine import until_stopped
from .shot import REPOSITORY

MODELS = ("Fox", "DamagedHelmet", "GlassVaseFlowers", "ClearCoatTest", "SheenCloth", "IridescenceSuzanne",
          "AttenuationTest", "CesiumMilkTruck", "Duck", "BoxTextured", "AlphaBlendModeTest", "AnisotropyDiscTest")
ENVIRONMENTS = ("studio", "lebombo_1k")
LAMPS = ("LightsPunctualLamp:none", "noise/reflections", "noise/indirect")
PICTURES: dict[str, dict[str, Any]] = {
    "plain": {},
    "no antialiasing, ambient occlusion": {"antialias": "none", "ambient_occlusion": "gtao"},
    "shadows of the environment": {"antialias": "ssaa-4", "environment_shadows": "64"},
    "Phong": {"mode": "phong"},
}
SAMPLES = (8, 16, 32, 64)
REFERENCES = 4
_SEED = 1 << 20


def main() -> None:
    options = _parse()
    rows: list[dict[str, Any]] = []
    with open_context() as context, until_stopped():
        renderer, tracer = Renderer(context), Tracer(context)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}", "reference":
                                              f"{REFERENCES} times {options.reference_spp} samples a pixel"}
        for name in options.scenes or _scenes():
            rows += _scene(renderer, tracer, name, options)
            tracing.keep("tell_error", facts, rows, _page(rows), options.results)


def _scenes() -> list[str]:
    there = [f"{model}:{environment}" for model in corpus.present(MODELS) for environment in ENVIRONMENTS]
    return there + [name for name in LAMPS if name.startswith("noise/") or corpus.present((name.partition(":")[0],))]


def load(name: str) -> tuple[Scene, Camera]:
    """A scene of assets/noise, or a model of the corpus and behind `:` its environment."""
    if name.startswith("noise/"):
        scene = viewer.load(resource_folder("assets") / f"{name}.glb", environment=None)
        return scene, scene.cameras[0]
    model, _, environment = name.partition(":")
    spec = None if environment == "none" else corpus.environment(environment or "studio")
    scene = viewer.load(corpus.model(model), spec)
    return scene, scene.framing_camera(1.0)


def _scene(renderer: Renderer, tracer: Tracer, name: str, options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    scene, camera = load(name)
    size = options.size, options.size
    settings = replace(path_settings(Settings()), spp=options.reference_spp)
    reference = np.stack([tracing.shoot(tracer, scene, camera, replace(settings, seed=_SEED + k), size).pixels
                          for k in range(REFERENCES)])
    pictures = {title: renderer.render(scene, camera, Settings.of(**changes), size).linear[..., :3]
                for title, changes in PICTURES.items()}
    paths = PathGroups(tracer, scene, camera, Settings(), size)
    for samples in SAMPLES:
        while paths.samples < samples:
            paths.step(math.inf)
        mask = paths.shows_model
        for title, picture in pictures.items():
            started = time.perf_counter()
            told = raster_error(picture, paths.groups, mask, paths.samples, paths.seconds)
            seconds = time.perf_counter() - started
            true, trimmed = _true(picture, reference, mask)
            yield {"scene": name, "picture": title, "samples": samples, "true": math.sqrt(max(true, 0)),
                   "told": told.relative, "low": math.sqrt(told.low), "high": math.sqrt(told.high),
                   "holds": bool(told.low <= true <= told.high), "trimmed": math.sqrt(told.trimmed),
                   "true trimmed": math.sqrt(max(trimmed, 0)), "seconds": paths.seconds, "telling": seconds}


def _true(picture: np.ndarray, reference: np.ndarray, mask: np.ndarray) -> tuple[float, float]:
    """relMSE, and without the worst pixels; on average the reference's noise adds nothing."""
    truth = reference.mean(axis=0)[mask]
    errors = (squared_error((picture - reference)[:, mask]) / (truth**2 + EPSILON)).mean(axis=-1)
    return float(errors.mean()), float(np.sort(errors)[:len(errors) - int(TRIMMED * len(errors))].mean())


def _page(rows: list[dict[str, Any]]) -> list[str]:
    summary = []
    for samples in SAMPLES:
        some = [row for row in rows if row["samples"] == samples]
        held = sum(bool(row["holds"]) for row in some)
        ratios = [row["told"] / max(row["true"], 1e-9) for row in some]
        widths = [row["high"] / max(row["low"], 1e-3) for row in some]
        trims = [row["trimmed"] / max(row["true trimmed"], 1e-9) for row in some]
        summary.append({"samples": samples, "cases": len(some), "held": f"{held} ({held / max(len(some), 1):.0%})",
                        "told": median(ratios), "width": median(widths), "trimmed": median(trims)})
    columns = {"samples a pixel": "samples", "cases": "cases", "interval holds the truth": "held",
               "told / true, median": "told:.2f", "width, median": "width:.2f",
               "trimmed: told / true, median": "trimmed:.2f"}
    last = {"scene": "scene", "picture": "picture", "true": "true:.3f", "told": "told:.3f", "low": "low:.3f",
            "high": "high:.3f", "holds": "holds", "trimmed, true": "true trimmed:.3f", "trimmed, told": "trimmed:.3f"}
    most = [row for row in rows if row["samples"] == SAMPLES[-1]]
    return ["# The told error of pictures of the raster, against the true one", "",
            "Relative errors: the roots of relMSE.", "", *tracing.table(summary, columns), "",
            f"After {SAMPLES[-1]} samples a pixel:", "", *tracing.table(most, last)]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tell_error", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help="models of the corpus, as MODEL:ENVIRONMENT, or scenes of assets/, as noise/NAME")
    parser.add_argument("--size", type=int, default=96, help="of the square pictures, in pixels (96)")
    parser.add_argument("--reference-spp", type=int, default=128, help="samples a pixel of each reference (128)")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
