"""Whether a time budget holds, and whether the method chosen for it is the best there was:

    python -m benchmarks.budget [MODEL ...] [--sizes 256,512] [--budgets 0.05,0.1,0.3,1,3] [--json FILE]

A MODEL is a file or the name of one of the corpus, with `:none` behind it where no environment is to light it. Every
budget is tried by a command in a process of its own (`first`: the scene has to be made ready; `new`, at the smaller
size: the driver's cache of shaders is empty, too), and by the Python API on a scene that was drawn before (`ready`).
The errors are against a path-traced reference at the smaller size, relative, of all pixels, for what was chosen and for
each candidate that was expected to be in time; `lost` is how many times the error of the best of them was taken. None
is known better than the reference's own noise. FILE.md gets the tables; Ctrl-C ends it with what there is.
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
from viewer.api import shared_chooser, shared_renderer
from viewer.measure.compare.relmse import EPSILON
from viewer.scene.scene import Scene
from viewer.settings import Settings

from . import corpus
from .machine import here, until_stopped
from .shot import default_model
from .tables import conditions

MODELS = ("DamagedHelmet", "GlamVelvetSofa", "GlassVaseFlowers", "Fox", "MetalRoughSpheresNoTextures",
          "LightsPunctualLamp:none")
BUDGETS = "0.05,0.1,0.3,1,3"
KINDS = {"ready": "scene ready", "first": "first picture of a process", "new": "likewise, the driver's cache empty"}
HELD = 1.2
REFERENCE_SPP = 128
_SEED = 1 << 24

Row = dict[str, Any]


def main() -> None:
    options = _parse()
    rows: list[Row] = []
    about = here() | {"renderer": shared_renderer().context.renderer, "load before": round(os.getloadavg()[0], 1)}
    with until_stopped():
        started = time.perf_counter()
        shared_chooser().calibrate(print)
        about["calibration"] = f"{time.perf_counter() - started:.1f} s"
        present = [name for name in MODELS if corpus.present((name.partition(":")[0],))]
        for name in options.models or present or [default_model()]:
            _measure(name, options, rows)
    report = "\n\n".join([conditions(about), table(rows), choices(rows)])
    print(report)
    if options.json:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps({"about": about, "rows": rows}, indent=1) + "\n")
        options.json.with_suffix(".md").write_text(report + "\n")


def _measure(name: str, options: argparse.Namespace, rows: list[Row]) -> None:
    name, _, environment = name.partition(":")
    model = str(corpus.model(name))
    scene = viewer.load(model, None if environment == "none" else "studio")
    truth = _Truth(scene, min(options.sizes), options.spp)
    for size in options.sizes:
        for kind in KINDS if size == truth.size else ("ready", "first"):
            for budget in options.budgets:
                row = {"model": Path(model).stem, "size": size, "kind": kind, "budget": budget,
                       "load": round(os.getloadavg()[0], 1)}
                row |= _ready(scene, size, budget, truth) if kind == "ready" else _first(
                    model, environment or "studio", size, budget, kind == "new")
                rows.append(row)
                print(_line(row), flush=True)


class _Truth:
    """A reference at one size, and the errors of what was measured against it."""

    def __init__(self, scene: Scene, size: int, spp: int) -> None:
        self.scene, self.size = scene, size
        image = viewer.render(scene, (size, size), mode="path", spp=spp, seed=_SEED)
        self._linear, self._variance = image.linear[..., :3].astype(float), image.stats["estimated_error"] ** 2
        self._known: dict[Settings, float] = {}

    def error(self, image: viewer.Image) -> float:
        squared = (image.linear[..., :3] - self._linear) ** 2 / (self._linear**2 + EPSILON)
        return math.sqrt(max(float(np.nan_to_num(squared).mean()) - self._variance, self._variance))

    def error_of(self, settings: Settings) -> float:
        if settings not in self._known:
            values = {name: value for name, value in vars(settings).items() if value != getattr(Settings(), name)}
            self._known[settings] = self.error(viewer.render(self.scene, (self.size,) * 2, mode=settings.mode,
                                                             **{k: v for k, v in values.items() if k != "mode"}))
        return self._known[settings]


def _first(model: str, environment: str, size: int, budget: float, is_new: bool) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        caches = {"MESA_SHADER_CACHE_DIR": folder, "__GL_SHADER_DISK_CACHE_PATH": folder} if is_new else {}
        subprocess.run([sys.executable, "-m", "viewer", "render", model, "-o", f"{folder}/a.exr", "--size", str(size),
                        "--env", environment, "--time-budget", str(budget), "--stats", str(stats), "-q"], check=True,
                       env=os.environ | caches)
        return _facts(json.loads(stats.read_text())["choice"], budget)


def _ready(scene: Scene, size: int, budget: float, truth: _Truth) -> Row:
    viewer.render(scene, (size, size), time_budget=budget)
    image = viewer.render(scene, (size, size), time_budget=budget)
    choice: dict[str, Any] = image.stats["choice"]  # type: ignore[assignment]
    row = _facts(choice, budget)
    if size != truth.size:
        return row
    errors = {}
    for one in shared_chooser().weigh(scene, Settings(time_budget=budget), (size, size)):
        if one.fits(budget):
            spp = None if one.samples is None else max(round(one.samples), 1)
            errors[one.title] = truth.error_of(Settings(**{**vars(one.settings), "time_budget": None, "spp": spp}))
    row |= {"error": truth.error(image), "told": choice["error"], "errors": errors}
    return row | ({"lost": row["error"] / min(errors.values())} if errors else {})


def _facts(choice: dict[str, Any], budget: float) -> Row:
    """`possible`: something was expected to be done in time."""
    possible = any(one["expected_s"] <= budget for one in choice["candidates"])
    return {"ratio": choice["seconds"] / budget, "method": choice["method"], "spp": choice["spp"],
            "unmet": choice["unmet"], "possible": possible}


def table(rows: Sequence[Row]) -> str:
    """How well budgets held, one column each."""
    budgets = sorted({row["budget"] for row in rows})
    lines = ["| at most 1.2 times the budget, of those where something was expected in time (the worst) | "
             + " | ".join(f"{budget:g} s" for budget in budgets) + " |", "|---" * (len(budgets) + 1) + "|"]
    for kind, words in KINDS.items():
        cells = [[row for row in rows if (row["kind"], row["budget"]) == (kind, budget) and row["possible"]]
                 for budget in budgets]
        if any(row["kind"] == kind for row in rows):
            lines.append(f"| {words} | " + " | ".join(
                f"{sum(row['ratio'] <= HELD for row in cell)} of {len(cell)} "
                f"({max(row['ratio'] for row in cell):.2f})" if cell else "none" for cell in cells) + " |")
    return "\n".join(lines)


def choices(rows: Sequence[Row]) -> str:
    """How good what was chosen is, on scenes that were ready."""
    lines = ["| budget, s | error, median | told, median | times that of the best in time: median (worst) |",
             "|---|---|---|---|"]
    for budget in sorted({row["budget"] for row in rows}):
        cell = [row for row in rows if "lost" in row and row["budget"] == budget]
        if cell:
            error, told, lost = ([row[name] for row in cell] for name in ("error", "told", "lost"))
            lines.append(f"| {budget:g} | {median(error):.3f} | {median(told):.3f} | {median(lost):.2f} "
                         f"({max(lost):.2f}) |")
    return "\n".join(lines)


def _line(row: Row) -> str:
    words = [f"{row['model']} {row['size']} {row['kind']} {row['budget']:g} s: {row['ratio']:.2f} of it", row["method"]]
    words += [] if row["spp"] is None else [f"{row['spp']:.3g} spp"]
    if "error" in row:
        words.append(f"error {row['error']:.3g} (told {row['told']:.3g})")
    if "lost" in row:
        words.append(f"{row['lost']:.2f} times the best")
    return ", ".join([*words, *([row["unmet"]] if row["unmet"] else []), f"load {row['load']}"])


def _parse() -> argparse.Namespace:
    def several(kind: type) -> Any:
        return lambda text: [kind(word) for word in text.split(",")]

    parser = argparse.ArgumentParser(prog="python -m benchmarks.budget", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--sizes", type=several(int), default="256,512")
    parser.add_argument("--budgets", type=several(float), default=BUDGETS)
    parser.add_argument("--spp", type=int, default=REFERENCE_SPP, help="of the reference")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep every run there, and the tables beside it")
    return parser.parse_args()


if __name__ == "__main__":
    main()
