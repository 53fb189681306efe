"""What benchmarks share that compare pictures of the corpus with a reference of independent path-traced pictures."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import viewer
from viewer.base.resources import resource_folder
from viewer.estimate.neighbourhood import EPSILON
from viewer.estimate.pairs import squared_error
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
REFERENCES = 4
_SEED = 1 << 20

Row = dict[str, Any]
Measure = Callable[[Renderer, Tracer, str, argparse.Namespace], Iterator[Row]]
"""The rows of a scene, by its name and the options."""


def compare(name: str, about: str | None, scenes: Sequence[str], measure: Measure,
            page: Callable[[list[Row]], list[str]]) -> None:
    """Parses the command line of the benchmark `name` and measures the scenes it gives, or else `scenes`. Results are
    kept after each scene."""
    options = _parse(name, about)
    rows: list[Row] = []
    with open_context() as context, until_stopped():
        renderer, tracer = Renderer(context), Tracer(context)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}", "reference":
                                              f"{REFERENCES} times {options.reference_spp} samples a pixel"}
        for scene in options.scenes or scenes:
            rows += measure(renderer, tracer, scene, options)
            tracing.keep(name, facts, rows, page(rows), options.results)


def present(scenes: Sequence[str]) -> list[str]:
    """Those of the scenes that need no model, or one that the corpus has."""
    return [name for name in scenes if name.startswith("noise/") or corpus.present((name.partition(":")[0],))]


def load(name: str) -> tuple[Scene, Camera]:
    """A scene of assets/noise, or a model of the corpus and behind `:` its environment."""
    if name.startswith("noise/"):
        scene = viewer.load(resource_folder("assets") / f"{name}.glb", environment=None)
        return scene, scene.cameras[0]
    model, _, environment = name.partition(":")
    spec = None if environment == "none" else corpus.environment(environment or "studio")
    scene = viewer.load(corpus.model(model), spec)
    return scene, scene.framing_camera(1.0)


def reference_of(tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: int, spp: int) -> np.ndarray:
    """Independent square pictures of `spp` samples a pixel and seeds of their own, (REFERENCES, size, size, 3)."""
    several = [replace(settings, spp=spp, seed=_SEED + k) for k in range(REFERENCES)]
    return np.stack([tracing.shoot(tracer, scene, camera, one, (size, size)).pixels for one in several])


def relative_errors(picture: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """relMSE of each pixel, (...), of (..., 3) and (REFERENCES, ..., 3); on average the reference's noise adds
    nothing."""
    return (squared_error(picture - reference) / (reference.mean(axis=0) ** 2 + EPSILON)).mean(axis=-1)


def _parse(name: str, about: str | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog=f"python -m benchmarks.{name}", description=about)
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help="models of the corpus, as MODEL:ENVIRONMENT, or scenes of assets/, as noise/NAME")
    parser.add_argument("--size", type=int, default=96, help="of the square pictures, in pixels (96)")
    parser.add_argument("--reference-spp", type=int, default=128, help="samples a pixel of each reference (128)")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()
