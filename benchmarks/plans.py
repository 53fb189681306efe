"""What leaving out saves: each model by the plan of what it needs and by the one that leaves nothing out, in turn.

    python -m benchmarks.plans [MODEL ...] [--rounds N] [--results DIR]

Each picture is a process of its own with empty folders, so that its memory is its own, and that its first frame has
programs, bakes, textures and buffers to make. Models with lights of their own are shown by these alone, others under
`--env`. The last model is made for this: 200 materials, of 196 kinds. Shader lines are those that the switches leave.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from viewer.errors import InputError
from viewer.scene.load import load_scene

from . import corpus, machine, shot, tracing
from .growth_scenes import write
from .process import Run, run
from .programs import OURS, OURS_EVERYTHING, Program, ours
from .summary import values

MODELS = ("Box", "BoxTextured", "Duck", "UnlitTest", "Fox", "CesiumMilkTruck", "LightsPunctualLamp", "DamagedHelmet",
          "FlightHelmet", "MetalRoughSpheresNoTextures", "SheenCloth", "GlassVaseFlowers", "Mountains")
MATERIALS = 200
FIGURES = {"first_frame_s": "first frame, s", "frame_median_ms": "steady frame, ms",
           "gpu_mb": "textures and buffers, MB", "rss_mb": "peak memory, MB", "programs": "programs",
           "shader_lines": "shader lines", "shader_kb": "shader kB"}
_FORMS = {"first_frame_s": ".2f", "gpu_mb": ".1f", "rss_mb": ".0f", "frame_median_ms": ".1f", "shader_kb": ".1f",
          "programs": ".0f", "shader_lines": ",.0f"}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory(prefix="plans-") as name, machine.until_stopped():
        folder = Path(name)
        models = [corpus.model(model) for model in options.models]
        for path in [*models, write("materials", MATERIALS, folder)]:
            try:
                environment = "none" if load_scene(path).lights else options.env
            except InputError as error:
                print(f"{error}: left out")
                continue
            row = compare(path.resolve(), environment, folder, options)
            rows.append({"model": path.stem} | row)
            print(rows[-1], flush=True)
    loads = [row["load"] for row in rows if "load" in row]
    facts = machine.here() | {"size": f"{options.size}x{options.size}", "environment": Path(options.env).name,
                              "rounds": options.rounds, "frames a round": options.frames,
                              "load average": f"{min(loads)} to {max(loads)}" if loads else "unknown"}
    done = [row for row in rows if "error" not in row]
    text = ["# Needed / everything", "", *table([*done, total(done)] if done else rows), "", *summary(done)]
    tracing.keep("plans", facts, rows, text, options.results)


def compare(path: Path, environment: str, folder: Path, options: argparse.Namespace) -> dict[str, object]:
    """Of each figure the median over the rounds, by the plan of what is needed and, as all_..., by the other."""
    programs = [program for program in ours() if program.name in (OURS, OURS_EVERYTHING)]
    runs: dict[str, list[Run]] = {program.name: [] for program in programs}
    for number in range(options.rounds):
        for program in programs[::-1] if number % 2 else programs:
            runs[program.name].append(_run(program, path, environment, folder, options))
    errors = [str(one["error"]) for several in runs.values() for one in several if "error" in one]
    if errors:
        return {"error": errors[0]}
    row: dict[str, object] = {"load": max(one["load"] for several in runs.values() for one in several)}
    for program, prefix in zip(programs, ("", "all_")):
        row |= {prefix + key: statistics.median(values(runs[program.name], key)) for key in FIGURES}
    needed, everything = (np.asarray(Image.open(_picture(folder, program)), int) for program in programs)
    return row | {"apart": int(np.abs(needed - everything).max())}


def _run(program: Program, path: Path, environment: str, folder: Path, options: argparse.Namespace) -> Run:
    size = options.size, options.size
    picture = _picture(folder, program)
    command = program.frames(str(path), environment, size, picture, options.frames)
    with tempfile.TemporaryDirectory(dir=folder) as home:
        return run(command, picture, size, Path(home), shot.REPOSITORY)


def _picture(folder: Path, program: Program) -> Path:
    return folder / f"{program.name}.png"


def total(rows: Sequence[dict[str, object]]) -> dict[str, object]:
    """The sum of each figure."""
    keys = [prefix + key for prefix in ("", "all_") for key in FIGURES]
    return {"model": "all together"} | {key: sum(row[key] for row in rows) for key in keys} | {
        "apart": max(row["apart"] for row in rows)}


def table(rows: Sequence[dict[str, object]]) -> list[str]:
    """Needed / everything in each cell."""
    lines = ["| model | " + " | ".join(FIGURES.values()) + " | levels apart |", "|---" * (len(FIGURES) + 2) + "|"]
    for row in rows:
        if "error" in row:
            lines.append(f"| {row['model']} | {row['error']}" + " |" * (len(FIGURES) + 1))
            continue
        cells = [f"{row[key]:{_FORMS[key]}} / {row[f'all_{key}']:{_FORMS[key]}}" for key in FIGURES]
        lines.append(f"| {row['model']} | " + " | ".join(cells) + f" | {row['apart']} |")
    return lines


def summary(rows: Sequence[dict[str, object]]) -> list[str]:
    """Ratios of the whole to what is needed: the median model and both ends."""
    lines = []
    for key, name in FIGURES.items():
        ratios = sorted(row[f"all_{key}"] / row[key] for row in rows if row[key])
        if ratios:
            lines.append(f"- {name.split(',')[0]}: everything takes {statistics.median(ratios):.2f} times what is "
                         f"needed (median of {len(ratios)} models; {ratios[0]:.2f} to {ratios[-1]:.2f})")
    return lines


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.plans", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL", help="files, or names of the corpus")
    parser.add_argument("--env", default=shot.default_environment())
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--frames", type=int, default=7)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    options.models = options.models or corpus.present(MODELS) or [str(shot.REPOSITORY / "assets/demo.glb")]
    options.env = shot.inputs(shot.default_model(), corpus.environment(options.env))[1]
    return options


if __name__ == "__main__":
    main()
