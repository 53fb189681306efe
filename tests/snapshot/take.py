"""Takes a snapshot: digests of what the program draws, tells and compiles, for refactoring that must not change a bit.

    python tests/snapshot/take.py before.json
    ... the change ...
    python tests/snapshot/take.py after.json
    python tests/snapshot/compare.py before.json after.json

Golden images forgive what a driver may round otherwise, and a moved term may hide in that. Here nothing is forgiven:
two snapshots of one machine are equal where the code does the same. Those of two machines need not be. The pictures
themselves go to a file beside it (before.npz), so that a comparison can tell how far they are apart.

A snapshot has these sections: `raster`, the golden cases in both modes as linear floats, with `raster programs`, what
was compiled for them; `path`, path-traced pictures, layers and a denoised one, each with Embree and with the BVH in a
shader, and `path programs`; `info`, what `info --json` tells of each model; and `programs`, those that the plans of
all of these ask for. No test of its own, and no part of the test run.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
for _folder in ("tests/trace", "tests/golden", "tests", "."):
    sys.path.insert(0, str(ROOT / _folder))

from cases import CASES  # noqa: E402
from cases import SIZE as RASTER_SIZE  # noqa: E402
from internals import Context, Renderer, Tracer, compiled, create_context, describe_scene, planned  # noqa: E402
from shots import SHOTS, SIZE  # noqa: E402
from text import program_entries  # noqa: E402

import viewer  # noqa: E402
from viewer.errors import InputError  # noqa: E402
from viewer.scene.scene import Scene  # noqa: E402
from viewer.settings import Settings  # noqa: E402

CORPUS = ROOT.parent / "shared" / "corpus" / "models"
RASTER_MODES = ("pbr", "phong")
MODES = (*RASTER_MODES, "path")

Pictures = dict[str, np.ndarray]


def take_raster(context: Context) -> tuple[Pictures, dict[str, object]]:
    """The golden cases in both modes, and what was compiled for them."""
    pictures: Pictures = {}
    with compiled() as programs:
        renderer = Renderer(context, use_cache=False)
        for case in CASES:
            scene, camera = case.load()
            for mode in RASTER_MODES:
                picture = renderer.render(scene, camera, case.with_mode(mode), RASTER_SIZE)
                pictures[f"{case.name} {mode}"] = picture.linear
        renderer.release()
    return pictures, program_entries([list(sources.values()) for sources in programs])


def take_path(context: Context) -> tuple[Pictures, dict[str, object]]:
    """The shots with both intersectors, with their layers, and what was compiled for them."""
    pictures: Pictures = {}
    with compiled() as programs:
        for intersector in ("embree", "bvh"):
            tracer = Tracer(context, use_cache=False, intersector=intersector)
            for shot in SHOTS:
                picture = tracer.render(*shot.make(), shot.with_mode(), SIZE, shot.layers)
                pictures[f"{shot.name} {intersector}"] = picture.linear
                for name, layer in picture.layers.items():
                    pictures[f"{shot.name} {intersector}: {name}"] = layer
            tracer.release()
    return pictures, program_entries([list(sources.values()) for sources in programs])


def models() -> tuple[dict[str, Scene], dict[str, str]]:
    """Of the corpus, where it is there, and of assets/scenes, under the default environment, by name; and what is said
    of those that cannot be loaded."""
    files = {f"scenes/{path.name}": path for path in sorted((ROOT / "assets" / "scenes").glob("*.glb"))}
    files |= {path.relative_to(CORPUS).as_posix(): path
              for path in sorted(CORPUS.rglob("*")) if path.suffix in (".glb", ".gltf")}
    scenes, refused = {}, {}
    for name, path in files.items():
        try:
            scenes[name] = viewer.load(path)
        except InputError as error:
            refused[name] = str(error)
    return scenes, refused


def take_info(scenes: dict[str, Scene], refused: dict[str, str]) -> dict[str, object]:
    """What `info` tells of the models in each mode, or why it cannot, without the folders they lie in."""
    told = refused | {f"{name} {mode}": describe_scene(scene, Settings(mode=mode))
                      for name, scene in scenes.items() for mode in MODES}
    text = json.dumps(told)
    for folder in (CORPUS, ROOT):
        text = text.replace(f"{folder}/", "")
    return json.loads(text)


def take_programs(scenes: dict[str, Scene]) -> dict[str, object]:
    """The programs that the plans of the golden cases, the shots and the models name."""
    programs = [program for case in CASES for mode in RASTER_MODES
                for program in planned(case.load()[0], case.with_mode(mode))]
    programs += [program for shot in SHOTS for program in planned(shot.make()[0], shot.with_mode())]
    programs += [program for scene in scenes.values() for mode in MODES
                 for program in planned(scene, Settings(mode=mode))]
    return program_entries(programs)


def picture_entries(pictures: Pictures) -> dict[str, object]:
    return {name: {"sha256": hashlib.sha256(np.ascontiguousarray(pixels)).hexdigest(), "shape": pixels.shape}
            for name, pixels in pictures.items()}


def cpu_digest() -> str:
    """Of what the processor can do, by which a driver that draws with it chooses its code."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ""
    flags = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return hashlib.sha256(" ".join(sorted(flags.split(":")[-1].split())).encode()).hexdigest()[:16]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--only", choices=("raster", "path", "info", "programs"))
    arguments = parser.parse_args()
    wanted = [arguments.only] if arguments.only else ["raster", "path", "info", "programs"]
    sections: dict[str, object] = {}
    pictures: dict[str, Pictures] = {}
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder, create_context("egl") as context:
        os.environ["PBR_VIEWER_CACHE"] = folder  # one bake an environment, and nothing from before
        for name in wanted:
            started = time.perf_counter()
            if name == "info":
                sections[name] = take_info(*models())
            elif name == "programs":
                sections[name] = take_programs(models()[0])
            else:
                pictures[name], programs = (take_raster if name == "raster" else take_path)(context)
                sections |= {name: picture_entries(pictures[name]), f"{name} programs": programs}
            seconds[name] = round(time.perf_counter() - started, 1)
            print(f"{name}: {len(sections[name])} entries, {seconds[name]} s", flush=True)
        machine = {"renderer": context.gl.info["GL_RENDERER"], "version": context.gl.info["GL_VERSION"],
                   "cpu": cpu_digest()}
    arguments.output.write_text(json.dumps({"machine": machine, "seconds": seconds, "sections": sections}, indent=1))
    np.savez_compressed(arguments.output.with_suffix(".npz"),
                        **{f"{section}/{name}": pixels for section, found in pictures.items()
                           for name, pixels in found.items()})


if __name__ == "__main__":
    main()
