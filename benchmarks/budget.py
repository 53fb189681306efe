"""Whether a time budget holds, and how good its picture is beside the best single method:

    python -m benchmarks.budget [MODEL ...] [--sizes 256,512] [--budgets 0.05,0.1,0.3,1,3,10] [--json FILE]

A MODEL is a file or the name of one of the corpus, with `:none` behind it where no environment is to light it. Every
budget is tried by a command in a process of its own (`first`: the scene has to be made ready; `new`, at the smaller
size: the driver's cache of shaders is empty, too), and by the Python API on a scene that was drawn before (`ready`).
A budget counts if the first picture of the raster, the plainest, was ready in it.

The errors are against independent path-traced references at the smaller size, relative, of all pixels: of what came
out; of each candidate of the raster that ten seconds have made ready and that takes no longer than the budget; and of
paths alone in that time, as they are and filtered. `lost` is how many times the error of the best of those it is. On
average the references' noise adds nothing.
`--only ready` leaves the other kinds out. FILE.md gets the tables; Ctrl-C ends it with what there is. All ten models
should take about 35 minutes on two quiet cores. A part of it that says most, of all ten, should take ten:

    python -m benchmarks.budget --sizes 128 --budgets 0.3,1,3 --only ready --processor --json FILE

On a busy machine others' work makes budgets fail. With `--processor` all clocks, also those by which budgets are held,
count the processor time of the process, of all its threads together.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import viewer
from viewer.budget.candidates import candidates_for
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.shared import shared_renderer, shared_tracer

from . import corpus, tracing
from .against_paths import REFERENCES, reference_of, relative_errors
from .machine import by_processor_time, here, until_stopped
from .shot import default_model
from .tables import conditions

MODELS = ("DamagedHelmet", "GlamVelvetSofa", "GlassVaseFlowers", "Fox", "MetalRoughSpheresNoTextures",
          "LightsPunctualLamp:none", "ClearCoatTest", "SheenCloth", "AttenuationTest", "IridescenceSuzanne")
BUDGETS = "0.05,0.1,0.3,1,3,10"
KINDS = {"ready": "scene ready", "first": "first picture of a process", "new": "likewise, the driver's cache empty"}
HELD = 1.2
REFERENCE_SPP = 64
LEAST = 1e-3
"""Error below which none is told: what is left of the references' noise may be more."""

Row = dict[str, Any]


def main() -> None:
    options = _parse()
    seconds = by_processor_time() if options.processor else "by the clock"
    shared_tracer()
    rows: list[Row] = []
    about = here() | {"renderer": shared_renderer().context.renderer, "load before": round(os.getloadavg()[0], 1)}
    with until_stopped():
        present = [name for name in MODELS if corpus.present((name.partition(":")[0],))]
        for name in options.models or present or [default_model()]:
            _measure(name, options, rows)
    about |= {"load after": round(os.getloadavg()[0], 1), "seconds": seconds,
              "reference": f"{REFERENCES} times {options.spp} samples a pixel"}
    report = "\n\n".join([table(rows), errors(rows), conditions(about)])
    print(report)
    if options.json:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps({"about": about, "rows": rows}, indent=1) + "\n")
        options.json.with_suffix(".md").write_text(report + "\n")


def _measure(name: str, options: argparse.Namespace, rows: list[Row]) -> None:
    name, _, environment = name.partition(":")
    model = str(corpus.model(name))
    scene = viewer.load(model, None if environment == "none" else "studio")
    smallest = min(options.sizes)
    for size in options.sizes:
        single = _Single(scene, size, options.spp) if size == smallest else None
        ready = _warm(scene, size)
        for kind in options.only or (KINDS if size == smallest else ("ready", "first")):
            for budget in options.budgets:
                row = {"model": Path(model).stem, "size": size, "kind": kind, "budget": budget,
                       "load": round(os.getloadavg()[0], 1)}
                row |= _ready(scene, size, budget, single, ready) if kind == "ready" else _first(
                    model, environment or "studio", size, budget, kind == "new", options.processor)
                rows.append(row)
                print(_line(row), flush=True)


def _warm(scene: Scene, size: int) -> set[str]:
    """Make the scene ready, as one in use is. Returns the candidates of the raster that are ready then."""
    made = [viewer.render(scene, (size, size), time_budget=seconds) for seconds in (10.0, 3.0, 0.3, 0.1)]
    drawn: list[dict[str, Any]] = [one for image in made for one in image.stats["choice"]["candidates"]]  # type: ignore
    return {one["method"] for one in drawn if one["seconds"] is not None}


class _Single:
    """References, and the errors and times of the single methods."""

    def __init__(self, scene: Scene, size: int, spp: int) -> None:
        self._scene, self._size = scene, (size, size)
        camera, settings = scene.framing_camera(1.0), Settings(mode="path")
        self._reference = reference_of(shared_tracer(), scene, camera, settings, size, spp)
        self._candidates: dict[str, tuple[float, float]] = {}
        for title, settings in candidates_for(scene, Settings()):
            changed = {name: value for name, value in vars(settings).items() if value != getattr(Settings(), name)}
            seconds = []
            for _ in range(3):
                started = time.perf_counter()
                picture = viewer.render(scene, self._size, **changed)
                seconds.append(time.perf_counter() - started)
            self._candidates[title] = min(seconds), self.error(picture)

    def error(self, image: viewer.Image) -> float:
        squared = relative_errors(np.nan_to_num(tracing.radiance(image)), self._reference)
        return math.sqrt(max(float(squared.mean()), LEAST**2))

    def within(self, budget: float, ready: set[str]) -> dict[str, float]:
        """The errors of all that there is time for, of the candidates that are ready."""
        found = {title: error for title, (seconds, error) in self._candidates.items()
                 if title in ready and seconds <= budget}
        for denoise in ("off", "fast"):
            started = time.perf_counter()
            image = viewer.render(self._scene, self._size, mode="path", time_budget=budget, denoise=denoise)
            if time.perf_counter() - started <= HELD * budget:
                found[f"paths, {denoise}"] = self.error(image)
        return found


_BY_PROCESSOR = "from benchmarks.machine import by_processor_time; by_processor_time(); "
_COMMAND = "from viewer.__main__ import main; main()"


def _first(model: str, environment: str, size: int, budget: float, is_new: bool, by_processor: bool) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        caches = {"MESA_SHADER_CACHE_DIR": folder, "__GL_SHADER_DISK_CACHE_PATH": folder} if is_new else {}
        command = _BY_PROCESSOR * by_processor + _COMMAND
        subprocess.run([sys.executable, "-c", command, "render", model, "-o", f"{folder}/a.exr", "--size", str(size),
                        "--env", environment, "--time-budget", str(budget), "--stats", str(stats), "-q"], check=True,
                       env=os.environ | caches)
        return _facts(json.loads(stats.read_text())["choice"], budget)


def _ready(scene: Scene, size: int, budget: float, single: _Single | None, ready: set[str]) -> Row:
    image = viewer.render(scene, (size, size), time_budget=budget)
    choice: dict[str, Any] = image.stats["choice"]  # type: ignore[assignment]
    row = _facts(choice, budget)
    if single is None:
        return row
    others = single.within(budget, ready)
    row |= {"error": single.error(image), "told": [choice[name] for name in ("error", "error_low", "error_high")],
            "errors": others}
    return row | ({"lost": row["error"] / min(others.values())} if others else {})


def _facts(choice: dict[str, Any], budget: float) -> Row:
    """`possible`: the first candidate that was drawn was ready in time."""
    drawn = [one["seconds"] for one in choice["candidates"] if one["seconds"] is not None]
    return {"ratio": choice["seconds"] / budget, "method": choice["method"], "spp": choice["spp"],
            "unmet": choice["unmet"], "possible": drawn[0] <= budget}


def table(rows: Sequence[Row]) -> str:
    """How well budgets held, one column each."""
    budgets = sorted({row["budget"] for row in rows})
    lines = ["| at most 1.2 times the budget, of those in which the plainest picture is ready (the worst) | "
             + " | ".join(f"{budget:g} s" for budget in budgets) + " |", "|---" * (len(budgets) + 1) + "|"]
    for kind, words in KINDS.items():
        cells = [[row for row in rows if (row["kind"], row["budget"]) == (kind, budget) and row["possible"]]
                 for budget in budgets]
        if any(row["kind"] == kind for row in rows):
            lines.append(f"| {words} | " + " | ".join(
                f"{sum(row['ratio'] <= HELD for row in cell)} of {len(cell)} "
                f"({max(row['ratio'] for row in cell):.2f})" if cell else "none" for cell in cells) + " |")
    return "\n".join(lines)


def errors(rows: Sequence[Row]) -> str:
    """How good the pictures of scenes that were ready are, and what is told of them."""
    lines = ["| budget, s | pictures | error, median | told, median | interval holds it | times the best single "
             "method's: median (worst) |", "|---|---|---|---|---|---|"]
    for budget in sorted({row["budget"] for row in rows}):
        cell = [row for row in rows if "lost" in row and row["budget"] == budget]
        told = [row for row in cell if row["told"][0] is not None]
        if cell:
            error, lost = ([row[name] for row in cell] for name in ("error", "lost"))
            held = sum(row["told"][1] <= row["error"] <= row["told"][2] for row in told)
            middle = f"{median(row['told'][0] for row in told):.3f} | {held} of {len(told)}" if told else "- | -"
            lines.append(f"| {budget:g} | {len(cell)} | {median(error):.3f} | {middle} | {median(lost):.2f} "
                         f"({max(lost):.2f}) |")
    return "\n".join(lines)


def _line(row: Row) -> str:
    words = [f"{row['model']} {row['size']} {row['kind']} {row['budget']:g} s: {row['ratio']:.2f} of it", row["method"]]
    words += [] if row["spp"] is None else [f"{row['spp']:.3g} spp"]
    if "error" in row:
        told = "" if row["told"][0] is None else " (told {:.3g}, {:.3g} to {:.3g})".format(*row["told"])
        words.append(f"error {row['error']:.3g}{told}")
    if "lost" in row:
        best = min(row["errors"], key=row["errors"].get)
        words.append(f"{row['lost']:.2f} times the best, {best}")
    return ", ".join([*words, *([row["unmet"]] if row["unmet"] else []), f"load {row['load']}"])


def _parse() -> argparse.Namespace:
    def several(kind: type) -> Any:
        return lambda text: [kind(word) for word in text.split(",")]

    parser = argparse.ArgumentParser(prog="python -m benchmarks.budget", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--sizes", type=several(int), default="256,512")
    parser.add_argument("--budgets", type=several(float), default=BUDGETS)
    parser.add_argument("--only", type=several(str), metavar="KIND,...", help=f"of {', '.join(KINDS)}")
    parser.add_argument("--spp", type=int, default=REFERENCE_SPP, help="of each reference (64)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep every run there, and the tables beside it")
    parser.add_argument("--processor", action="store_true", help="seconds are those of processor time")
    return parser.parse_args()


if __name__ == "__main__":
    main()
