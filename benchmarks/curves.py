"""Rays a second through curves by both intersectors, and what their trees cost to build: `python -m benchmarks.curves`.

Balls of fur of 10^4 to 10^6 segments: straight long segments, in every direction, and wavy short ones. A wavefront of
65,536 paths has camera rays; rays in all directions from the fibres that those hit; shadow rays from there. Rates are
by the wall clock and, in parentheses, by processor time on all threads, which is the one to compare on a busy machine.
"""

from __future__ import annotations

import argparse
import time
import tracemalloc

import numpy as np

from viewer.gpu.context import Context, open_context
from viewer.scene.curves import Curves
from viewer.scene.scene import Scene
from viewer.trace.layout import FREE, MISS
from viewer.trace.rays.bvh import build_bvh
from viewer.trace.rays.intersect import Intersector, make_intersector
from viewer.trace.scene.curves import TraceCurves, trace_curves
from viewer.trace.scene.geometry import TraceGeometry

from . import machine
from .intersect import ROUNDS, SIDE, Rays, camera_rays, make_wavefront, rate

SIZES = (10_000, 100_000, 1_000_000)


def main() -> None:
    options = _parse()
    print(", ".join(f"{key} {value}" for key, value in machine.here().items()))
    with open_context() as context:
        print(f"{context.renderer}; million rays a second by the wall clock (by processor time), best of {ROUNDS}\n")
        print("| fur | segments | by | ready in s | camera | bounce | shadow | bounce and shadow |")
        print("|---|---|---|---|---|---|---|---|")
        furs = {f"{name} {size:,}": fur(size, points) for size in options.sizes
                for name, points in (("straight", 2), ("wavy", 26))}
        for name, curves in furs.items():
            geometry, rays = TraceGeometry([], [], [], curves=curves), None
            for kind in ("embree", "bvh"):
                start = time.perf_counter()
                intersector = make_intersector(context, geometry, kind=kind)
                ready = time.perf_counter() - start
                rays = rays or make_rays(context, intersector, curves)
                cells = [name, f"{len(curves.first):,}", intersector.name, f"{ready:.2f}"]
                cells += [rate(context, intersector, *pair) for pair in rays.values()]
                print(f"| {' | '.join(cells)} |", flush=True)
                intersector.release()
        print("\n| fur | BVH built in s | most memory meanwhile, MB | texture, MB |\n|---|---|---|---|")
        for name, curves in furs.items():
            geometry = TraceGeometry([], [], [], curves=curves)
            start, processor = time.perf_counter(), time.process_time()
            build_bvh(geometry)
            seconds, processor = time.perf_counter() - start, time.process_time() - processor
            tracemalloc.start()
            texels = build_bvh(geometry).texels
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            built = f"{seconds:.2f} ({processor:.2f})"
            print(f"| {name} | {built} | {peak / 1e6:.0f} | {texels.nbytes / 1e6:.0f} |", flush=True)


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
    origin, direction = camera_rays()
    wavefront = make_wavefront(context, (origin, direction), None)
    intersector.store(wavefront, intersector.trace(intersector.fetch(wavefront)))
    hits = np.frombuffer(wavefront.hit.read(), np.uint32).reshape(-1, 4)
    wavefront.release()
    hit = np.flatnonzero(hits[:, 0] & ~np.uint32(FREE) != MISS)
    a, b = curves.points[hits[hit, 1]], curves.points[hits[hit, 1] + 1]
    # About the point that was hit: where the axis is nearest to the ray, a radius towards the camera
    axis, across = b[:, :3] - a[:, :3], direction[hit]
    normal = np.cross(np.cross(axis, across), axis)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    along = np.clip(np.einsum("ij,ij->i", np.cross(origin[hit] - a[:, :3], across), np.cross(axis, across))
                    / np.maximum(np.einsum("ij,ij->i", *[np.cross(axis, across)] * 2), 1e-20), 0, 1)
    start = a[:, :3] + along[:, None] * axis - 1.01 * a[:, 3:] * normal
    again = np.arange(SIDE * SIDE) * len(hit) // (SIDE * SIDE)  # in the order of the paths
    above = start[again].astype(np.float32)
    bounce, shadow = (rng.normal(size=above.shape).astype(np.float32) for _ in range(2))
    for vectors in (bounce, shadow):
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    return {"camera": ((origin, direction), None), "bounce": ((above, bounce), None),
            "shadow": (None, (above, 4 * shadow)), "both": ((above, bounce), (above, 4 * shadow))}


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.curves", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="segments of the balls")
    return parser.parse_args()


if __name__ == "__main__":
    main()
