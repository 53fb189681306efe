"""How load time, memory and frames grow with triangles, materials, lights and textures, by both plans in turn.

    python -m benchmarks.growth [--kinds triangles materials lights textures] [--most N] [--results DIR]

Each scene is a glTF file made for it, and each run a process of its own, so that the memory it tells is its own.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from assets.glb import Glb, Shape

from . import machine, shot, tracing

COUNTS = {"triangles": (1_000, 10_000, 100_000, 1_000_000, 5_000_000), "materials": (1, 10, 50, 200, 1_000),
          "lights": (1, 10, 100, 128, 1_000), "textures": (0, 1, 4, 16, 64)}
COLUMNS = {"count": "count:,", "plan": "plan", "load, s": "load:.2f", "peak memory, MB": "rss_mb:.0f",
           "programs": "programs", "MB on the GPU": "mb:.0f", "first frame, CPU s": "first_cpu:.2f",
           "wall": "first:.2f", "later frame, CPU ms": "later_cpu:.1f", "wall ": "later:.1f"}
SIDE = 2048


def main() -> None:
    options = _parse()
    if options.run:
        _run(*options.run, options)
        return
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory(prefix="growth-") as folder:
        for kind in options.kinds:
            for count in (count for count in COUNTS[kind] if count <= (options.most or count)):
                path = Path(folder) / f"{kind}-{count}.glb"
                _MAKERS[kind](count).save(path)
                for plan in ("needed", "everything"):
                    command = [sys.executable, "-m", "benchmarks.growth", "--run", str(path), plan, "--size",
                               str(options.size), "--frames", str(options.frames)]
                    done = subprocess.run(command, cwd=shot.REPOSITORY, capture_output=True, text=True, check=False)
                    found = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else {}
                    rows.append({"kind": kind, "count": count, "plan": plan} | found)
                    print(rows[-1] if found else done.stderr[-500:], flush=True)
                path.unlink()
    text = ["# Growth"]
    for kind in options.kinds:
        text += ["", f"## {kind.capitalize()}", "", *tracing.table([r for r in rows if r["kind"] == kind], COLUMNS)]
    facts = machine.here() | {"load average": os.getloadavg()[0], "size": f"{options.size}x{options.size}"}
    tracing.keep("growth", facts, rows, text, options.results)


def _run(path: str, plan: str, options: argparse.Namespace) -> None:
    """One scene by one plan; prints a line of JSON."""
    from viewer.gpu.context import open_context
    from viewer.scene.environment_files import load_environment
    from viewer.scene.load import load_scene
    from viewer.settings import Settings

    from .drawing import Viewer, compile_anew
    from .process import high_water_mark

    compile_anew()
    size = options.size, options.size
    environment = load_environment("studio")
    with open_context() as context:
        start = time.perf_counter()
        scene = load_scene(path)
        scene = scene.relit(environment=None if scene.lights else environment)
        load = time.perf_counter() - start
        viewer = Viewer(context, scene, Settings(plan=plan), size)
        for number in range(1, options.frames + 1):
            viewer.draw(number)
        memory = (high_water_mark(os.getpid()) or 0) / 1024
        print(json.dumps({"load": load, "rss_mb": memory} | viewer.frames.to_json()))


def hills(triangles: int) -> Glb:
    """One mesh, a rough ball."""
    glb = Glb()
    glb.node(glb.mesh(_ball(triangles, bumps=0.05), glb.material((0.6, 0.5, 0.4))))
    return glb


def kinds_of_materials(count: int) -> Glb:
    """As many balls as materials, which differ in what they have, not in numbers alone: 200 are of 196 kinds."""
    glb, rng = Glb(), np.random.default_rng(1)
    texture = glb.texture(rng.integers(100, 255, (16, 16, 3), np.uint8))
    names = ("baseColorTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture", "emissiveTexture")
    ball = _ball(200)
    for k in range(count):
        bits = rng.integers(1 << len(names))
        fields: dict = {name: texture for bit, name in enumerate(names) if bits >> bit & 1}
        fields |= {"emissiveFactor": [0.1, 0.1, 0.1], "doubleSided": bool(rng.integers(2)),
                   "alphaMode": ("OPAQUE", "MASK", "BLEND")[rng.integers(3)]}
        material = glb.material(rng.random(3).tolist(), (0.0, 0.5, 1.0)[rng.integers(3)], float(rng.random()), **fields)
        glb.node(glb.mesh(ball, material), translation=_place(k, count))
    return glb


def lamps(count: int) -> Glb:
    """A ball under spots, point and directional lights in turn."""
    glb, rng = Glb(), np.random.default_rng(1)
    glb.node(glb.mesh(_ball(20_000), glb.material((0.6, 0.5, 0.4))))
    for k in range(count):
        eye = rng.normal(size=3)
        eye *= 3 / np.linalg.norm(eye)
        kind = ("spot", "point", "directional")[k % 3]
        glb.light(kind, eye.tolist(), intensity=20.0 / count, **({"spot": {}} if kind == "spot" else {}))
    return glb


def pictures(count: int) -> Glb:
    """As many balls as textures of 2048 x 2048, JPEG; at least one ball."""
    glb, ball = Glb(), _ball(2_000)
    y, x = np.mgrid[0:SIDE, 0:SIDE] / SIDE
    for k in range(max(count, 1)):
        waves = np.stack([0.5 + 0.4 * np.sin((40 + k) * x + 9 * y), y, 0.5 + 0.4 * np.cos(60 * y + k)], axis=-1)
        fields = {"baseColorTexture": glb.texture(waves, jpeg=85)} if count else {}
        glb.node(glb.mesh(ball, glb.material(roughness=0.4, **fields)), translation=_place(k, count))
    return glb


_MAKERS: dict[str, Callable[[int], Glb]] = {
    "triangles": hills, "materials": kinds_of_materials, "lights": lamps, "textures": pictures}


def _ball(triangles: int, bumps: float = 0.0) -> Shape:
    """About so many triangles, with normals and texture coordinates."""
    rows = max(int((triangles / 4) ** 0.5), 2)
    columns = 2 * rows
    v, u = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    theta, phi = np.pi * v, 2 * np.pi * u
    normals = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    radius = 1 + bumps * np.sin(16 * phi) * np.sin(16 * theta)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = corner + columns + 1
    indices = np.stack([corner, below, corner + 1, corner + 1, below, below + 1], axis=1)
    return {"POSITION": (normals * radius[..., None]).reshape(-1, 3).astype(np.float32),
            "NORMAL": normals.reshape(-1, 3).astype(np.float32),
            "TEXCOORD_0": np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
            "indices": indices.ravel().astype(np.uint32)}


def _place(k: int, count: int) -> list[float]:
    side = int(np.ceil(max(count, 1) ** 0.5))
    return [2.2 * (k % side), 2.2 * (k // side), 0.0]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=list(COUNTS), default=list(COUNTS))
    parser.add_argument("--most", type=int, help="no scene of more than this")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    parser.add_argument("--run", nargs=2, help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
