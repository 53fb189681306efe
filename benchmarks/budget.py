"""Whether a time budget holds, and whether the method chosen for it is the best there was:

    python -m benchmarks.budget [MODEL ...] [--sizes 256,512] [--budgets 0.05,0.1,0.3,1,3] [--json FILE]

Every budget is tried twice on each model: by a command in a process of its own (`cold`: the scene has to be made
ready), and by the Python API on a scene that was drawn before (`ready`). The errors are against a path-traced
reference at the smaller size, relative, of all pixels, for what was chosen and for each candidate that was expected to
be in time; `lost` is how many times the error of the best of them was taken. None is known better than the reference's
own noise.
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
from pathlib import Path
from typing import Any

import numpy as np

import viewer
from viewer.api import shared_chooser
from viewer.budget.choice import candidates
from viewer.measure.relmse import EPSILON
from viewer.scene.scene import Scene
from viewer.settings import Settings

from .shot import default_model

BUDGETS = "0.05,0.1,0.3,1,3"
REFERENCE_SPP = 128
_SEED = 1 << 24


def main() -> None:
    options = _parse()
    chooser = shared_chooser()
    chooser.calibrate(print)
    rows: list[dict[str, Any]] = []
    sizes, budgets = ([kind(one) for one in text.split(",")] for kind, text in
                      ((int, options.sizes), (float, options.budgets)))
    for model in options.models or [default_model()]:
        scene = viewer.load(model)
        truth = _Truth(scene, min(sizes), options.spp)
        for size in sizes:
            for kind in ("cold", "ready"):
                for budget in budgets:
                    row = {"model": Path(model).stem, "size": size, "kind": kind, "budget": budget,
                           "load": round(os.getloadavg()[0], 1)}
                    row |= _cold(model, size, budget) if kind == "cold" else _ready(scene, size, budget, truth)
                    rows.append(row)
                    print(_line(row), flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


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


def _cold(model: str, size: int, budget: float) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        subprocess.run([sys.executable, "-m", "viewer", "render", model, "-o", f"{folder}/a.exr", "--size", str(size),
                        "--time-budget", str(budget), "--stats", str(stats), "-q"], check=True)
        choice = json.loads(stats.read_text())["choice"]
    return {"ratio": choice["seconds"] / budget, "method": choice["method"], "spp": choice["spp"],
            "unmet": choice["unmet"]}


def _ready(scene: Scene, size: int, budget: float, truth: _Truth) -> dict[str, Any]:
    viewer.render(scene, (size, size), time_budget=budget)
    started = time.perf_counter()
    image = viewer.render(scene, (size, size), time_budget=budget)
    seconds = time.perf_counter() - started
    choice: dict[str, Any] = image.stats["choice"]  # type: ignore[assignment]
    row = {"ratio": seconds / budget, "method": choice["method"], "spp": choice["spp"], "unmet": choice["unmet"]}
    if size != truth.size:
        return row
    chooser = shared_chooser()
    found = candidates(chooser.calibrate(), scene, (size, size), Settings(time_budget=budget), chooser.ready)
    errors = {}
    for one in found:
        if one.fits(budget):
            spp = None if one.samples is None else max(round(one.samples), 1)
            errors[one.title] = truth.error_of(_plain(one.settings, spp))
    row |= {"error": truth.error(image), "told": choice["error"], "errors": errors}
    return row | ({"lost": row["error"] / min(errors.values())} if errors else {})


def _plain(settings: Settings, spp: int | None) -> Settings:
    return Settings(**{**vars(settings), "time_budget": None, "spp": spp})


def _line(row: dict[str, Any]) -> str:
    words = [f"{row['model']} {row['size']} {row['kind']} {row['budget']:g} s: {row['ratio']:.2f} of it", row["method"]]
    words += [] if row["spp"] is None else [f"{row['spp']:.3g} spp"]
    if "error" in row:
        words.append(f"error {row['error']:.3g} (told {row['told']:.3g})")
    if "lost" in row:
        words.append(f"{row['lost']:.2f} times the best")
    return ", ".join([*words, *([row["unmet"]] if row["unmet"] else []), f"load {row['load']}"])


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.budget", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL")
    parser.add_argument("--sizes", default="256,512")
    parser.add_argument("--budgets", default=BUDGETS)
    parser.add_argument("--spp", type=int, default=REFERENCE_SPP, help="of the reference")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep every run there")
    return parser.parse_args()


if __name__ == "__main__":
    main()
