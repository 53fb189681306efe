"""Fog, volumes and solids that scatter light, in the rasterizer: `python -m benchmarks.media`.

Cases of ../shared/truth, and scenes of assets/ against mode path, by methods of the report's ladder: error, and time
over that of the plain frame. Then frames of the window's size. The cube of fog of two cases is a mesh in their files,
which a volume of the same size replaces here.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.image.image import Image
from viewer.measure.compare.relmse import Halves, relmse
from viewer.measure.report.ladder import PLAIN
from viewer.quality import POINTS
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings, ignored
from viewer.trace.tracer import Tracer

from . import truth_cases
from .machine import here
from .shot import REPOSITORY
from .truth_cases import FOLDER

VOLUMES, SOLIDS = ("fog-point", "fog-g07", "cloud", "smoke-absorbing"), ("wax", "milk-rough")
SIZE = 128, 128
HIDDEN = 0.05
"""Pixels count of which volumes hide more than this. Elsewhere the picture is right without them."""
PLAINS = 5
"""Plain frames for one of a method: they are short, and all times are told in them."""
FURNACE = Environment("furnace", np.ones((32, 64, 3), np.float32))
Changes = dict[str, Any]
SHADOWED: tuple[Changes, ...] = tuple({"environment_shadows": lights, "antialias": antialias}
                                      for lights, antialias in (("16", "ssaa-4"), ("64", "ssaa-4"), ("64", "ssaa-9")))
STANDARD: Changes = dict(POINTS["standard"])
STEPS: tuple[Changes, ...] = (
    {"media_scattering": "single"}, {"media_steps": "28", "media_rays": "sixteenth"},
    {"media_steps": "28", "media_rays": "ninth"}, {"media_steps": "28", "media_rays": "quarter"},
    {"media_rays": "all"})
PHONG: tuple[Changes, ...] = ({"mode": "phong"},)
INDIRECT: tuple[Changes, ...] = ({"subsurface": "slab"}, {"indirect": "baked"},
                                 {"indirect": "baked", "environment_shadows": "64", "antialias": "ssaa-4"})
CLOUD, SMOKE, DEMO = "volumes/cloud.vdb", "volumes/smoke.vdb", "demo.glb"
TILES = str(FOLDER.parent / "corpus" / "volumes" / "tiles.vdb")
SAMPLES = {CLOUD: 64, SMOKE: 64, TILES: 256, DEMO: 512}
"""Of mode path a pixel: the noise is to be far below the errors that are measured."""
DENSE, FOG, THICK_FOG = {"volume_density": 2.0}, {"fog": 0.5}, {"fog": 2.0}
OURS: tuple[tuple[str, str, float, Changes, tuple[Changes, ...]], ...] = (
    (CLOUD, "studio", 0.0, DENSE, (*STEPS, *PHONG)),
    (CLOUD, "furnace", 0.0, DENSE, ()),
    (CLOUD, "none", 3.0, DENSE, ()),
    (CLOUD, "studio", 0.0, DENSE | {"volume_g": 0.99}, ()),
    (SMOKE, "studio", 0.0, {}, (*STEPS, *PHONG)),
    (TILES, "none", 3.0, {}, STEPS[:-1]),
    (TILES, "studio", 0.0, {}, STEPS[:-1]),
    (DEMO, "studio", 0.0, FOG, (*STEPS, *SHADOWED, STANDARD)),
    (DEMO, "studio", 6.0, FOG, (SHADOWED[-1], STANDARD)),
    (DEMO, "studio", 6.0, THICK_FOG, (SHADOWED[-1], STANDARD)),
)
"""Model, environment, illuminance of a sun in lux, settings of the medium, and methods beside the default."""


GIVEN_UP = (
    "A moving camera has a ray for sixteen pixels with 28 steps, as the CPU renders; a picture at rest has one for",
    "four with 56. While the camera moves, a dense cloud (`volumes/cloud.vdb`, density 2) has faint blotches where",
    "steps are thicker than its edge, and a volume that is dense up to its faces ends in stairs of four pixels. Fog,",
    "its shafts and the smoke look the same.", "",
    "A plain frame of a volume without an environment is an empty picture, which takes a millisecond or less. Such a",
    "frame is judged by the plain frame of `demo.glb` instead.")


@dataclass(frozen=True, eq=False)
class Measured:
    """A picture of which the truth is known; `plain` is the same without the medium. `counted`, (H, W) bool, has the
    pixels of which errors are told, and `floor` is the relMSE that the noise of the reference makes in these."""

    name: str
    scene: Scene
    camera: Camera
    settings: Settings
    plain: tuple[Scene, Settings]
    reference: np.ndarray
    counted: np.ndarray
    samples: int
    floor: float
    methods: tuple[Changes, ...]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--results", type=Path)
    parser.add_argument("--only", default="", help="scenes whose names contain this, without the frames of 512 x 512")
    options = parser.parse_args()
    with open_context() as context:
        load = os.getloadavg()[0]
        lines = ["# Fog, volumes and solids that scatter light, in the rasterizer", "",
                 "By `python -m benchmarks.media`. Pictures have 128 x 128 pixels. The first six scenes are against "
                 "Mitsuba, the others against mode", "path. `samples` are those of each pixel of the reference, and "
                 "`floor` is the relMSE that its noise alone makes.",
                 "relMSE and mean are those of the whole picture; of files of volumes those of the pixels of "
                 "which the", "volume hides at least a twentieth. `pixels` is their share. Times are of all threads "
                 "of the processor, the median of frames with", "everything prepared; `frames` is the time over that "
                 "of a plain frame, which is `msaa-4` with image-based light, without shadows of", "the environment "
                 "and without the medium. The cube of fog is a volume.",
                 "", "| scene | method | pixels | samples | relMSE | floor | mean / reference | ms | frames |",
                 "|---|---|---|---|---|---|---|---|---|"]
        renderer = Renderer(context)
        for measured in _all(renderer, options.only):
            lines += _rows(renderer, measured, options.frames)
        if not options.only:
            lines += ["", "With the default settings, by the clock and of all threads of the processor:", "",
                      "| frame of 512 x 512 | moving camera, ms | of the processor | at rest, ms | of the processor |",
                      "|---|---|---|---|---|", *_frames(renderer, options.frames), "", *GIVEN_UP]
        lines += ["", f"- load average {load:.0f} at the start and {os.getloadavg()[0]:.0f} at the end",
                  f"- renderer: {context.renderer}", *(f"- {name}: {what}" for name, what in here().items())]
    print("\n".join(lines))
    if options.results is not None:
        options.results.write_text("\n".join(lines) + "\n")


def _all(renderer: Renderer, only: str) -> Iterator[Measured]:
    for name in VOLUMES:
        if only not in name:
            continue
        scene, camera, settings, facts = load_case(name)
        reference = Image.open(FOLDER / name / "reference.exr").linear[..., :3].astype(np.float64)
        yield Measured(name, scene, camera, settings, (replace(scene, volumes=()), settings), reference,
                       _everywhere(reference), facts["spp"], facts["relmse_floor"],
                       (*STEPS, *SHADOWED * bool(scene.instances and scene.environment)))
    for name in SOLIDS:
        if only not in name:
            continue
        case = truth_cases.load_case(name)
        settings = Settings.of(**{key: value for key, value in case.settings.items() if key not in ignored("pbr")})
        yield Measured(name, case.scene, case.camera, settings, (case.scene, replace(settings, subsurface="off")),
                       case.reference, _everywhere(case.reference), case.spp, case.floor, INDIRECT)
    tracer = Tracer(renderer.context)
    for model, environment, lux, medium, methods in OURS:
        if only not in model:
            continue
        scene = viewer.load(REPOSITORY / "assets" / model, environment=environment.replace("furnace", "none"))
        scene = replace(scene, environment=FURNACE if environment == "furnace" else scene.environment,
                        lights=(*scene.lights, *[Light.from_angles(1.0, 0.7, lux)] * (lux > 0)))
        camera, settings = scene.framing_camera(1.0), Settings.of(**medium)
        by_paths = replace(settings, mode="path", spp=SAMPLES[model] // 2)
        first, second = (tracer.render(scene, camera, replace(by_paths, seed=seed), SIZE).linear[..., :3]
                         for seed in (1, 2))
        paths = Halves(first, second)
        counted = _hidden(renderer, scene, camera, settings) if scene.volumes else _everywhere(paths.mean)
        inside = Halves(first[counted], second[counted])
        light = {"environment": environment} if environment != "studio" else {}
        told = _told(medium | light | ({"sun of": f"{lux:g} lux"} if lux else {})) or "as it is"
        yield Measured(f"{model if model != TILES else 'tiles.vdb of the corpus'}, {told}", scene, camera, settings,
                       (replace(scene, volumes=()), replace(settings, fog=0.0)), paths.mean, counted, SAMPLES[model],
                       inside.floor(inside.mean), methods)


def _everywhere(reference: np.ndarray) -> np.ndarray:
    return np.ones(reference.shape[:2], bool)


def _hidden(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings) -> np.ndarray:
    """The pixels of which the scene, without its surroundings, hides more than HIDDEN."""
    dark = scene.relit(environment=None, lights=())
    return renderer.render(dark, camera, replace(settings, background="none"), SIZE).linear[..., 3] > HIDDEN


def _rows(renderer: Renderer, measured: Measured, frames: int) -> list[str]:
    size = measured.reference.shape[1], measured.reference.shape[0]
    scene, settings = measured.plain
    ways = [{}, *measured.methods]
    shown = [(scene, PLAIN.settings(settings)),
             *((measured.scene, replace(measured.settings, **way)) for way in ways)]
    pictures = [renderer.render(scene, measured.camera, settings, size).linear[..., :3].astype(np.float64)
                for scene, settings in shown]
    times: list[list[float]] = [[] for _ in shown]
    for _ in range(frames):
        for k, (scene, settings) in enumerate(shown):
            for j in range((1 if k else PLAINS) + 1):  # the first binds what the one before has not
                start = time.process_time()
                renderer.draw(scene, measured.camera, settings, size, half=False, still=True)
                renderer.read_radiance()
                if j:
                    times[k].append(1e3 * (time.process_time() - start))
    plain, *others = (statistics.median(spent) for spent in times)
    counted, reference = measured.counted, measured.reference[measured.counted]
    return [f"| {measured.name} | {_told(way) or 'default'} | {counted.mean():.0%} | {measured.samples} | "
            f"{relmse(picture[counted], reference):.4f} | {measured.floor:.4f} | "
            f"{picture[counted].mean() / reference.mean():.3f} | {spent:.0f} | {spent / plain:.1f} |"
            for way, picture, spent in zip(ways, pictures[1:], others, strict=True)]


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
            times, work = [], []
            for k in range(frames + 2):
                start, used = time.perf_counter(), time.process_time()
                camera = scene.framing_camera(1.0, azimuth=0.1 * k)
                renderer.draw(scene, camera, settings, (512, 512), still=still)
                renderer.read_display(settings)
                times.append(1e3 * (time.perf_counter() - start))
                work.append(1e3 * (time.process_time() - used))
            medians += [statistics.median(times[2:]), statistics.median(work[2:])]
        rows.append(" | ".join([f"| {name}", *(f"{median:.0f}" for median in medians)]) + " |")
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
