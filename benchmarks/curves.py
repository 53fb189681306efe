"""Rays a second through curves by both intersectors, what their trees cost to build, and the time of a picture:
`python -m benchmarks.curves [MODEL...]`.

Balls of fur: straight long segments in every direction, and wavy short ones. A wavefront of 65,536 paths has camera
rays; rays in all directions from the fibres that those hit; shadow rays from there. Rates are by the wall clock and, in
parentheses, by processor time on all threads, which is the one to compare on a busy machine. MODELs are path traced at
64 samples, 256 x 256.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

import viewer
from viewer.gpu.context import Context, open_context
from viewer.scene.curves import Curves
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.rays.bvh import build_bvh
from viewer.trace.rays.intersect import Intersector, make_intersector
from viewer.trace.scene.curves import TraceCurves, trace_curves
from viewer.trace.scene.geometry import TraceGeometry
from viewer.trace.tracer import Tracer

from . import tracing
from .intersect import Rays, camera_hits, columns, in_order_of_paths, rate
from .shot import REPOSITORY

T = TypeVar("T")

SIZES = (10_000, 100_000)
LARGEST = 1_000_000
POINTS = {"straight": 2, "wavy": 26}
RATES = {"fur": "fur", "segments": "segments:,", "by": "by", "ready in s": "ready:.2f", "camera": "camera",
         "bounce": "bounce", "shadow": "shadow", "bounce and shadow": "both"}
TREES = {"fur": "fur", "segments": "segments:,", "boxes": "boxes:,", "in tracer space in s": "flattened:.1f",
         "Embree built in s": "embree:.1f", "BVH built in s": "bvh:.1f", "texture, MB": "megabytes:.0f",
         "most memory of the process, MB": "resident:.0f"}
PICTURES = {"model": "model", "segments": "segments:,", "rays": "rays:,", "s": "wall:.1f",
            "processor s": "processor:.1f", "estimated error": "error:.3f"}


def main() -> None:
    options = _parse()
    trees = [_tree(name, points, options.largest) for name, points in POINTS.items()] if options.largest else []
    with open_context() as context:
        tracer = Tracer(context)
        pictures = [_picture(tracer, model) for model in options.models]
        rates = [row for size in options.sizes for name, points in POINTS.items()
                 if points > 2 or size <= options.sizes[0]
                 for row in _rates(context, f"{name} {size:,}", fur(size, points))]
        command = " ".join(["python -m benchmarks.curves", *(model.name for model in options.models)])
        facts = tracing.conditions(tracer) | {"command": command}
        tracer.release()
    about = "Million rays a second by the wall clock (by processor time), the best of six:"
    text = ["# Rays through curves", "", about, "", *tracing.table(rates, RATES), "", "Trees, by processor time:", "",
            *tracing.table(trees, TREES)]
    if pictures:
        text += ["", "Path traced, 64 samples, 256 x 256, from the model in memory to the picture:", "",
                 *tracing.table(pictures, PICTURES)]
    tracing.keep("curves", facts, [*rates, *trees, *pictures], text, options.results)


def _tree(name: str, points: int, size: int) -> dict[str, object]:
    from viewer.trace.rays.embree_curves import EmbreeCurves

    curves, flattened = _timed(lambda: fur(size, points))
    _, embree = _timed(lambda: EmbreeCurves(curves))
    bvh, seconds = _timed(lambda: build_bvh(TraceGeometry([], [], [], curves=curves)))
    return {"fur": name, "segments": len(curves.first), "boxes": bvh.points - bvh.curves, "flattened": flattened,
            "embree": embree, "bvh": seconds, "megabytes": bvh.texels.nbytes / 1e6,
            "resident": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3}


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    """What `work` returns, and the processor time that it took."""
    start = time.process_time()
    result = work()
    return result, time.process_time() - start


def _picture(tracer: Tracer, model: Path) -> dict[str, object]:
    scene = viewer.load(model)
    settings = Settings.of(mode="path", spp=64)
    start, processor = time.perf_counter(), time.process_time()
    image = tracer.render(scene, scene.framing_camera(1.0), settings, (256, 256))
    curves = trace_curves(scene)
    return {"model": model.name, "segments": 0 if curves is None else len(curves.first), "rays": image.stats["rays"],
            "wall": time.perf_counter() - start, "processor": time.process_time() - processor,
            "error": image.stats["estimated_error"]["relative"]}


def _rates(context: Context, name: str, curves: TraceCurves) -> list[dict[str, object]]:
    geometry = TraceGeometry([], [], [], curves=curves)
    rows: list[dict[str, object]] = []
    rays: dict[str, tuple[Rays | None, Rays | None]] | None = None
    for kind in ("embree", "bvh"):
        start = time.perf_counter()
        intersector = make_intersector(context, geometry, kind=kind)
        ready = time.perf_counter() - start
        rays = rays or make_rays(context, intersector, curves)
        rows.append({"fur": name, "segments": len(curves.first), "by": intersector.name, "ready": ready}
                    | {column: rate(context, intersector, *pair) for column, pair in rays.items()})
        intersector.release()
    return rows


def fur(segments: int, points: int, seed: int = 0) -> TraceCurves:
    """A ball of about so many segments, in strands of `points` points that stand on a ball of half its radius."""
    rng = np.random.default_rng(seed)
    count = max(segments // (points - 1), 1)
    root = rng.normal(size=(count, 1, 3))
    root /= np.linalg.norm(root, axis=2, keepdims=True)
    s = np.linspace(0, 1, points)[None, :, None]
    waves = 0.03 * np.sin(25 * s + rng.uniform(0, 6.3, (count, 1, 3))) if points > 2 else 0.0
    line = root * (0.5 + 0.5 * s) + s * (waves + 0.3 * rng.normal(size=(count, 1, 3)))
    radii = np.full(count * points, 0.6 / np.sqrt(count) / 4)
    curves = Curves("fur", line.reshape(-1, 3), radii, points * np.arange(count + 1), np.zeros(count, bool))
    traced = trace_curves(Scene("fur", curves=(curves,)))
    assert traced is not None
    return traced


def make_rays(context: Context, intersector: Intersector, curves: TraceCurves
              ) -> dict[str, tuple[Rays | None, Rays | None]]:
    """For each column the rays and the shadow rays, (SIDE^2, 3) each of origins and of directions or vectors."""
    rng = np.random.default_rng(0)
    camera, hits, hit = camera_hits(context, intersector)
    origin, direction = camera[0][hit], camera[1][hit]
    a, b = curves.points[hits[:, 1]], curves.points[hits[:, 1] + 1]
    # About the point that was hit: where the axis is nearest to the ray, a radius towards the camera
    axis, across = b[:, :3] - a[:, :3], direction
    normal = np.cross(np.cross(axis, across), axis)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    along = np.clip(np.einsum("ij,ij->i", np.cross(origin - a[:, :3], across), np.cross(axis, across))
                    / np.maximum(np.einsum("ij,ij->i", *[np.cross(axis, across)] * 2), 1e-20), 0, 1)
    start = a[:, :3] + along[:, None] * axis - 1.01 * a[:, 3:] * normal
    above = in_order_of_paths(start).astype(np.float32)
    bounce, shadow = (rng.normal(size=above.shape).astype(np.float32) for _ in range(2))
    for vectors in (bounce, shadow):
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    return columns(camera, above, bounce, shadow)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.curves", description=__doc__)
    parser.add_argument("models", nargs="*", type=Path, help="files of curves to path trace")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="segments of the balls")
    parser.add_argument("--largest", type=int, default=LARGEST, help="segments that trees are built over; 0: none")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
