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
from statistics import median
from typing import Any

import numpy as np

from viewer.estimate.pairs import TRIMMED
from viewer.estimate.paths import PathGroups, path_settings
from viewer.estimate.raster_error import raster_error
from viewer.raster.renderer import Renderer
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import corpus, tracing
from .against_paths import ENVIRONMENTS, MODELS, Row, compare, load, present, reference_of, relative_errors

LAMPS = ("LightsPunctualLamp:none", "noise/reflections", "noise/indirect")
PICTURES: dict[str, dict[str, Any]] = {
    "plain": {},
    "no antialiasing, ambient occlusion": {"antialias": "none", "ambient_occlusion": "gtao"},
    "shadows of the environment": {"antialias": "ssaa-4", "environment_shadows": "64"},
    "Phong": {"mode": "phong"},
}
SAMPLES = (8, 16, 32, 64)


def main() -> None:
    compare("tell_error", __doc__, _scenes(), _measure, _page)


def _scenes() -> list[str]:
    models = [f"{model}:{environment}" for model in corpus.present(MODELS) for environment in ENVIRONMENTS]
    return models + present(LAMPS)


def _measure(renderer: Renderer, tracer: Tracer, name: str, options: argparse.Namespace) -> Iterator[Row]:
    scene, camera = load(name)
    size = options.size, options.size
    reference = reference_of(tracer, scene, camera, path_settings(Settings()), options.size, options.reference_spp)
    pictures = {title: renderer.render(scene, camera, Settings.of(**changes), size).linear[..., :3]
                for title, changes in PICTURES.items()}
    paths = PathGroups.of_raster(tracer, scene, camera, Settings(), size)
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
    """relMSE, and without the worst pixels."""
    errors = relative_errors(picture[mask], reference[:, mask])
    return float(errors.mean()), float(np.sort(errors)[:len(errors) - int(TRIMMED * len(errors))].mean())


def _page(rows: list[Row]) -> list[str]:
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


if __name__ == "__main__":
    main()
