"""What the benchmarks of the path tracer share: runs against the clock, pictures in halves, results on disk."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from viewer.image.image import Image
from viewer.measure.compare.relmse import Halves
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import machine, tables

SLICE = 0.25
"""Seconds of work between two looks at the clock."""


@dataclass(frozen=True, eq=False)
class Shot:
    """A finished picture: its radiance (H, W, 3), and what it took. `seconds` counts the work alone."""

    pixels: np.ndarray
    spp: float
    seconds: float
    rays: int

    def to_json(self) -> dict[str, float]:
        samples = self.spp * self.pixels.shape[0] * self.pixels.shape[1]
        return {"spp": round(self.spp, 2), "seconds": round(self.seconds, 4),
                "rays_per_second": round(self.rays / self.seconds), "samples_per_second": round(samples / self.seconds)}


def shoot(tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
          seconds: float = math.inf) -> Shot:
    """One picture, to the end that `settings` set, or as far as it comes in so many seconds of work."""
    exposure = tracer.begin(scene, camera, settings, size)
    try:
        while not exposure.is_done and exposure.seconds < seconds:
            exposure.step(min(SLICE, seconds - exposure.seconds))
        return Shot(radiance(exposure.image()), exposure.samples, exposure.seconds, exposure.rays)
    finally:
        exposure.release()


def halves(tracer: Tracer, scene: Scene, camera: Camera, size: tuple[int, int], seed: int = 1,
           **settings: object) -> tuple[Halves, Shot]:
    """Two pictures of different seeds; the second of the pair is the sum of what they took."""
    shots = [shoot(tracer, scene, camera, Settings.of(**({"mode": "path", "seed": seed + k} | settings)), size)
             for k in (0, 1)]
    both = Halves(shots[0].pixels, shots[1].pixels)
    return both, Shot(both.mean, *(sum(getattr(shot, name) for shot in shots) for name in ("spp", "seconds", "rays")))


def radiance(image: Image) -> np.ndarray:
    """Linear, (H, W, 3) float64."""
    return image.linear[..., :3].astype(np.float64)


def conditions(tracer: Tracer) -> dict[str, object]:
    """The machine, its load at this moment, and what draws and intersects."""
    context = tracer.context
    return machine.here() | {"renderer": f"{context.renderer}, {context.backend}",
                             "load average": os.getloadavg()[0]}


def keep(name: str, facts: dict[str, object], rows: list[dict[str, object]], text: list[str], folder: Path) -> None:
    """Writes NAME.json and NAME.md into `folder` and prints the latter."""
    folder.mkdir(parents=True, exist_ok=True)
    written = {"conditions": facts, "rows": rows}
    (folder / f"{name}.json").write_text(json.dumps(written, indent=1) + "\n")
    page = "\n".join([*text, "", tables.conditions(facts), ""])
    (folder / f"{name}.md").write_text(page)
    print(page)


def table(rows: list[dict[str, object]], columns: dict[str, str]) -> list[str]:
    """A Markdown table: `columns` maps each heading to "key" or "key:format"."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        cells = []
        for column in columns.values():
            key, _, form = column.partition(":")
            value = row.get(key)
            cells.append("" if value is None else format(value, form))
        lines.append("| " + " | ".join(cells) + " |")
    return lines
