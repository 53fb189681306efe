"""How well the rasterizer shows stretched reflections of an environment, and what they cost: python -m
benchmarks.anisotropy. A metal ball, brushed along its circles of latitude, is compared with path tracing of one bounce,
for several numbers of the narrow lobes that stand for the stretched one.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.measure.check.scenes import scene, sphere
from viewer.plan import planner
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment_files import load_environment
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import tracing
from .shot import REPOSITORY, default_environment

SIZE, LOBES, FRAMES = 128, (1, 4, 8, 16, 32), 40
BRUSHED = [(roughness, strength) for roughness in (0.1, 0.3, 0.5, 0.7) for strength in (0.5, 1.0)]
PLANNED = planner.lookups
COLUMNS = {"roughness": "roughness:.1f", "strength": "strength:.1f", "planned lobes": "planned",
           **{f"relMSE, {k} lobe{'s' * (k > 1)}": f"relmse_{k}:.4f" for k in LOBES},
           **{f"ms, {k}": f"ms_{k}:.2f" for k in LOBES}, "isotropic, ms": "isotropic_ms:.2f"}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.anisotropy", description=__doc__)
    parser.add_argument("--spp", type=int, default=400, help="samples per pixel of the references (400)")
    parser.add_argument("--env", default=default_environment())
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    with open_context() as context:
        for roughness, strength in BRUSHED:
            model = _ball(roughness, strength, options.env)
            reference = viewer.render(model, (SIZE, SIZE), _camera(), mode="path", spp=options.spp, bounces=1,
                                      background="none").linear
            planned = PLANNED(model.materials[0], Settings())
            row: dict[str, object] = {"roughness": roughness, "strength": strength, "planned": planned}
            for lobes in LOBES:
                planner.lookups = lambda material, settings, lobes=lobes: lobes
                renderer = Renderer(context)
                row[f"relmse_{lobes}"] = _relmse(_picture(renderer, model, "ssaa-4"), reference)
                row[f"ms_{lobes}"] = _milliseconds(renderer, model)
                renderer.release()
            renderer = Renderer(context)
            row["isotropic_ms"] = _milliseconds(renderer, _ball(roughness, 0.0, options.env))
            renderer.release()
            rows.append(row)
        conditions = tracing.conditions(Tracer(context))
    tracing.keep("anisotropy", conditions, rows, ["# Stretched reflections of an environment", "",
                                                  *tracing.table(rows, COLUMNS)], options.results)


def _ball(roughness: float, strength: float, environment: str) -> Scene:
    material = Material(base_color=(1.0, 0.9, 0.8, 1.0), perceptual_roughness=roughness, anisotropy_strength=strength)
    return scene([_brushed(sphere())], [material], environment=load_environment(environment))


def _brushed(ball: Mesh) -> Mesh:
    """The ball with tangents along its circles of latitude."""
    x, _, z = ball.positions.T
    along = np.stack([z, 0 * x, -x], axis=1)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 1e-6, along / np.maximum(length, 1e-9), [1.0, 0.0, 0.0])
    return replace(ball, tangents=np.column_stack([along, np.ones(len(along))]).astype(np.float32))


def _camera() -> Camera:
    return Camera.framing(np.zeros(3), 1.0, 1.0)


def _picture(renderer: Renderer, model: Scene, antialias: str) -> np.ndarray:
    return renderer.render(model, _camera(), Settings.of(background="none", antialias=antialias), (SIZE, SIZE)).linear


def _relmse(picture: np.ndarray, reference: np.ndarray) -> float:
    """Over the ball's pixels."""
    inside = reference[..., 3] > 0.99
    a, b = picture[inside][:, :3], reference[inside][:, :3]
    return float(np.mean((a - b) ** 2 / (b**2 + 0.01)))


def _milliseconds(renderer: Renderer, model: Scene) -> float:
    """The median wall time of a frame with one sample per pixel, read back."""
    times = []
    for _ in range(FRAMES + 3):
        start = time.perf_counter()
        _picture(renderer, model, "none")
        times.append((time.perf_counter() - start) * 1e3)
    return float(np.median(times[3:]))


if __name__ == "__main__":
    main()
