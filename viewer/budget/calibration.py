"""What is known of a device: how long each method takes on it, and how wrong each usually is."""

from __future__ import annotations

import json
import math
import os
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ..bake import cache
from .cost import Cost

LIGHTINGS = ("environment", "lights")
"""What lights a scene decides how wrong the raster is: an environment, or lights alone."""
DISTINCT = 2.0
"""Times as long as a program from disk a new one takes, where the driver keeps any."""
_COSTS = ("compile_new", "compile", "filter_new", "filter", "prepare", "picture", "sample", "finish", "denoise")
_PACKAGE = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class RasterMethod:
    """A method of `viewer.measure.report.ladder` that draws triangles.

    `prepare` is for a scene that is new, `picture` for one once that is done, from the first command to the pixels in
    memory; `compile` is for programs that the process has not compiled but the driver keeps on disk, `compile_new` for
    those it has never seen. `errors` are relative, by lighting, of the scenes the calibration is made on.
    """

    title: str
    changes: dict[str, Any]
    compile_new: Cost
    compile: Cost
    prepare: Cost
    picture: Cost
    errors: dict[str, float]


@dataclass(frozen=True)
class TracedMethod:
    """The path tracer. `sample` is one of every pixel, `finish` all after the last one, `denoise` what filtering adds;
    `compile` and `compile_new` are as those of the raster, `filter` and `filter_new` the filter's.

    `errors` are of one sample a pixel, by lighting; `denoised` are pairs of the error of samples and by how much
    filtering multiplies it, in descending order of error.
    """

    compile_new: Cost
    compile: Cost
    filter_new: Cost
    filter: Cost
    prepare: Cost
    sample: Cost
    finish: Cost
    denoise: Cost
    errors: dict[str, float]
    denoised: tuple[tuple[float, float], ...]

    def error(self, lighting: str, samples: float, is_denoised: bool) -> float:
        raw = self.errors[lighting] / math.sqrt(samples)
        return raw * self.factor(raw) if is_denoised else raw

    def factor(self, raw: float) -> float:
        """By how much filtering multiplies an error of so much."""
        if not 0 < raw < math.inf:
            return 1.0
        errors, factors = zip(*reversed(self.denoised))
        return float(np.interp(math.log(raw), np.log(errors), factors))


@dataclass(frozen=True)
class Calibration:
    """All seconds are as if nothing else were at work.

    `start` is what the first picture of a process costs on top, by raster or path tracer: code is loaded, drivers
    begin. `first_program` is how long the first program of a process takes, where the driver keeps none on disk and
    where it does: which of the two it is nearer to tells whether what was compiled once still lies there.
    """

    raster: tuple[RasterMethod, ...]
    traced: TracedMethod
    start: dict[str, float]
    first_program: tuple[float, float] = (0.0, 0.0)

    def is_forgotten(self, seconds: float) -> bool:
        """Whether a first program that took so long was not on disk."""
        new, kept = self.first_program
        return new > DISTINCT * kept and seconds > math.sqrt(new * kept)

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, content: dict[str, Any]) -> Calibration:
        """Raises ValueError, KeyError, TypeError for what `to_json` did not write."""
        raster = tuple(RasterMethod(**{**one, **_costs(one)}) for one in content["raster"])
        traced = {**content["traced"], **_costs(content["traced"])}
        traced["denoised"] = tuple((float(error), float(factor)) for error, factor in traced["denoised"])
        start = {name: float(content["start"][name]) for name in ("raster", "path")}
        new, kept = (float(seconds) for seconds in content["first_program"])
        found = cls(raster, TracedMethod(**traced), start, (new, kept))
        if not raster or not found.traced.denoised or not all(
                math.isfinite(error) and error > 0 for errors in (*(one.errors for one in raster), found.traced.errors)
                for error in errors.values()):
            raise ValueError("no calibration")
        return found


def load_calibration(renderer: str) -> Calibration | None:
    """That of the device with this name; None where there is none yet, or it cannot be read."""
    kept = cache.load(_key(renderer))
    try:
        return None if kept is None else Calibration.from_json(json.loads(kept["calibration"].tobytes()))
    except (KeyError, TypeError, ValueError):
        return None


def store_calibration(renderer: str, calibration: Calibration) -> None:
    """Failing to is no error."""
    text = json.dumps(calibration.to_json()).encode()
    cache.store(_key(renderer), {"calibration": np.frombuffer(text, np.uint8)})


def _key(renderer: str) -> str:
    from ..base.digest import code_digest, digest

    sources = [*sorted(Path(__file__).parent.glob("*.py")), _PACKAGE / "measure" / "report" / "ladder.py"]
    ours = digest(*(path.read_bytes() for path in sources))
    return cache.key("calibration", renderer, version("pbr-viewer"), os.cpu_count(), code_digest(), ours)


def _costs(content: dict[str, Any]) -> dict[str, Cost]:
    return {name: Cost(**value) for name, value in content.items() if name in _COSTS}
