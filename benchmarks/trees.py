"""What a moving part costs Embree: python -m benchmarks.trees. Beside one tree of all triangles, built anew for each
pose, stand two: one of what stands still, kept, and one of what moves. Every ray is traced through both of them.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

import viewer
from viewer.gpu.context import open_context
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.rays.flatten import flatten
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.tracer import Tracer

from . import tracing
from .intersect import bumpy_sphere
from .shot import REPOSITORY

PATHS, ROUNDS, SIZE, SAMPLES = 65_536, 11, 256, 16
MODELS = REPOSITORY.parent / "shared/corpus/models"
SCENES = {"animated spheres": ("blender-animation-pointer/24_animation_pointer.gltf", 0),
          "FlightHelmet and a moving ball": ("FlightHelmet/FlightHelmet.gltf", 1_000),
          "skinned Alien_Scolitex": ("alien-scolitex/Alien_Scolitex.gltf", 0)}
"""Each a model of the corpus, and the triangles of the ball that moves beside it."""

COLUMNS = {"scene": "scene:", "triangles": "triangles:,", "of them moving": "moving:,", "all built, ms": "all_ms:.1f",
           "moving built, ms": "moving_ms:.1f", "one tree traced, ms": "one_ms:.1f", "two traced, ms": "two_ms:.1f",
           "two pay below … samples": "even:.1f", f"picture of {SAMPLES} samples, ms": "picture_ms:.0f"}

Triangles = tuple[np.ndarray, np.ndarray]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trees", description=__doc__)
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    with open_context() as context:
        tracer = Tracer(context)
        rows = [_measure(tracer, name, viewer.load(MODELS / path), ball) for name, (path, ball) in SCENES.items()]
        conditions = tracing.conditions(tracer)
    text = ["# Embree's trees for what moves", "", *tracing.table(rows, COLUMNS), "",
            f"Medians of {ROUNDS} rounds, in turn. Traced are the nearest hit and the shadow ray of {PATHS:,} paths",
            "from a sphere around the model. Two trees pay below so many samples of",
            f"{SIZE} x {SIZE} pixels, if a path has four segments. What is built includes embreex's own copy of",
            "each triangle. Where all moves, there is nothing to keep, and the two trees are one."]
    tracing.keep("trees", conditions, rows, text, options.results)


def _measure(tracer: Tracer, name: str, scene: Scene, ball: int) -> dict[str, object]:
    still, moving = _parts(scene, ball)
    both = _joined(still, moving)
    one, kept = _tree(both), _tree(still)
    other = _tree(moving)
    rng = np.random.default_rng(0)
    origins = rng.normal(size=(PATHS, 3))
    origins /= np.linalg.norm(origins, axis=1, keepdims=True)
    vectors = (0.4 * rng.normal(size=(PATHS, 3)) - origins).astype(np.float32)
    origins = origins.astype(np.float32)

    def through_one() -> None:
        _run(one, origins, vectors)
        _occluded(one, origins, vectors)

    def through_two() -> None:
        if kept is None:
            return through_one()
        found = _run(kept, origins, vectors)
        nearer = _run(other, origins, vectors, found["tfar"].copy())
        hit = np.flatnonzero(nearer["primID"] >= 0)
        for key in ("primID", "u", "v", "tfar"):
            found[key][hit] = nearer[key][hit]
        open_still = np.flatnonzero(~_occluded(kept, origins, vectors))
        _occluded(other, origins.take(open_still, axis=0), vectors.take(open_still, axis=0))
        return None

    camera, settings = scene.framing_camera(1.0), Settings.of(mode="path", spp=SAMPLES)
    calls = [lambda: _tree(both), lambda: _tree(moving), through_one, through_two,
             lambda: tracer.render(scene, camera, settings, (SIZE, SIZE))]
    rounds = [[_seconds(call) for call in calls] for _ in range(ROUNDS + 1)][1:]
    all_ms, moving_ms, one_ms, two_ms, picture_ms = (1e3 * np.median(rounds, axis=0)).tolist()
    segments = 4 * SIZE * SIZE / PATHS
    even = (all_ms - moving_ms) / (two_ms - one_ms) / segments if kept is not None and two_ms > one_ms else None
    return {"scene": name, "triangles": len(both[1]), "moving": len(moving[1]), "all_ms": all_ms,
            "moving_ms": moving_ms, "one_ms": one_ms, "two_ms": two_ms, "even": even, "picture_ms": picture_ms}


def _parts(scene: Scene, ball: int) -> tuple[Triangles, Triangles]:
    """What stands still and what moves, in the tracer space of the scene at rest."""
    geometry = trace_geometry(scene)
    numbered = list(enumerate(geometry.instances))
    if ball:
        still = flatten(geometry, numbered)[:2]
        sphere = flatten(bumpy_sphere(ball)[0], [(0, bumpy_sphere(ball)[0].instances[0])])[:2]
        return still, ((0.2 * sphere[0] + [0.5, 0.3, 0.4]).astype(np.float32), sphere[1])
    pose = scene.at(0.4 * scene.animations[0].duration)
    moves = [before is not after or scene.meshes[before.mesh] is not pose.meshes[after.mesh]
             for before, after in zip(scene.instances, pose.instances, strict=True)]
    still, moving = (flatten(geometry, [(k, x) for k, x in numbered if moves[x.source] is which])[:2]
                     for which in (False, True))
    return still, moving


def _joined(first: Triangles, second: Triangles) -> Triangles:
    return np.concatenate([first[0], second[0]]), np.concatenate([first[1], second[1] + np.int32(len(first[0]))])


def _tree(triangles: Triangles) -> EmbreeScene | None:
    vertices, corners = triangles
    if not len(corners):
        return None
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, vertices, corners)
    _occluded(scene, vertices[:1], vertices[:1])
    return scene


def _run(tree: EmbreeScene, origins: np.ndarray, vectors: np.ndarray,
         reach: np.ndarray | None = None) -> dict[str, np.ndarray]:
    return tree.run(origins, vectors, reach, query="INTERSECT", output=True)


def _occluded(tree: EmbreeScene, origins: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    return tree.run(origins, vectors, 1.0, query="OCCLUDED") >= 0


def _seconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
