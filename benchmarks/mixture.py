"""What `--denoise raster` leaves of the error of few samples: `python -m benchmarks.mixture`.

The scenes of benchmarks.tell_error and of assets/noise are path traced with 4, 16 and 64 samples a pixel. relMSE over
all pixels, against a reference of independent pictures and other seeds, of the samples, of what `fast` and `raster`
make of as many, which are other ones since each half has its own random numbers, and of the raster's picture alone, as
shares of that of the samples; and how much light is left. Where single samples make most of the error, chance decides.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from statistics import median

import numpy as np

from viewer.estimate.mixture import draw_guide, raster_settings
from viewer.estimate.pairs import TRIMMED
from viewer.raster.renderer import Renderer
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import corpus, tracing
from .against_paths import ENVIRONMENTS, MODELS, Row, compare, load, present, reference_of, relative_errors

LAMPS = ("LightsPunctualLamp:none", "noise/reflections", "noise/indirect", "noise/small-lights", "noise/many-lights",
         "noise/caustics")
SAMPLES = (4, 16, 64)
METHODS = ("raster alone", "fast", "raster")


def main() -> None:
    compare("mixture", __doc__, _scenes(), _measure, _page)


def _scenes() -> list[str]:
    """Each model under one environment, in turn."""
    return [f"{name}:{ENVIRONMENTS[k % 2]}" for k, name in enumerate(corpus.present(MODELS))] + present(LAMPS)


def _measure(renderer: Renderer, tracer: Tracer, name: str, options: argparse.Namespace) -> Iterator[Row]:
    scene, camera = load(name)
    size, plain = (options.size, options.size), Settings(mode="path")
    reference = reference_of(tracer, scene, camera, plain, options)
    alone = renderer.render(scene, camera, raster_settings(plain), size)
    for samples in SAMPLES:
        made = {"raster alone": alone}
        for method in ("off", *METHODS[1:]):
            settings = replace(plain, spp=samples, denoise=method)
            guide = draw_guide(renderer, scene, camera, settings, size)
            made[method] = tracer.render(scene, camera, settings, size, guide=guide)
        errors = {method: _relmse(tracing.radiance(image), reference) for method, image in made.items()}
        raw, most = errors["off"]
        light = float(made["off"].linear[..., :3].mean())
        yield {"scene": name, "samples": samples, "raw": raw, **{
            method: errors[method][0] / raw for method in METHODS}, **{
            f"{method}, most": errors[method][1] / most for method in METHODS}, **{
            f"{method}, light": float(made[method].linear[..., :3].mean()) / light for method in METHODS[1:]}}


def _relmse(picture: np.ndarray, reference: np.ndarray) -> tuple[float, float]:
    """Of all pixels, and of most: without the worst."""
    errors = np.sort(relative_errors(picture, reference), axis=None)
    return float(errors.mean()), float(errors[:len(errors) - int(TRIMMED * len(errors))].mean())


def _page(rows: list[Row]) -> list[str]:
    summary = []
    for samples in SAMPLES:
        some = [row for row in rows if row["samples"] == samples]
        for method in METHODS:
            shares = [float(row[method]) for row in some]
            worst = max(range(len(some)), key=shares.__getitem__)
            summary.append({"samples": samples, "method": method, "scenes": len(some), "median": median(shares),
                            "worst": shares[worst], "where": some[worst]["scene"],
                            "most": median(float(row[f"{method}, most"]) for row in some)})
    columns = {"samples a pixel": "samples", "method": "method", "scenes": "scenes", "median": "median:.2f",
               "worst": "worst:.2f", "of": "where", "median, without the worst pixels": "most:.2f"}
    each = {"scene": "scene", "samples": "samples", "relMSE of the samples": "raw:.2e",
            **{method: f"{method}:.2f" for method in METHODS},
            **{f"{method}, without the worst pixels": f"{method}, most:.2f" for method in METHODS[1:]},
            **{f"{method}, mean radiance over that of the samples": f"{method}, light:.2f" for method in METHODS[1:]}}
    return ["# What denoising leaves of the relMSE of the samples", "",
            f"Without the worst pixels: {TRIMMED:.0%} of them are left out of both. In scenes with lamps most of the "
            "error is in a few pixels, which one sample has made bright.", "",
            *tracing.table(summary, columns), "", *tracing.table(rows, each)]


if __name__ == "__main__":
    main()
