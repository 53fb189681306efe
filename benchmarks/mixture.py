"""What `--denoise raster` leaves of the error of few samples: `python -m benchmarks.mixture`.

The scenes of benchmarks.tell_error and of assets/noise are path traced with 4, 16 and 64 samples a pixel. relMSE over
all pixels, against a reference of independent pictures and other seeds, of the samples, of what `fast` and `raster`
make of them, and of the raster's picture alone, as shares of that of the samples.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from statistics import median

import numpy as np

from viewer.estimate.mixture import raster_settings, render_mixture
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
    alone = renderer.render(scene, camera, raster_settings(plain), size).linear[..., :3]
    for samples in SAMPLES:
        settings = replace(plain, spp=samples)
        raw = _relmse(tracing.shoot(tracer, scene, camera, settings, size).pixels, reference)
        row: Row = {"scene": name, "samples": samples, "raw": raw,
                    "raster alone": _relmse(alone, reference) / raw}
        fast = tracer.render(scene, camera, replace(settings, denoise="fast"), size)
        mixed = render_mixture(tracer, renderer, scene, camera, replace(settings, denoise="raster"), size)
        row |= {"fast": _relmse(tracing.radiance(fast), reference) / raw,
                "raster": _relmse(tracing.radiance(mixed), reference) / raw}
        yield row


def _relmse(picture: np.ndarray, reference: np.ndarray) -> float:
    return float(relative_errors(picture, reference).mean())


def _page(rows: list[Row]) -> list[str]:
    summary = []
    for samples in SAMPLES:
        some = [row for row in rows if row["samples"] == samples]
        for method in METHODS:
            shares = [float(row[method]) for row in some]
            worst = max(range(len(some)), key=shares.__getitem__)
            summary.append({"samples": samples, "method": method, "scenes": len(some), "median": median(shares),
                            "worst": shares[worst], "where": some[worst]["scene"]})
    columns = {"samples a pixel": "samples", "method": "method", "scenes": "scenes", "median": "median:.2f",
               "worst": "worst:.2f", "of": "where"}
    each = {"scene": "scene", "samples": "samples", "relMSE of the samples": "raw:.2e",
            **{method: f"{method}:.2f" for method in METHODS}}
    return ["# What denoising leaves of the relMSE of the samples", "", *tracing.table(summary, columns), "",
            *tracing.table(rows, each)]


if __name__ == "__main__":
    main()
