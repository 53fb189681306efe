"""Subsurface scattering of the rasterizer against another renderer's: `python -m benchmarks.subsurface`.

The cases of ../shared/truth with a dense medium behind a boundary, by every choice of `subsurface`, as they are and
with the setting that gives the raster the light of other surfaces, with the time of a frame. Then a head of
wax and its company from two sides, and single solids in a sun from behind and in front, against mode path.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import Halves, relmse
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings, ignored, setting_choices
from viewer.trace.tracer import Tracer

from .machine import here
from .shot import REPOSITORY
from .truth_cases import Case, load_case

CASES = ("wax", "milk-rough")
LIGHT: dict[str, dict[str, object]] = {"": {}, "indirect=baked": {"indirect": "baked"}}
SOLIDS = {"ear": ((0.3, 0.42, 0.07), 10.0, 0.3), "thin ear": ((0.3, 0.42, 0.04), 10.0, 0.5),
          "egg": ((0.5, 0.5, 0.3), 5.0, 0.4), "lens": ((0.6, 0.6, 0.1), 20.0, 0.4), "ball": ((0.5, 0.5, 0.5), 5.0, 0.4)}
"""Half axes of an ellipsoid, extinction per unit, and roughness of its boundary of index 1.4."""
SUNS = {"behind": 0.1, "aslant behind": 0.5, "in front": math.pi - 0.5}
"""The angle between the directions of sunlight and of the eye."""
COLOR, BLACK = (0.9, 0.7, 0.5), (1e-3,) * 3
"""Of multiple scattering"""
FIGURE = {"head of wax, in front": 5.6, "head of wax, behind": -5.6}
"""Where the eye is along z, of `assets/scenes/subsurface.glb` in the studio"""
FIGURE_SAMPLES, FIGURE_SIZE = 128, (64, 64)
IN_SUN = {"fresnel": "exact", "background": "none", "multiscatter": "off"}
SAMPLES, SOLID_SIZE = 128, (32, 32)
OF_SOLIDS = (
    "Ellipsoids in a sun, 32 x 32, against mode path with 128 samples: means of the raster over those of paths, over",
    "the pixels that the solid fills. `scattered` is what the medium scatters: in mode path the difference from a",
    "medium that only absorbs, in the raster the diffuse base alone. Paths find the sun through rough boundaries only,",
    "so that they are a few per cent uncertain.", "",
    "| solid | optical depth | sun | all | scattered |", "|---|---|---|---|---|")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--results", type=Path)
    options = parser.parse_args()
    with open_context() as context:
        lines = ["# Light scattered inside of solids, in the rasterizer", "",
                 "By `python -m benchmarks.subsurface`. relMSE and mean are those of the whole picture, against",
                 "Mitsuba (128 x 128), of the head of wax against mode path (64 x 64); the floor is the noise of the",
                 "reference. The time is that of all threads of the processor, the median of frames with everything",
                 "prepared.", "",
                 f"{context.renderer}; {os.cpu_count()} cores, load average {os.getloadavg()[0]:.0f} at the start", "",
                 "| case | subsurface | other settings | relMSE | floor | mean / reference | ms |",
                 "|---|---|---|---|---|---|---|"]
        renderer = Renderer(context)
        for name in CASES:
            lines += _rows(renderer, load_case(name), options.frames)
        tracer = Tracer(context)
        lines += [row for name in FIGURE for row in _rows(renderer, _figure(tracer, name), options.frames)]
        lines += ["", *OF_SOLIDS, *_in_sun(renderer, tracer), "",
                  *(f"- {name}: {what}" for name, what in here().items())]
    print("\n".join(lines))
    if options.results is not None:
        options.results.write_text("\n".join(lines) + "\n")


def _rows(renderer: Renderer, case: Case, frames: int) -> list[str]:
    rows = []
    base = {key: value for key, value in case.settings.items() if key not in ignored("pbr")}
    for title, light in LIGHT.items():
        for method in setting_choices()["subsurface"]:
            settings = replace(Settings.of(**(base | light)), subsurface=method)
            times = []
            for _ in range(frames + 1):
                start = time.process_time()
                picture = renderer.render(case.scene, case.camera, settings, case.size).linear[..., :3]
                times.append(1e3 * (time.process_time() - start))
            picture = picture.astype(np.float64)
            rows.append(f"| {case.name} | {method} | {title} | {float(relmse(picture, case.reference)):.4f} | "
                        f"{case.floor:.4f} | {picture.mean() / case.reference.mean():.3f} | "
                        f"{statistics.median(times[1:]):.0f} |")
    return rows


def _figure(tracer: Tracer, name: str) -> Case:
    scene = viewer.load(REPOSITORY / "assets" / "scenes" / "subsurface.glb", environment="studio").relit(lights=())
    camera = Camera.look_at((0, 0, FIGURE[name]), (0, 0, 0), fov_y=math.radians(30))
    settings = {"multiscatter": "off"}
    halves = Halves(*(tracer.render(scene, camera, Settings.of(mode="path", spp=FIGURE_SAMPLES // 2, bounces=255,
                                                               seed=seed, **settings), FIGURE_SIZE).linear[..., :3]
                      for seed in (1, 2)))
    return Case(name, scene, camera, settings, halves.mean, halves.floor(halves.mean), FIGURE_SAMPLES)


def _in_sun(renderer: Renderer, tracer: Tracer) -> list[str]:
    rows = []
    for name, (axes, extinction, roughness) in SOLIDS.items():
        for place, angle in SUNS.items():
            found = []
            for color in (COLOR, BLACK):
                scene = _solid(axes, extinction, roughness, color, angle)
                camera = Camera.look_at((0, 0, 4), (0, 0, 0), fov_y=0.25)
                by_paths = Settings.of(mode="path", spp=SAMPLES, bounces=255, **IN_SUN)
                found.append(tracer.render(scene, camera, by_paths, SOLID_SIZE).linear)
                if color == COLOR:
                    found += [renderer.render(scene, camera, Settings.of(**IN_SUN, **more), SOLID_SIZE).linear
                              for more in ({}, {"lobes": "uniform-diffuse"})]
            filled = found[0][..., 3] > 0.999
            paths, raster, diffuse, black = (float(picture[filled][:, :3].mean()) for picture in found)
            rows.append(f"| {name} | {2 * axes[2] * extinction:g} | {place} | {raster / paths:.2f} | "
                        f"{diffuse / (paths - black):.2f} |")
    return rows


def _solid(axes: tuple[float, ...], extinction: float, roughness: float, color: tuple[float, ...],
           angle: float) -> Scene:
    scene = viewer.load(REPOSITORY / "assets" / "scenes" / "subsurface.glb", environment=None)
    ball = scene.meshes[scene.instances[0].mesh]
    radius = float(np.abs(ball.positions).max())
    material = Material(metallic=0.0, perceptual_roughness=roughness, transmission=1.0, ior=1.4, thickness=1.0,
                        attenuation_distance=1.0 / extinction, attenuation_color=(math.exp(-1.0),) * 3,
                        scatter_color=color)
    sun = Light("directional", intensity=3.0, direction=(math.sin(angle), -0.1, math.cos(angle)))
    placed = replace(scene.instances[0], mesh=0, transform=np.diag([*(axis / radius for axis in axes), 1.0]))
    return replace(scene, meshes=(replace(ball, material=0),), materials=(material,), instances=(placed,),
                   lights=(sun,))


if __name__ == "__main__":
    main()
