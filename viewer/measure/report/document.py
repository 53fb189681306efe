"""report.json: what was measured, in the form that scripts depend on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from ...image.image import Image
from ...quality import QUALITIES
from ...settings import STOPPING, Settings
from .errors import FREE_BY, MEASURES, Errors, errors, trimmed_floor
from .ladder import PLAIN, Method, settings_of
from .pareto import BUDGETS_MS, best_within, free_knobs, front
from .store import Record
from .survey import Survey

Document = dict[str, Any]
PREPARED = ("mode", "environment_shadows", "ambient_occlusion", "indirect", "reflections", "refraction", "denoise")
"""Settings each choice of which is prepared by itself: baking, shadow maps, programs."""


@dataclass(frozen=True, eq=False)
class Point:
    """A method with its picture, as it is displayed, and its errors: a point of the charts."""

    method: Method
    record: Record
    image: Image
    errors: Errors
    ready_s: float
    """Seconds of preparing, if no other method is used."""


@dataclass(frozen=True, eq=False)
class Findings:
    """A report: `document` is report.json, whose points are `points`."""

    document: Document
    reference: Image
    points: list[Point]


def make_findings(survey: Survey, scene: str, command: Callable[[Method], str], facts: Document) -> Findings:
    """The report of a survey that has a reference. `facts` are added to the document; `command` gives command lines."""
    bench, reference, mask = survey.bench, survey.reference, survey.mask
    assert reference is not None and mask is not None
    truth = bench.displayed(reference.linear)
    ready = ready_seconds([(method.settings(bench.settings), record.facts.get("prepare_s", 0.0))
                           for method, record in survey.measured])
    points = []
    for (method, record), seconds in zip(survey.measured, ready, strict=True):
        image = bench.displayed(record.picture)
        points.append(Point(method, record, image, errors(image, truth, mask), seconds))
    points.sort(key=lambda point: point.record.facts["time_ms"]["median"])
    times = [point.record.facts["time_ms"]["median"] for point in points]
    by_measure = {name: [getattr(point.errors, name) for point in points] for name in MEASURES}
    fronts = {name: front(times, values) for name, values in by_measure.items()}
    floors = _floors(survey)
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
                "method": point.method.name, "title": point.method.title, "label": point.method.label,
                "settings": settings_of(point.method, bench.settings), "quality": point.method.quality,
                "time_ms": point.record.facts["time_ms"], "error": point.errors.to_json(),
                "pareto": fronts[MEASURES[0]][k], "pareto_by": {name: fronts[name][k] for name in MEASURES},
                "command": command(point.method), "too_bright": point.errors.too_bright,
                "bad_pixels": point.errors.bad_pixels, "ready_s": point.ready_s,
                **{name: value for name, value in point.record.facts.items() if name != "time_ms"},
            } for k, point in enumerate(points)
        ],
        "recommend": _recommend(times, by_measure),
        "qualities": {name: next((k for k, point in enumerate(points) if point.method.quality == name), None)
                      for name in QUALITIES},
        "knobs": _knobs(points, survey, floors),
        "raster": _raster(points),
        "left_out": [asdict(out) for out in survey.left_out],
        "is_whole": survey.is_whole,
        "model_pixels": int(mask.sum()),
        "opengl": bench.context.version,
        "backend": bench.context.backend,
        "version": version("pbr-viewer"),
        "measured_s": survey.seconds,
        **facts,
    }
    return Findings(document, truth, points)


def _floors(survey: Survey) -> dict[str, float]:
    """The reference's own noise in each measure.

    The difference of its halves is twice as large (in relMSE four times) as the error of their mean."""
    bench, reference, mask = survey.bench, survey.reference, survey.mask
    assert reference is not None and mask is not None
    alpha = reference.linear[..., 3:]
    first, second = (bench.displayed(np.concatenate([half.astype(np.float32), alpha], axis=-1))
                     for half in (reference.halves.first, reference.halves.second))
    apart = errors(first, second, mask)
    return {"relmse": reference.floor(mask), "relmse_trimmed": trimmed_floor(reference.halves, mask),
            "rmse": apart.rmse / 2, "flip": apart.flip / 2}


def _recommend(times: Sequence[float], by_measure: dict[str, list[float]]) -> list[Document]:
    """For each time the point with the smallest error, and in `by` that of each measure; null if none is so fast."""
    rows = []
    for budget in BUDGETS_MS:
        by = {name: best_within(budget, times, values) for name, values in by_measure.items()}
        rows.append({"budget_ms": budget, "point": by[MEASURES[0]], "by": by})
    return rows


def ready_seconds(measured: Sequence[tuple[Settings, float]]) -> list[float]:
    """About how long each settings would take to prepare by itself, in seconds.

    `measured` are settings in the order in which they were measured, and what preparing each took, given what earlier
    ones had prepared. So the time of the first settings with the same choice of any of PREPARED is added."""
    first: dict[tuple[object, ...], int] = {}
    result = []
    for k, (settings, _) in enumerate(measured):
        is_traced = settings.mode == "path"  # the path tracer has its own scene
        needs = [(is_traced,), *((is_traced, name, getattr(settings, name)) for name in PREPARED)]
        shared = {first.setdefault(need, k) for need in needs}
        result.append(sum(measured[other][1] for other in shared | {k}))
    return result


def _knobs(points: Sequence[Point], survey: Survey, floors: Mapping[str, float]) -> list[Document]:
    """Settings that save time and add no error, neither in radiance nor as displayed.

    Settings that say when sampling stops are left out: that fewer samples come out better is chance."""
    settings = [asdict(point.method.settings(survey.bench.settings)) | {"lights": point.method.lights is None}
                for point in points]
    times = [point.record.facts["time_ms"] for point in points]
    found = [[getattr(point.errors, name) for name in FREE_BY] for point in points]
    return [{"setting": knob.setting, "cheap": knob.cheap, "dear": knob.dear, "values": list(knob.values),
             "saved": knob.saved} for knob in free_knobs(settings, times, found, [floors[name] for name in FREE_BY])
            if knob.setting not in STOPPING]


def _raster(points: Sequence[Point]) -> Document | None:
    """How good a real-time picture gets: plain image-based light, and the best of the raster in ten times its time."""
    plain = [k for k, point in enumerate(points) if point.method == PLAIN]
    if not plain:
        return None
    most = 10 * points[plain[0]].record.facts["time_ms"]["median"]
    drawn = [k for k, point in enumerate(points)
             if not point.method.is_traced and point.record.facts["time_ms"]["median"] <= most]
    result: Document = {"plain": plain[0], "most_ms": most}
    for name in MEASURES[:2]:
        best = min(drawn, key=lambda k: getattr(points[k].errors, name))
        ratio = getattr(points[best].errors, name) / max(getattr(points[plain[0]].errors, name), 1e-30)
        result[name] = {"best": best, "ratio": ratio}
    return result
