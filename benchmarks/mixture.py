"""What `--denoise raster` leaves of the error of few samples: `python -m benchmarks.mixture`.

The scenes of benchmarks.tell_error and of assets/noise are path traced with 4, 16 and 64 samples a pixel. relMSE over
all pixels, against a reference of independent pictures and other seeds, of the samples, of what `fast` and `raster`
make of them, and of the raster's picture alone, as shares of that of the samples; and how much of their light is left.
A picture of `off` has other samples: its share is what it costs that each half has its own random numbers. Where single
samples make most of the error, chance decides about that share.
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
from viewer.trace.paths.path_render import PathRender
from viewer.trace.tracer import Tracer

from . import corpus, tracing
from .against_paths import ENVIRONMENTS, MODELS, Row, compare, load, present, reference_of, relative_errors

LAMPS = ("LightsPunctualLamp:none", "noise/reflections", "noise/indirect", "noise/small-lights", "noise/many-lights",
         "noise/caustics")
SAMPLES = (4, 16, 64)
METHODS = ("raster alone", "off", "fast", "raster")


def main() -> None:
    compare("mixture", __doc__, _scenes(), _measure, _page)


def _scenes() -> list[str]:
    """Each model under one environment, in turn."""
    return [f"{name}:{ENVIRONMENTS[k % 2]}" for k, name in enumerate(corpus.present(MODELS))] + present(LAMPS)


def _measure(renderer: Renderer, tracer: Tracer, name: str, options: argparse.Namespace) -> Iterator[Row]:
    scene, camera = load(name)
    size, plain = (options.size, options.size), Settings(mode="path")
    reference = reference_of(tracer, scene, camera, plain, options.size, options.reference_spp)
    alone = renderer.render(scene, camera, raster_settings(plain), size)
    for samples in SAMPLES:
        made = {"raster alone": tracing.radiance(alone)}
        for method in METHODS[1:]:
            settings = replace(plain, spp=samples, denoise=method)
            guide = draw_guide(renderer, scene, camera, settings, size)
            # The halves of `fast` and `raster` have the same random numbers, so `raw` of the last is that of both.
            made[method], raw = _made(tracer.begin(scene, camera, settings, size, guide=guide))
        errors = {method: _relmse(picture, reference) for method, picture in (made | {"raw": raw}).items()}
        yield {"scene": name, "samples": samples, "raw": errors["raw"][0], **{
            method: errors[method][0] / errors["raw"][0] for method in METHODS}, **{
            f"{method}, most": errors[method][1] / errors["raw"][1] for method in METHODS}, **{
            f"{method}, light": float(made[method].mean() / raw.mean()) for method in METHODS[1:]}}


def _made(path_render: PathRender) -> tuple[np.ndarray, np.ndarray]:
    """The finished picture, and its samples as they are."""
    try:
        while not path_render.is_done:
            path_render.step(tracing.SLICE)
        return tracing.radiance(path_render.image()), path_render.read_radiance()[..., :3].astype(np.float64)
    finally:
        path_render.release()


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
            "error is in a few pixels, which one sample has made bright. `off` has other samples, not in halves.", "",
            *tracing.table(summary, columns), "", *tracing.table(rows, each)]


if __name__ == "__main__":
    main()
