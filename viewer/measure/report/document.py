"""report.json: what was measured, in the form that scripts depend on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from ...image.image import Image
from ...settings import STOPPING, Settings
from .errors import FREE_BY, MEASURES, Errors, errors, trimmed_floor
from .ladder import PLAIN, Method, settings_of
from .pareto import BUDGETS_MS, best_within, free_knobs, front
from .store import Record
from .survey import Survey

Document = dict[str, Any]
PREPARED = ("mode", "environment_shadows", "ambient_occlusion", "indirect", "reflections", "refraction", "denoise")
"""Settings whose choices take preparing of their own: baking, shadow maps, programs."""


@dataclass(frozen=True, eq=False)
class Rung:
    """A method with its picture, as it is displayed, and its errors."""

    method: Method
    record: Record
    image: Image
    errors: Errors
    ready_s: float
    """Of preparing, for this method alone."""


@dataclass(frozen=True, eq=False)
class Findings:
    """A report: `document` is report.json, `rungs` are in the order of its points."""

    document: Document
    reference: Image
    rungs: list[Rung]


def find(survey: Survey, scene: str, command: Callable[[Method], str], facts: Document) -> Findings:
    """What a survey that has a reference says. `facts` are added to the document; `command` gives a command line."""
    bench, reference, mask = survey.bench, survey.reference, survey.mask
    assert reference is not None and mask is not None
    truth = bench.displayed(reference.linear)
    ready = ready_seconds([(method.settings(bench.settings), record.facts.get("prepare_s", 0.0))
                           for method, record in survey.rungs])
    rungs = []
    for (method, record), seconds in zip(survey.rungs, ready, strict=True):
        image = bench.displayed(record.picture)
        rungs.append(Rung(method, record, image, errors(image, truth, mask), seconds))
    rungs.sort(key=lambda rung: rung.record.facts["time_ms"]["median"])
    times = [rung.record.facts["time_ms"]["median"] for rung in rungs]
    by_measure = {name: [getattr(rung.errors, name) for rung in rungs] for name in MEASURES}
    fronts = {name: front(times, values) for name, values in by_measure.items()}
    floors = _floors(survey, truth)
    document = {
        "scene": scene,
        "device": bench.context.renderer,
        "is_software": bench.context.is_software,
        "size": list(bench.size),
        "reference": {
            "method": "path traced", "spp": reference.spp, "relmse_floor": reference.floor(mask),
            "floor": floors, "seconds": reference.seconds,
        },
        "points": [
            {
                "method": rung.method.name, "title": rung.method.title, "label": rung.method.label,
                "settings": settings_of(rung.method, bench.settings),
                "time_ms": rung.record.facts["time_ms"], "error": rung.errors.to_json(),
                "pareto": fronts[MEASURES[0]][k], "pareto_by": {name: fronts[name][k] for name in MEASURES},
                "command": command(rung.method), "too_bright": rung.errors.too_bright,
                "bad_pixels": rung.errors.bad_pixels, "ready_s": rung.ready_s,
                **{name: value for name, value in rung.record.facts.items() if name != "time_ms"},
            } for k, rung in enumerate(rungs)
        ],
        "recommend": _recommend(times, by_measure),
        "knobs": _knobs(rungs, survey, floors),
        "raster": _raster(rungs),
        "left_out": [asdict(out) for out in survey.left_out],
        "is_whole": survey.is_whole,
        "model_pixels": int(mask.sum()),
        "opengl": bench.context.version,
        "backend": bench.context.backend,
        "version": version("pbr-viewer"),
        "measured_s": survey.seconds,
        **facts,
    }
    return Findings(document, truth, rungs)


def _floors(survey: Survey, truth: Image) -> dict[str, float]:
    """What the reference's own noise is in each measure: its halves are twice as far from one another (in relMSE four
    times) as their mean is from the truth."""
    bench, reference, mask = survey.bench, survey.reference, survey.mask
    assert reference is not None and mask is not None
    alpha = reference.linear[..., 3:]
    first, second = (bench.displayed(np.concatenate([half.astype(np.float32), alpha], axis=-1))
                     for half in (reference.halves.first, reference.halves.second))
    apart = errors(first, second, mask)
    return {"relmse": reference.floor(mask), "relmse_trimmed": trimmed_floor(reference.halves, mask),
            "rmse": apart.rmse / 2, "flip": apart.flip / 2}


def _recommend(times: Sequence[float], by_measure: dict[str, list[float]]) -> list[Document]:
    """For each budget the point of the least error, and in `by` that of each measure; null where none is so fast."""
    rows = []
    for budget in BUDGETS_MS:
        by = {name: best_within(budget, times, values) for name, values in by_measure.items()}
        rows.append({"budget_ms": budget, "point": by[MEASURES[0]], "by": by})
    return rows


def ready_seconds(rungs: Sequence[tuple[Settings, float]]) -> list[float]:
    """Of settings in the order they were measured in, and what preparing took beyond what was ready: about how long
    each would take to prepare by itself. What the first with the same choice of any of PREPARED took is part of it."""
    first: dict[tuple[object, ...], int] = {}
    result = []
    for k, (settings, _) in enumerate(rungs):
        is_traced = settings.mode == "path"  # the path tracer has its own scene
        needs = [(is_traced,), *((is_traced, name, getattr(settings, name)) for name in PREPARED)]
        payers = {first.setdefault(need, k) for need in needs}
        result.append(sum(rungs[payer][1] for payer in payers | {k}))
    return result


def _knobs(rungs: Sequence[Rung], survey: Survey, floors: Mapping[str, float]) -> list[Document]:
    """Settings that save time and cost no error, neither by figures nor to the eye.

    How long to go on is none of them: of two numbers of samples the fewer come out better by chance alone."""
    settings = [asdict(rung.method.settings(survey.bench.settings)) | {"lights": rung.method.lights is None}
                for rung in rungs]
    times = [rung.record.facts["time_ms"] for rung in rungs]
    found = [[getattr(rung.errors, name) for name in FREE_BY] for rung in rungs]
    return [{"setting": knob.setting, "cheap": knob.cheap, "dear": knob.dear, "values": list(knob.values),
             "saved": knob.saved} for knob in free_knobs(settings, times, found, [floors[name] for name in FREE_BY])
            if knob.setting not in STOPPING]


def _raster(rungs: Sequence[Rung]) -> Document | None:
    """How far the real-time picture gets: plain image-based light, and the best of the raster in ten times its time."""
    plain = [k for k, rung in enumerate(rungs) if rung.method == PLAIN]
    if not plain:
        return None
    most = 10 * rungs[plain[0]].record.facts["time_ms"]["median"]
    drawn = [k for k, rung in enumerate(rungs)
             if not rung.method.is_traced and rung.record.facts["time_ms"]["median"] <= most]
    result: Document = {"plain": plain[0], "most_ms": most}
    for name in MEASURES[:2]:
        best = min(drawn, key=lambda k: getattr(rungs[k].errors, name))
        ratio = getattr(rungs[best].errors, name) / max(getattr(rungs[plain[0]].errors, name), 1e-30)
        result[name] = {"best": best, "ratio": ratio}
    return result
