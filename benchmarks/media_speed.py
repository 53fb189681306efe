"""Paths in media against Mitsuba's, by the time to one error: `python -m benchmarks.media_speed`. Needs the extra
`truth`.

Both render a case of ../shared/truth in turn, in one process, after a warm-up. The error that a renderer makes falls
with the square root of its time, so squared error times seconds is what it needs for an error of 1; the quotient of
these is how much longer one takes to the same error. Processor time, of all threads, depends less on what else the
machine does.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from viewer.gpu.context import open_context
from viewer.image.image import Image
from viewer.scene.light import Light
from viewer.scene.medium import Medium
from viewer.scene.volume import volume_medium
from viewer.trace.paths.run import run
from viewer.trace.tracer import Tracer

from .mitsuba_scene import mitsuba, mitsuba_mesh, mitsuba_sensor
from .truth_cases import FOLDER, Case, load_case

CASES = ("wax", "cloud", "fog-g07")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--only", default=",".join(CASES), help="cases, separated by commas")
    options = parser.parse_args()
    print("| case | seconds, ours | Mitsuba | of processor time, ours | Mitsuba | relMSE, ours | Mitsuba "
          "| time to one error, ours / Mitsuba | of processor time |\n|---|---|---|---|---|---|---|---|---|")
    with open_context() as context:
        for name in options.only.split(","):
            case = load_case(name)
            both = _ours(Tracer(context), case, options.spp), _mitsuba(case, options.spp)
            found: tuple[list[tuple[float, float, float]], ...] = [], []
            for turn in range(options.rounds + 1):
                for render, rows in zip(both, found, strict=True):
                    start, used = time.perf_counter(), time.process_time()
                    pixels = render(turn)
                    rows.append((time.perf_counter() - start, time.process_time() - used, _relmse(case, pixels)))
            medians = [[statistics.median(column) for column in zip(*rows[1:])] for rows in found]
            (ours, our_work, our_error), (theirs, their_work, their_error) = medians
            quotient = our_error / their_error
            print(f"| {name} | {ours:.2f} | {theirs:.2f} | {our_work:.2f} | {their_work:.2f} | {our_error:.4f} "
                  f"| {their_error:.4f} | {ours / theirs * quotient:.2f} | {our_work / their_work * quotient:.2f} |",
                  flush=True)
        print(f"\n{options.spp} samples, {options.rounds} rounds; {context.renderer}; {os.cpu_count()} cores, "
              f"load average {os.getloadavg()[0]:.0f}")


def _relmse(case: Case, pixels: np.ndarray) -> float:
    """Without the noise of the reference."""
    squares = (pixels - case.reference) ** 2 / (case.reference**2 + 0.01)
    return float(squares.mean()) - case.floor


def _ours(tracer: Tracer, case: Case, spp: int) -> Callable[[int], np.ndarray]:
    def render(seed: int) -> np.ndarray:
        path_render = tracer.begin(case.scene, case.camera, case.with_settings(spp=spp, seed=seed), case.size)
        run(path_render, time.perf_counter())
        image: Image = path_render.image()
        path_render.release()
        return image.linear[..., :3].astype(np.float64)

    return render


def _mitsuba(case: Case, spp: int) -> Callable[[int], np.ndarray]:
    mi = mitsuba()
    scene = mi.load_dict(_scene(mi, case))

    def render(seed: int) -> np.ndarray:
        return np.array(mi.render(scene, spp=spp, seed=seed), np.float64)[..., :3]

    return render


def _scene(mi: Any, case: Case) -> dict[str, Any]:
    facts = json.loads((FOLDER / case.name / "case.json").read_text())
    parts: dict[str, Any] = {"type": "scene", "integrator": {"type": facts["method"], "max_depth": -1},
                             "sensor": mitsuba_sensor(mi, case.camera, case.size)}
    if case.scene.environment is not None:
        parts["sky"] = {"type": "constant", "radiance": case.scene.environment.intensity}
    for k, light in enumerate(case.scene.lights):
        parts[f"light{k}"] = _light(mi, light)
    for k, instance in enumerate(case.scene.instances):
        mesh = case.scene.meshes[instance.mesh]
        material = case.scene.materials[mesh.material]
        inside = _medium(material.medium) if material.medium.scatters else None
        parts[f"mesh{k}"] = mitsuba_mesh(mi, mesh, material, instance.transform, inside)
    for k, volume in enumerate(case.scene.volumes):
        low, high = volume.corners[[0, 7]]
        medium = volume_medium(case.with_settings())
        grid = {"type": "gridvolume", "filename": str(FOLDER / case.name / facts["model"]), "use_grid_bbox": True,
                "filter_type": "trilinear", "wrap_mode": "clamp"}
        cube = mi.ScalarTransform4f().translate(((low + high) / 2).tolist()).scale(((high - low) / 2).tolist())
        parts[f"volume{k}"] = {"type": "cube", "to_world": cube, "bsdf": {"type": "null"}, "interior": {
            "type": "heterogeneous", "sigma_t": grid, "scale": medium.sigma_t[0],
            "albedo": {"type": "constvolume", "value": {"type": "rgb", "value": list(medium.albedo)}},
            "phase": {"type": "hg", "g": medium.g}}}
    return parts


def _medium(medium: Medium) -> dict[str, Any]:
    most = max(medium.sigma_t)
    return {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [s / most for s in medium.sigma_t]},
            "scale": most, "albedo": {"type": "rgb", "value": list(medium.albedo)},
            "phase": {"type": "hg", "g": medium.g}}


def _light(mi: Any, light: Light) -> dict[str, Any]:
    power = {"type": "rgb", "value": [light.intensity * c for c in light.color]}
    if light.kind == "directional":
        return {"type": "directional", "direction": list(light.direction), "irradiance": power}
    target = (np.array(light.position) + light.direction).tolist()
    return {"type": "spot", "to_world": mi.ScalarTransform4f().look_at(list(light.position), target, [0, 1, 0]),
            "intensity": power, "cutoff_angle": float(np.degrees(light.outer_cone)),
            "beam_width": float(np.degrees(light.inner_cone))}


if __name__ == "__main__":
    main()
