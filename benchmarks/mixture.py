"""What `--denoise raster` leaves of the error of few samples: `python -m benchmarks.mixture`.

The scenes of benchmarks.tell_error and of assets/noise are path traced with 4, 16 and 64 samples a pixel. relMSE over
all pixels, against a reference of independent pictures and other seeds, of the samples, of what `fast` and `raster`
make of them, and of the raster's picture alone, as shares of that of the samples.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from viewer.estimate.mixture import raster_settings, render_mixture
from viewer.estimate.neighbourhood import EPSILON
from viewer.estimate.raster_error import squared_error
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import corpus, tracing
from .machine import until_stopped
from .shot import REPOSITORY
from .tell_error import ENVIRONMENTS, LAMPS, MODELS, REFERENCES, load

NOISE = ("noise/small-lights", "noise/many-lights", "noise/caustics")
SAMPLES = (4, 16, 64)
METHODS = ("raster alone", "fast", "raster")
_SEED = 1 << 21


def main() -> None:
    options = _parse()
    rows: list[dict[str, Any]] = []
    with open_context() as context, until_stopped():
        renderer, tracer = Renderer(context), Tracer(context)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}", "reference":
                                              f"{REFERENCES} times {options.reference_spp} samples a pixel"}
        for name in options.scenes or _scenes():
            rows += _scene(renderer, tracer, name, options)
            tracing.keep("mixture", facts, rows, _page(rows), options.results)


def _scenes() -> list[str]:
    """Each model under one environment, in turn."""
    models = [f"{name}:{ENVIRONMENTS[k % 2]}" for k, name in enumerate(corpus.present(MODELS))]
    lamps = [name for name in LAMPS if name.startswith("noise/") or corpus.present((name.partition(":")[0],))]
    return [*models, *lamps, *NOISE]


def _scene(renderer: Renderer, tracer: Tracer, name: str, options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    scene, camera = load(name)
    size, plain = (options.size, options.size), Settings(mode="path")
    reference = np.stack([tracing.shoot(tracer, scene, camera, replace(
        plain, spp=options.reference_spp, seed=_SEED + k), size).pixels for k in range(REFERENCES)])
    alone = renderer.render(scene, camera, raster_settings(plain), size).linear[..., :3]
    for samples in SAMPLES:
        settings = replace(plain, spp=samples)
        raw = _relmse(tracing.shoot(tracer, scene, camera, settings, size).pixels, reference)
        row: dict[str, Any] = {"scene": name, "samples": samples, "raw": raw,
                                  "raster alone": _relmse(alone, reference) / raw}
        fast = tracer.render(scene, camera, replace(settings, denoise="fast"), size)
        mixed = render_mixture(tracer, renderer, scene, camera, replace(settings, denoise="raster"), size)
        row |= {"fast": _relmse(tracing.radiance(fast), reference) / raw,
                "raster": _relmse(tracing.radiance(mixed), reference) / raw}
        yield row


def _relmse(picture: np.ndarray, reference: np.ndarray) -> float:
    """On average the reference's noise adds nothing."""
    return float((squared_error(picture - reference) / (reference.mean(axis=0) ** 2 + EPSILON)).mean())


def _page(rows: list[dict[str, Any]]) -> list[str]:
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


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mixture", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="as of benchmarks.tell_error")
    parser.add_argument("--size", type=int, default=96, help="of the square pictures, in pixels (96)")
    parser.add_argument("--reference-spp", type=int, default=128, help="samples a pixel of each reference (128)")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
