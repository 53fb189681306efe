"""Many lights: noise at equal time against other ways to choose one, and what a picture costs: `python -m
benchmarks.lights`.

The scene is a hall with pillars, made here, with any number of small emissive tiles or of point and spot lights; some
are a hundred times as strong as others, and all together give the same light. Errors are relMSE against a long render
of our own, of other seeds. Noise is its root, for one second of work: the relMSE of a picture times its seconds.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

import numpy as np

from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import relmse
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings
from viewer.trace.scene import lights as scene_lights
from viewer.trace.tracer import Tracer

from . import machine, tracing
from .shot import REPOSITORY

HALF = np.array([10.0, 2.5, 10.0])
"""Half the sides of the hall, in metres."""
CAMERA = Camera.look_at((0.0, 1.6, 9.0), (0.0, -2.5, 2.0), fov_y=math.radians(45))
"""It sees the floor and pillars. Small lamps that are seen themselves would add noise of their own, however chosen."""
TABLE = scene_lights.light_table


@contextmanager
def _by_tree() -> Iterator[None]:
    with patch.object(scene_lights, "MOST_BY_POWER", 1):
        yield


@contextmanager
def _by_power() -> Iterator[None]:
    with patch.object(scene_lights, "MOST_BY_POWER", 1 << 40):
        yield


@contextmanager
def _uniform() -> Iterator[None]:
    even = patch.object(scene_lights, "light_table", lambda powers, share: TABLE((powers > 0).astype(float), share))
    with _by_power(), even:
        yield


METHODS: dict[str, Callable] = {"uniform": _uniform, "power": _by_power, "tree": _by_tree}


def main() -> None:
    options = _parse()
    seconds = machine.by_processor_time() if options.processor else "by the clock"
    rows: list[dict[str, object]] = []
    with open_context() as context:
        tracer = Tracer(context)
        for kind in options.kinds.split(","):
            rows += _kind(tracer, kind, options)
        facts = tracing.conditions(tracer) | {"size": f"{options.size}x{options.size}", "seconds": seconds}
    columns = {"lights": "kind", "number": "count:,", "noise of the uniform choice": "uniform:.3f",
               "of the choice by power": "power:.3f", "of the tree": "tree:.3f", "uniform / tree": "gain:.1f",
               "power / tree": "gain over power:.1f", "spp/s by power": "power spp:.1f",
               "spp/s of the tree": "tree spp:.1f",
               "preparing, s": "prepare:.2f", "16 samples, s": "picture:.2f", "of that with 10": "price:.2f"}
    text = ["# Many lights", "",
            f"Noise (root of relMSE) of one second of work, from pictures of {options.spp} samples, median of "
            f"{options.rounds} seeds, with the least time of these. The last columns are as the viewer chooses: "
            "preparing the scene, and a picture of 16 samples with that, beside the one with 10 lights.",
            "", *tracing.table(rows, columns)]
    tracing.keep("lights", facts, rows, text, options.results)


def _kind(tracer: Tracer, kind: str, options: argparse.Namespace) -> list[dict[str, object]]:
    size, rows = (options.size, options.size), []
    for count in options.counts:
        row: dict[str, object] = {"kind": kind, "count": count}
        with _by_tree() if count > 1 else _by_power():
            reference = tracing.shoot(tracer, hall(kind, count), CAMERA, Settings.of(
                mode="path", spp=options.reference_spp, seed=1000), size).pixels
        shots: dict[str, list[tracing.Shot]] = {}
        for k in range(-1, options.rounds):  # the first round warms up
            for method, chosen in METHODS.items():
                if method == "tree" and count < 2:
                    continue
                with chosen():
                    shot = tracing.shoot(tracer, hall(kind, count), CAMERA, Settings.of(
                        mode="path", spp=options.spp if k >= 0 else 1, seed=max(k, 0)), size)
                shots.setdefault(method, []).extend([shot] * (k >= 0))
        for method, taken in shots.items():
            seconds = min(shot.seconds for shot in taken)  # least disturbed
            row[method] = math.sqrt(statistics.median(relmse(shot.pixels, reference) for shot in taken) * seconds)
            row[f"{method} spp"] = options.spp / seconds
        if "tree" in row:
            row["gain"], row["gain over power"] = (row[name] / row["tree"] for name in ("uniform", "power"))
        prepared, whole = zip(*(_price(tracer, kind, count, size) for _ in range(options.rounds)))
        row["prepare"], row["picture"] = min(prepared), min(whole)
        rows.append(row)
    ten = next((row["picture"] for row in rows if row["count"] == 10), None)
    for row in rows:
        row["price"] = None if ten is None else row["picture"] / ten
    return rows


def _price(tracer: Tracer, kind: str, count: int, size: tuple[int, int]) -> tuple[float, float]:
    """Seconds to prepare a picture of the hall, and to make it with 16 samples."""
    scene, settings = hall(kind, count), Settings.of(mode="path", spp=16)
    started = time.perf_counter()
    exposure = tracer.begin(scene, CAMERA, settings, size)
    try:
        prepared = time.perf_counter() - started
        while not exposure.is_done:
            exposure.step(tracing.SLICE)
        exposure.image()
        return prepared, time.perf_counter() - started
    finally:
        exposure.release()


def hall(kind: str, count: int) -> Scene:
    """A hall with `count` lights in its upper half: "tiles", emissive triangles on the walls and below the ceiling, or
    "lamps", point and spot lights anywhere."""
    rng = np.random.default_rng(count)
    boxes = [(np.zeros(3), HALF, True)] + [(np.array([x, 0.0, z]), np.array([0.4, HALF[1], 0.4]), False)
                                           for x in (-6.0, -2.0, 2.0, 6.0) for z in (-6.0, -2.0, 2.0)]
    white = Material(base_color=(0.7, 0.7, 0.7, 1.0), metallic=0.0, perceptual_roughness=1.0, specular=0.0)
    meshes = [_mesh("hall", np.concatenate([_box(*box) for box in boxes]), 0)]
    strengths = 10 ** rng.uniform(-2, 0, count)
    strengths /= strengths.sum()
    materials, lights = [white], []
    if kind == "tiles":
        corners, area = _tiles(count, rng)
        levels = np.digitize(strengths, np.quantile(strengths, np.linspace(0, 1, 9)[1:-1]))
        for level in np.unique(levels):
            meshes.append(_mesh(f"tiles {level}", corners[levels == level], len(materials)))
            radiance = 100.0 * float(strengths[levels == level].mean()) / area
            materials.append(Material(base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0,
                                      emissive=(radiance,) * 3))
    else:
        places = rng.uniform((-9.5, 0.0, -9.5), (9.5, 2.2, 9.5), (count, 3)).tolist()
        directions = rng.normal(size=(count, 3)) - (0.0, 2.0, 0.0)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        lights = [Light(("point", "spot")[k % 2], intensity=60.0 * float(strength), position=tuple(place),
                        direction=tuple(direction), inner_cone=0.4, outer_cone=0.8)
                  for k, (strength, place, direction) in enumerate(zip(strengths, places, directions.tolist()))]
    return Scene(f"hall with {count} {kind}", tuple(meshes), tuple(materials),
                 tuple(Instance(k, np.eye(4)) for k in range(len(meshes))), lights=tuple(lights))


def _tiles(count: int, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Triangles (count, 3, 3) a centimetre off the ceiling and the walls, that face inwards, and the area of each."""
    axis = rng.choice([1, 0, 2], count, p=[0.6, 0.2, 0.2])
    side = np.where(axis == 1, 1.0, rng.choice([-1.0, 1.0], count))
    center = rng.uniform(-0.95, 0.95, (count, 3)) * HALF
    center[:, 1] = np.abs(center[:, 1])
    center[np.arange(count), axis] = side * (HALF[axis] - 0.01)
    half = min(0.05, 2.0 / math.sqrt(count))
    angles = rng.uniform(0, 2 * np.pi, count)[:, None] + np.array([0.0, 2.0, 4.0]) * np.pi / 3
    offsets = np.zeros((count, 3, 3))
    rows = np.arange(count)[:, None]
    first, second = (axis + 1) % 3, (axis + 2) % 3
    # Counter-clockwise about +axis; lights on the upper side face the other way.
    offsets[rows, [[0, 1, 2]], first[:, None]] = half * np.cos(angles)
    offsets[rows, [[0, 1, 2]], second[:, None]] = half * np.sin(angles) * -side[:, None]
    return center[:, None] + offsets, 3 * math.sqrt(3) / 4 * half**2


def _box(center: np.ndarray, half: np.ndarray, is_room: bool) -> np.ndarray:
    """The triangles of a box, (12, 3, 3), seen from outside, or from inside if it is a room."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half + center
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = corners[[part for p, q, r, s in faces for part in ((p, q, r), (p, r, s))]]
    return triangles[:, ::-1] if is_room else triangles


def _mesh(name: str, triangles: np.ndarray, material: int) -> Mesh:
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(name, triangles.reshape(-1, 3).astype(np.float32), material,
                normals=np.repeat(normals, 3, axis=0).astype(np.float32))


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.lights", description=__doc__)
    parser.add_argument("--size", type=int, default=96, help="of the square pictures, in pixels (96)")
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel of each picture (64)")
    parser.add_argument("--counts", type=lambda text: [int(part) for part in text.split(",")],
                        default=[1, 4, 10, 32, 100, 1000, 10000], help="numbers of lights, with commas")
    parser.add_argument("--kinds", default="tiles,lamps", help="tiles, lamps or both, with a comma")
    parser.add_argument("--reference-spp", type=int, default=2048, help="samples a pixel of the references (2048)")
    parser.add_argument("--rounds", type=int, default=3, help="seeds a method (3)")
    parser.add_argument("--processor", action="store_true", help="seconds are those of processor time")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
