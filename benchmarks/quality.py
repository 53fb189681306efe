"""What pictures of --quality standard cost beside drafts, and what the rule of --quality auto foresees of them.

    python -m benchmarks.quality [MODEL ...] [--sizes WxH ...] [--rounds N] [--results DIR]

Each picture is made by a command of its own, `pbr-viewer render`, with what caches on disk hold. Its processor time is
that of the whole command. The qualities take turns in each round; the least is told.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from viewer.gpu.context import open_context
from viewer.plan.first_picture import FirstPicture
from viewer.quality import QUALITIES
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene

from . import corpus, machine, shot, tracing

MODELS = ("Box", "Duck", "Fox", "Suzanne", "CesiumMilkTruck", "RiggedFigure", "GlamVelvetSofa", "DamagedHelmet",
          "AlphaBlendModeTest", "GlassVaseFlowers", "ClearCoatTest", "FlightHelmet", "SheenCloth", "ToyCar")
ENVIRONMENT = "studio_small_05_1k"
MEASURED = QUALITIES[:2]
"""High is not measured here: baking takes it seconds in any case."""
COLUMNS = {"model": "model", "size": "size", "triangles": "triangles", "draft": "draft:.2f",
           "standard": "standard:.2f", "times": "times:.2f", "foreseen times": "foreseen:.2f", "auto takes": "auto",
           "its times": "auto_times:.2f"}


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
    turns = [{quality: _seconds(model, size, quality) for quality in MEASURED} for _ in range(rounds)]
    taken = {quality: min(turn[quality] for turn in turns) for quality in MEASURED}
    scene = replace(load_scene(corpus.model(model)), environment=load_environment(corpus.environment(ENVIRONMENT)))
    width, height = map(int, size.split("x"))
    first = FirstPicture.of(scene, (width, height))
    return {"model": model, "size": size, "triangles": scene.triangle_count, **taken,
            "times": taken["standard"] / taken["draft"], "foreseen": first.standard / first.draft,
            "auto": first.quality, "auto_times": taken[first.quality] / taken["draft"]}


def _seconds(model: str, size: str, quality: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "viewer", "render", corpus.model(model), "-o", f"{folder}/a.png", "-q",
                   "--env", corpus.environment(ENVIRONMENT), "--background", "none", "--size", size,
                   "--quality", quality]
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
