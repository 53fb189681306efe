"""Rays a second through both intersectors, and what the BVH costs to build: `python -m benchmarks.intersect`.

A wavefront of 65,536 paths: camera rays; diffuse bounces from what they hit; shadow rays from there; bounces and shadow
rays together, as the tracer has them. On bumpy spheres of 10^3 to 10^6 triangles, and on FlightHelmet where a corpus
lies beside the checkout. Rates are by the wall clock and, in parentheses, by processor time on all threads, which is
the one to compare on a busy machine.
"""

from __future__ import annotations

import argparse
import time
import tracemalloc
from functools import partial

import numpy as np
from numpy.typing import NDArray

import viewer
from viewer.gpu.context import Context, open_context
from viewer.trace.layout import ENDED, FREE, INSTANCE_MASK, MISS, TILE
from viewer.trace.paths.wavefront import STATE, Wavefront
from viewer.trace.rays.bvh import build_bvh
from viewer.trace.rays.intersect import Intersector, make_intersector
from viewer.trace.scene.geometry import TraceGeometry, TraceInstance, TraceMesh, trace_geometry
from viewer.trace.scene.scene_data import SceneData

from . import machine, shot

SIZES = (1_000, 10_000, 100_000, 1_000_000)
SIDE = 256
ROUNDS = 5
HELMET = shot.REPOSITORY.parent / "shared/corpus/models/FlightHelmet/FlightHelmet.gltf"

Rays = tuple[NDArray[np.float32], NDArray[np.float32]]


def main() -> None:
    options = _parse()
    print(", ".join(f"{key} {value}" for key, value in machine.here().items()))
    with open_context() as context:
        scenes = {f"sphere {size:,}": partial(bumpy_sphere, size) for size in options.sizes}
        if HELMET.is_file():
            scenes["FlightHelmet"] = partial(helmet, context)
        print(f"{context.renderer}; million rays a second by the wall clock (by processor time), best of {ROUNDS}\n")
        print("| scene | triangles | by | ready in s | camera | bounce | shadow | bounce and shadow |")
        print("|---|---|---|---|---|---|---|---|")
        for name, make in scenes.items():
            geometry, surfaces = make()
            rays: dict[str, tuple[Rays | None, Rays | None]] | None = None
            for kind in ("embree", "bvh"):
                start = time.perf_counter()
                intersector = make_intersector(context, geometry, surfaces, kind)
                ready = time.perf_counter() - start
                rays = rays or make_rays(context, intersector, geometry)
                cells = [name, f"{geometry.triangle_count:,}", intersector.name, f"{ready:.2f}"]
                cells += [rate(context, intersector, *pair) for pair in rays.values()]
                print(f"| {' | '.join(cells)} |", flush=True)
                intersector.release()
        print("\n| scene | BVH built in s | most memory meanwhile, MB | texture, MB |\n|---|---|---|---|")
        for name, make in scenes.items():
            geometry, _ = make()
            start, processor = time.perf_counter(), time.process_time()
            build_bvh(geometry)
            seconds, processor = time.perf_counter() - start, time.process_time() - processor
            tracemalloc.start()
            texels = build_bvh(geometry).texels
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            built = f"{seconds:.2f} ({processor:.2f})"
            print(f"| {name} | {built} | {peak / 1e6:.0f} | {texels.nbytes / 1e6:.0f} |", flush=True)


def bumpy_sphere(triangles: int) -> tuple[TraceGeometry, None]:
    """About so many triangles, with bumps of several sizes so that rays hit more than once."""
    rows = max(2, round((triangles / 4) ** 0.5))
    columns = 2 * rows
    theta, phi = np.meshgrid(np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns + 1) / columns,
                             indexing="ij")
    radius = 0.7 + 0.1 * np.sin(5 * theta) * np.cos(6 * phi) + 0.05 * np.sin(23 * theta) * np.sin(31 * phi)
    sine = np.sin(theta)
    points = radius[..., None] * np.stack([sine * np.cos(phi), np.cos(theta), sine * np.sin(phi)], axis=-1)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = corner + columns + 1
    quads = np.stack([corner, corner + 1, below, corner + 1, below + 1, below], axis=1)
    mesh = TraceMesh(points.reshape(-1, 3).astype(np.float32), quads.reshape(-1, 3).astype(np.uint32))
    return TraceGeometry([mesh], [TraceInstance(0, np.eye(3, 4))], []), None


def helmet(context: Context) -> tuple[TraceGeometry, SceneData]:
    """FlightHelmet, whose goggles are see-through."""
    scene = viewer.load(HELMET)
    geometry = trace_geometry(scene)
    surfaces = SceneData(context, scene, geometry)
    surfaces.upload()
    return geometry, surfaces


def make_rays(
    context: Context, intersector: Intersector, geometry: TraceGeometry
) -> dict[str, tuple[Rays | None, Rays | None]]:
    """For each column the rays and the shadow rays, (SIDE^2, 3) each of origins and of directions or vectors."""
    rng = np.random.default_rng(0)
    camera, hits, hit = camera_hits(context, intersector)
    start, normal = _surface(geometry, hits, camera[1][hit])
    start, normal = in_order_of_paths(start), in_order_of_paths(normal)
    bounce, shadow = (_normalized(normal + _normalized(rng.normal(size=normal.shape))) for _ in range(2))
    return columns(camera, (start + 1e-5 * normal).astype(np.float32), bounce, shadow)


def camera_hits(context: Context, intersector: Intersector) -> tuple[Rays, np.ndarray, np.ndarray]:
    """The camera's rays, what those that meet anything hit, (N, 4) uint32, and which these are, (N,)."""
    camera = camera_rays()
    wavefront = make_wavefront(context, camera, None)
    intersector.store(wavefront, intersector.trace(intersector.fetch(wavefront)))
    hits = np.frombuffer(wavefront.hit.read(), np.uint32).reshape(-1, 4)
    wavefront.release()
    hit = np.flatnonzero(hits[:, 0] & ~np.uint32(FREE) != MISS)
    return camera, hits[hit], hit


def in_order_of_paths(points: np.ndarray) -> np.ndarray:
    """(SIDE^2, 3) of these, each as often as the others."""
    return points[np.arange(SIDE * SIDE) * len(points) // (SIDE * SIDE)]


def columns(camera: Rays, start: np.ndarray, bounce: np.ndarray, shadow: np.ndarray
            ) -> dict[str, tuple[Rays | None, Rays | None]]:
    """The rays and the shadow rays of each column, of directions in which rays leave `start`."""
    return {"camera": (camera, None), "bounce": ((start, bounce), None),
            "shadow": (None, (start, 4 * shadow)), "both": ((start, bounce), (start, 4 * shadow))}


def camera_rays() -> Rays:
    """Rays from a camera that sees the unit ball."""
    across = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = np.meshgrid(across, across)
    origin = np.tile(np.float32([0, 0, 2.6]), (SIDE * SIDE, 1))
    return origin, _normalized(np.stack([0.4 * x.ravel(), 0.4 * y.ravel(), np.full(x.size, -1.0)], axis=1))


def rate(context: Context, intersector: Intersector, rays: Rays | None, shadow: Rays | None) -> str:
    wavefront = make_wavefront(context, rays, shadow)
    count = SIDE * SIDE * ((rays is not None) + (shadow is not None))
    walls, processors = [], []
    for _ in range(ROUNDS + 1):
        wall, processor = time.perf_counter(), time.process_time()
        intersector.store(wavefront, intersector.trace(intersector.fetch(wavefront)))
        context.gl.finish()
        walls.append(time.perf_counter() - wall)
        processors.append(time.process_time() - processor)
    wavefront.release()
    return f"{count / min(walls) / 1e6:.2f} ({count / min(processors) / 1e6:.2f})"


def make_wavefront(context: Context, rays: Rays | None, shadow: Rays | None) -> Wavefront:
    wavefront = Wavefront(context, SIDE // TILE, SIDE // TILE, textures=len(STATE), has_layers=False)
    nothing = np.zeros((SIDE * SIDE, 3), np.float32)
    origin, direction = rays or (nothing, nothing)
    shadow_origin, shadow_vector = shadow or (nothing, nothing)
    state = 1.0 if rays is not None else float(ENDED)
    for texture, values in ((wavefront.origin, origin), (wavefront.direction, direction),
                            (wavefront.shadow_origin, shadow_origin), (wavefront.shadow_vector, shadow_vector)):
        texture.write(np.pad(values, ((0, 0), (0, 1)), constant_values=state).astype(np.float32))
    return wavefront


def _surface(
    geometry: TraceGeometry, hits: NDArray[np.uint32], direction: NDArray[np.float32]
) -> tuple[NDArray, NDArray]:
    """Points hit, and unit normals on the side that the rays came from, (hits, 3) float64."""
    point, normal = np.empty((2, len(hits), 3))
    u, v = hits[:, 2:].view(np.float32).astype(np.float64).T
    for index, instance in enumerate(geometry.instances):
        here = hits[:, 0] & INSTANCE_MASK == index
        mesh = geometry.meshes[instance.mesh]
        corners = mesh.positions[mesh.triangles[hits[here, 1]]] @ instance.transform[:, :3].T
        a, b, c = (corners + instance.transform[:, 3]).transpose(1, 0, 2)
        point[here] = a + u[here, None] * (b - a) + v[here, None] * (c - a)
        normal[here] = np.cross(b - a, c - a)
    normal *= -np.sign(np.sum(normal * direction, axis=1, keepdims=True))
    return point, _normalized(normal).astype(np.float64)


def _normalized(vectors: NDArray) -> NDArray[np.float32]:
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.intersect", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="triangles of the spheres")
    return parser.parse_args()


if __name__ == "__main__":
    main()
