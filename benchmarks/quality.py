"""What pictures of --quality standard cost beside drafts, and what the rule of --quality auto foresees of them.

    python -m benchmarks.quality [MODEL ...] [--sizes WxH ...] [--caches warm cold] [--rounds N] [--results DIR]

Each picture is made by a process of its own, which loads the model and calls `viewer.render`. Its processor time is
told for the whole process and, as `picture`, from the loaded scene on. A draft, and standard with each number of lights
that auto may take, take turns in each round; the least is told. Cold: the driver's cache of shaders and that of baked
environments are empty. Warm: each has been made before.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from viewer.gpu.context import open_context
from viewer.plan.first_picture import LIGHTS, FirstPicture
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene

from . import corpus, machine, shot, tracing

MODELS = ("Box", "Duck", "Fox", "Suzanne", "CesiumMilkTruck", "RiggedFigure", "GlamVelvetSofa", "DamagedHelmet",
          "AlphaBlendModeTest", "GlassVaseFlowers", "ClearCoatTest", "FlightHelmet", "SheenCloth", "ToyCar")
ENVIRONMENT = "studio_small_05_1k"
MEASURED = {"draft": "quality='draft'",
            **{str(lights): f"quality='standard', environment_shadows='{lights}'" for lights in LIGHTS}}
"""What auto may take. High is not measured: baking takes it seconds in any case."""
COLUMNS = {"model": "model", "size": "size", "caches": "caches", "triangles": "triangles", "draft": "draft:.2f",
           "its picture": "draft_picture:.2f",
           **{f"times with {lights}": f"times_{lights}:.2f" for lights in LIGHTS},
           **{f"picture with {lights}": f"picture_{lights}:.2f" for lights in LIGHTS},
           **{f"foreseen with {lights}": f"foreseen_{lights}:.2f" for lights in LIGHTS},
           "auto takes": "auto", "its times": "auto_times:.2f", "of the picture": "auto_picture:.2f"}
_PROGRAM = """
import sys, time, viewer
model, environment, width, height = sys.argv[1:]
scene = viewer.load(model, environment)
loaded = time.process_time()
viewer.render(scene, (int(width), int(height)), background="none", {changes})
print(loaded, time.process_time())
"""


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    loads: list[float] = []
    with machine.until_stopped():
        for model in options.models:
            for size in options.sizes:
                for caches in options.caches:
                    rows.append(_row(model, size, caches, options.rounds))
                    loads.append(round(os.getloadavg()[0], 1))
                    print(rows[-1], flush=True)
    with open_context() as context:
        facts = machine.here() | {"renderer": context.renderer, "environment": ENVIRONMENT, "rounds": options.rounds,
                                  "load average": f"{min(loads)} to {max(loads)}"}
    text = ["# First pictures", "",
            "Processor seconds of a process from its start to its picture, and of the picture alone, from the loaded "
            "scene on; what auto takes, as times those of a draft.", "",
            *tracing.table(rows, COLUMNS), ""]
    tracing.keep("quality" if "warm" in options.caches else "quality_cold", facts, rows, text, options.results)


def _row(model: str, size: str, caches: str, rounds: int) -> dict[str, object]:
    warming = int(caches == "warm")
    turns = [{name: _seconds(model, size, changes, not warming) for name, changes in MEASURED.items()}
             for _ in range(warming + rounds)][warming:]
    taken, pictures = ({name: min(turn[name][k] for turn in turns) for name in MEASURED} for k in (0, 1))
    scene = replace(load_scene(corpus.model(model)), environment=load_environment(corpus.environment(ENVIRONMENT)))
    width, height = map(int, size.split("x"))
    first = FirstPicture.of(scene, (width, height))
    auto = str(first.lights or "draft")
    return {"model": model, "size": size, "caches": caches, "triangles": scene.triangle_count, **taken,
            **{f"{name}_picture": seconds for name, seconds in pictures.items()},
            **{f"times_{lights}": taken[str(lights)] / taken["draft"] for lights in LIGHTS},
            **{f"picture_{lights}": pictures[str(lights)] / pictures["draft"] for lights in LIGHTS},
            **{f"foreseen_{lights}": first.standard(lights) / first.draft for lights in LIGHTS},
            "auto": auto, "auto_times": taken[auto] / taken["draft"],
            "auto_picture": pictures[auto] / pictures["draft"]}


def _seconds(model: str, size: str, changes: str, is_cold: bool) -> tuple[float, float]:
    """Of the process, and of the picture."""
    with tempfile.TemporaryDirectory() as folder:
        caches = {"MESA_SHADER_CACHE_DIR": folder, "XDG_CACHE_HOME": folder} if is_cold else {}
        command = [sys.executable, "-c", _PROGRAM.format(changes=changes), corpus.model(model),
                   corpus.environment(ENVIRONMENT), *size.split("x")]
        told = subprocess.run(command, check=True, cwd=shot.REPOSITORY, env=os.environ | caches, capture_output=True,
                              text=True).stdout
        loaded, done = map(float, told.split())
        return done, done - loaded


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quality", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=list(MODELS), metavar="MODEL")
    parser.add_argument("--sizes", nargs="+", default=["256x256", "512x512", "1280x720"], metavar="WxH")
    parser.add_argument("--caches", nargs="+", choices=("warm", "cold"), default=["warm", "cold"])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
