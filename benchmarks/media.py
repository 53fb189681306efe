"""Fog and volumes of the rasterizer against another renderer's: `python -m benchmarks.media`.

Cases of ../shared/truth by every choice of steps, rays and scattering, with the time of a frame; frames of the window's
size; and the volumes of assets/ and the demo scene in fog against mode path. The cube of fog of two cases is a mesh in
their files, which a volume of the same size replaces here.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.image.image import Image
from viewer.measure.compare.relmse import Halves, relmse
from viewer.measure.report.ladder import MEDIA
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from .shot import REPOSITORY
from .truth_cases import FOLDER

CASES = ("fog-point", "fog-g07", "cloud", "smoke-absorbing")
SIZE, SAMPLES = (128, 128), 256
CLOUD, SMOKE, DEMO = "volumes/cloud.vdb", "volumes/smoke.vdb", "demo.glb"
FURNACE = Environment("furnace", np.ones((32, 64, 3), np.float32))
FULL = {"environment_shadows": "64", "antialias": "ssaa-9"}
DENSE = {"volume_density": 2.0}
PATHS: tuple[tuple[str, str, float, dict[str, Any], dict[str, Any]], ...] = (
    *((CLOUD, "studio", 0.0, DENSE, way) for way in ({}, {"media_scattering": "single"}, {"mode": "phong"})),
    (CLOUD, "furnace", 0.0, DENSE, {}),
    (CLOUD, "none", 3.0, DENSE, {}),
    (CLOUD, "studio", 0.0, DENSE | {"volume_g": 0.99}, {}),
    *((SMOKE, "studio", 0.0, {}, way) for way in ({}, {"media_scattering": "single"}, {"mode": "phong"})),
    *((DEMO, "studio", lux, {"fog": fog}, way)
      for lux, fog in ((0.0, 0.5), (6.0, 0.5), (6.0, 2.0)) for way in ({}, FULL)),
)
"""Model, environment, illuminance of a sun in lux, settings of the medium, and those of a method."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--results", type=Path)
    options = parser.parse_args()
    lines = ["# Fog and volumes of the rasterizer", "",
             "By `python -m benchmarks.media`. relMSE and mean are those of the whole picture, 128 x 128, against "
             "Mitsuba; the floor is", "the noise of the reference. A frame has everything prepared; `plain` is the "
             "same picture without the medium. The cube of fog is", "a volume. Errors do not depend on what else the "
             "machine does, and times do.", ""]
    with open_context() as context:
        load, cores = os.getloadavg()[0], os.cpu_count()
        lines += [f"{context.renderer}; {cores} cores, load average {load:.0f} at the start", "",
                  "| case | scattering | steps | pixels with a ray | relMSE | floor | mean / reference | ms | plain |",
                  "|---|---|---|---|---|---|---|---|---|"]
        renderer = Renderer(context)
        for name in CASES:
            lines += _case(renderer, name, options.frames)
        lines += ["", "With the default settings:", "", "| frame of 512 x 512 | moving camera, ms | at rest, ms |",
                  "|---|---|---|", *_frames(renderer, options.frames)]
        lines += ["", "## Against mode path", "",
                  f"{SIZE[0]} x {SIZE[1]}, {SAMPLES} samples per pixel, in pixels of which media hide at least a "
                  "twentieth; the floor is the noise of the paths.", "",
                  "| model | environment | sun, lux | medium | method | relMSE | floor | mean / path |",
                  "|---|---|---|---|---|---|---|---|", *_against_path(renderer)]
    print("\n".join(lines))
    if options.results is not None:
        options.results.write_text("\n".join(lines) + "\n")


def _case(renderer: Renderer, name: str, frames: int) -> list[str]:
    scene, camera, settings, facts = load_case(name)
    reference = Image.open(FOLDER / name / "reference.exr").linear[..., :3].astype(np.float64)
    size = (facts["size"],) * 2
    plain, _ = _timed(renderer, replace(scene, volumes=()), camera, settings, size, frames)
    rows = []
    for scattering, choices in MEDIA.items():
        for steps, rays in choices:
            chosen = replace(settings, media_scattering=scattering, media_steps=steps, media_rays=rays)
            milliseconds, picture = _timed(renderer, scene, camera, chosen, size, frames)
            error = float(relmse(picture, reference))
            rows.append(f"| {name} | {scattering} | {steps} | {rays} | {error:.4f} | {facts['relmse_floor']:.4f} | "
                        f"{picture.mean() / reference.mean():.3f} | {milliseconds:.0f} | {plain:.0f} |")
    return rows


def _timed(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
           frames: int) -> tuple[float, np.ndarray]:
    """The median time of a frame in milliseconds, and the picture."""
    picture = renderer.render(scene, camera, settings, size).linear[..., :3].astype(np.float64)
    times = []
    for _ in range(frames):
        start = time.perf_counter()
        renderer.draw(scene, camera, settings, size, half=False, still=True)
        renderer.read_radiance()
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times), picture


def _frames(renderer: Renderer, frames: int) -> list[str]:
    """Frames as the window draws them while the camera moves, and when it rests."""
    assets = REPOSITORY / "assets"
    scenes = {"demo.glb": (viewer.load(assets / "demo.glb"), {}),
              "demo.glb in fog": (viewer.load(assets / "demo.glb"), {"fog": 0.5}),
              "volumes/cloud.vdb": (viewer.load(assets / "volumes" / "cloud.vdb"), {"volume_density": 2.0}),
              "volumes/smoke.vdb": (viewer.load(assets / "volumes" / "smoke.vdb"), {})}
    rows = []
    for name, (scene, chosen) in scenes.items():
        scene = replace(scene, lights=(*scene.lights, Light.from_angles(1.0, 0.7, 2.0)))
        settings = Settings.of(**chosen)
        medians = []
        for still in (False, True):
            times = []
            for k in range(frames + 2):
                start = time.perf_counter()
                camera = scene.framing_camera(1.0, azimuth=0.1 * k)
                renderer.draw(scene, camera, settings, (512, 512), still=still)
                renderer.read_display(settings)
                times.append(1e3 * (time.perf_counter() - start))
            medians.append(statistics.median(times[2:]))
        rows.append(f"| {name} | {medians[0]:.0f} | {medians[1]:.0f} |")
    return rows


def _against_path(renderer: Renderer) -> list[str]:
    tracer, known, rows = Tracer(renderer.context), {}, []
    for model, environment, lux, medium, way in PATHS:
        scene = viewer.load(REPOSITORY / "assets" / model, environment=environment.replace("furnace", "none"))
        scene = replace(scene, environment=FURNACE if environment == "furnace" else scene.environment,
                        lights=(*scene.lights, *[Light.from_angles(1.0, 0.7, lux)] * (lux > 0)))
        camera = scene.framing_camera(1.0)
        key = (model, environment, lux, str(medium))
        if key not in known:
            halves = [tracer.render(scene, camera, Settings.of(mode="path", spp=SAMPLES // 2, seed=seed, **medium),
                                    SIZE).linear[..., :3] for seed in (1, 2)]
            dark, alone = scene.relit(environment=None, lights=()), Settings.of(background="none", **medium)
            hidden = renderer.render(dark, camera, alone, SIZE).linear[..., 3] > 0.05
            known[key] = Halves(halves[0][hidden], halves[1][hidden]), hidden
        paths, hidden = known[key]
        picture = renderer.render(scene, camera, Settings.of(**medium, **way), SIZE).linear[hidden][:, :3]
        rows.append(f"| {model} | {environment} | {lux:g} | {_told(medium)} | {_told(way) or 'default'} | "
                    f"{relmse(picture, paths.mean):.4f} | {paths.floor(paths.mean):.4f} | "
                    f"{picture.mean() / paths.mean.mean():.3f} |")
    return rows


def _told(settings: dict[str, Any]) -> str:
    return ", ".join(f"{name.replace('_', '-')} {value}" for name, value in settings.items())


def load_case(name: str) -> tuple[Scene, Camera, Settings, dict[str, Any]]:
    """A case of ../shared/truth with a volume: scene, camera, settings and what case.json says."""
    folder = FOLDER / name
    facts = json.loads((folder / "case.json").read_text())
    scene, settings = viewer.load(folder / facts["model"], environment=None), Settings()
    settings = replace(settings, background="env")
    if facts["model"] == "scene.glb":
        medium = facts["medium"]["fog"]
        box = Volume.in_box(np.ones((1, 1, 1), np.float32), [[-1, -1, -1], [1, 1, 1]])
        opaque = tuple(i for i in scene.instances if not scene.materials[scene.meshes[i.mesh].material].transmits)
        scene = replace(scene, instances=opaque, volumes=(box,))
        settings = replace(settings, volume_density=medium["sigma_t"][0], volume_albedo=tuple(medium["albedo"]),
                           volume_g=medium["g"])
    words, lights, intensity = list(facts["options"]), [], 1.0
    while words:
        word = words.pop(0)
        if word == "--set":
            settings = settings.with_option(words.pop(0))
        elif word == "--env-intensity":
            intensity = float(words.pop(0))
        elif word == "--with":
            scene = viewer.join(scene, viewer.load(folder / words.pop(0), environment=None))
        elif word.startswith("--light="):
            azimuth, elevation, lux = map(float, word.removeprefix("--light=").split(","))
            lights.append(Light.from_angles(math.radians(azimuth), math.radians(elevation), lux))
    furnace = replace(FURNACE, intensity=intensity)
    scene = replace(scene, environment=furnace if facts["env"] == "furnace" else None, lights=(*scene.lights, *lights))
    camera = Camera.look_at(facts["eye"], facts["target"], fov_y=math.radians(facts["fov"]))
    return scene, camera, settings, facts


if __name__ == "__main__":
    main()
