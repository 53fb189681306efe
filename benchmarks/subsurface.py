"""Subsurface scattering of the rasterizer against another renderer's: `python -m benchmarks.subsurface`.

The cases of ../shared/truth with a dense medium behind a boundary, by every choice of `subsurface`, as they are and
with the setting that gives the raster the light of other surfaces, with the time of a frame.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import relmse
from viewer.raster.renderer import Renderer
from viewer.settings import Settings, ignored, setting_choices

from .truth_cases import Case, load_case

CASES = ("wax", "milk-rough")
LIGHT: dict[str, dict[str, object]] = {"": {}, "indirect=baked": {"indirect": "baked"}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--results", type=Path)
    options = parser.parse_args()
    with open_context() as context:
        lines = ["# Light scattered inside of solids, in the rasterizer", "",
                 "By `python -m benchmarks.subsurface`. relMSE and mean are those of the whole picture, 128 x 128, "
                 "against Mitsuba; the floor", "is the noise of the reference. The time is the median of a frame with "
                 "everything prepared. Errors do not depend on what", "else the machine does, and times do.", "",
                 f"{context.renderer}; {os.cpu_count()} cores, load average {os.getloadavg()[0]:.0f} at the start", "",
                 "| case | subsurface | other settings | relMSE | floor | mean / reference | ms |",
                 "|---|---|---|---|---|---|---|"]
        renderer = Renderer(context)
        for name in CASES:
            lines += _rows(renderer, load_case(name), options.frames)
    print("\n".join(lines))
    if options.results is not None:
        options.results.write_text("\n".join(lines) + "\n")


def _rows(renderer: Renderer, case: Case, frames: int) -> list[str]:
    rows = []
    base = {key: value for key, value in case.settings.items() if key not in ignored("pbr")}
    for title, light in LIGHT.items():
        for method in setting_choices()["subsurface"]:
            settings = replace(Settings.of(**(base | light)), subsurface=method)
            times = []
            for _ in range(frames + 1):
                start = time.perf_counter()
                picture = renderer.render(case.scene, case.camera, settings, case.size).linear[..., :3]
                times.append(1e3 * (time.perf_counter() - start))
            picture = picture.astype(np.float64)
            rows.append(f"| {case.name} | {method} | {title} | {float(relmse(picture, case.reference)):.4f} | "
                        f"{case.floor:.4f} | {picture.mean() / case.reference.mean():.3f} | "
                        f"{statistics.median(times[1:]):.0f} |")
    return rows


if __name__ == "__main__":
    main()
