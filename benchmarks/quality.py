"""What pictures of --quality standard cost beside drafts, and what the rule of --quality auto foresees of them.

    python -m benchmarks.quality [MODEL ...] [--sizes WxH ...] [--rounds N] [--results DIR]

Each picture is made by a command of its own, `pbr-viewer render`, with what caches on disk hold. Its processor time is
that of the whole command. A draft, and standard with each number of lights that auto may take, take turns in each
round; the least is told.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterable
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
MEASURED = {"draft": ("--quality", "draft"),
            **{str(lights): ("--quality", "standard", "--set", f"environment-shadows={lights}") for lights in LIGHTS}}
"""The options of what auto may take. High is not measured: baking takes it seconds in any case."""
COLUMNS = {"model": "model", "size": "size", "triangles": "triangles", "draft": "draft:.2f",
           **{f"{lights} lights": f"{lights}:.2f" for lights in LIGHTS},
           **{f"times with {lights}": f"times_{lights}:.2f" for lights in LIGHTS},
           **{f"foreseen with {lights}": f"foreseen_{lights}:.2f" for lights in LIGHTS},
           "auto takes": "auto", "its times": "auto_times:.2f"}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    loads: list[float] = []
    with machine.until_stopped():
        for model in options.models:
            for size in options.sizes:
                rows.append(_row(model, size, options.rounds))
                loads.append(round(os.getloadavg()[0], 1))
                print(rows[-1], flush=True)
    with open_context() as context:
        facts = machine.here() | {"renderer": context.renderer, "environment": ENVIRONMENT, "rounds": options.rounds,
                                  "load average": f"{min(loads)} to {max(loads)}"}
    text = ["# First pictures", "",
            "Processor seconds of `pbr-viewer render`, from its start to the file; what auto takes beside a draft.", "",
            *tracing.table(rows, COLUMNS), ""]
    tracing.keep("quality", facts, rows, text, options.results)


def _row(model: str, size: str, rounds: int) -> dict[str, object]:
    turns = [{name: _seconds(model, size, options) for name, options in MEASURED.items()} for _ in range(rounds)]
    taken = {name: min(turn[name] for turn in turns) for name in MEASURED}
    scene = replace(load_scene(corpus.model(model)), environment=load_environment(corpus.environment(ENVIRONMENT)))
    width, height = map(int, size.split("x"))
    first = FirstPicture.of(scene, (width, height))
    auto = str(first.lights or "draft")
    return {"model": model, "size": size, "triangles": scene.triangle_count, **taken,
            **{f"times_{lights}": taken[str(lights)] / taken["draft"] for lights in LIGHTS},
            **{f"foreseen_{lights}": first.standard(lights) / first.draft for lights in LIGHTS},
            "auto": auto, "auto_times": taken[auto] / taken["draft"]}


def _seconds(model: str, size: str, options: Iterable[str]) -> float:
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "viewer", "render", corpus.model(model), "-o", f"{folder}/a.png", "-q",
                   "--env", corpus.environment(ENVIRONMENT), "--background", "none", "--size", size,
                   *options]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, cwd=shot.REPOSITORY)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quality", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=list(MODELS), metavar="MODEL")
    parser.add_argument("--sizes", nargs="+", default=["256x256", "512x512", "1280x720"], metavar="WxH")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
