"""A report as it could have been measured: what its page shows does not depend on how busy this machine is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from viewer.image.image import Image
from viewer.measure.report.document import Document, Findings, _recommend
from viewer.measure.report.errors import MEASURES
from viewer.measure.report.pareto import front

SIZE = 24
TIMES_MS = (10.0, 20.0, 160.0, 640.0, 2560.0)
ERRORS = (0.5, 0.6, 0.2, 0.05, 0.01)
"""The second point costs time and gains nothing; in no picture of the chart do two points lie on one another."""


def stored_findings() -> Findings:
    by_measure = {name: [error / (k + 1) for error in ERRORS] for k, name in enumerate(MEASURES)}
    fronts = {name: front(TIMES_MS, values) for name, values in by_measure.items()}
    labels = ("lights only", "lights only, MSAA 4", "image-based light", "path traced, 4 spp", "path traced, 16 spp")
    points = [_point(k, label, by_measure, fronts) for k, label in enumerate(labels)]
    document: Document = {
        "scene": "spheres.glb", "device": "a device", "is_software": True, "size": [SIZE, SIZE],
        "reference": {"method": "path traced", "spp": 1024, "relmse_floor": 1e-4,
                      "floor": dict.fromkeys(MEASURES, 1e-4), "seconds": 9.0},
        "points": points, "recommend": _recommend(TIMES_MS, by_measure), "knobs": [],
        "qualities": {"draft": 2, "standard": None, "high": None},
        "raster": {"plain": 2, "most_ms": 1600.0, **{name: {"best": 2, "ratio": 1.0} for name in MEASURES[:2]}},
        "left_out": [{"method": "traced refraction", "reason": "it changes nothing in this scene"}], "is_whole": True,
        "model_pixels": 339, "opengl": "3.3", "backend": "egl", "version": "0.1.0", "measured_s": 20.0,
        "triangles": 15360, "lights": 0, "environment": "furnace",
    }
    ramp = np.broadcast_to(np.linspace(0, 200, SIZE, dtype=np.uint8)[:, None], (SIZE, SIZE, 3))
    pictures = [SimpleNamespace(image=Image.from_srgb(ramp // (k + 1)),
                                errors=SimpleNamespace(map=np.full((SIZE, SIZE), error)))
                for k, error in enumerate(ERRORS)]
    return Findings(document, Image.from_srgb(255 - ramp), pictures)


def _point(k: int, label: str, by_measure: dict[str, list[float]], fronts: dict[str, list[bool]]) -> Document:
    method, *_ = label.split(",")
    return {
        "method": method.replace(" ", "-"), "title": method, "label": label,
        "settings": {"mode": "path" if "path" in label else "pbr"},
        "time_ms": {"median": TIMES_MS[k], "p10": 0.9 * TIMES_MS[k], "p90": 1.1 * TIMES_MS[k], "n": 7},
        "error": {name: values[k] for name, values in by_measure.items()},
        "pareto": fronts[MEASURES[0]][k], "pareto_by": {name: fronts[name][k] for name in MEASURES},
        "quality": "draft" if k == 2 else None,
        "command": f"pbr-viewer render spheres.glb -o picture-{k}.png", "too_bright": 0.0, "bad_pixels": 0,
        "ready_s": 1.0 + k, "prepare_s": 1.0,
    }
