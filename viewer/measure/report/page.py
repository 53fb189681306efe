"""index.html: the report as a self-contained page, and the files beside it."""

from __future__ import annotations

import base64
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import atomic_write, write_json
from ...image.magma import magma
from ..drawing import to_svg
from ..drawing_png import save_png
from ..html_page import html_page
from .chart import error_chart
from .document import Findings
from .errors import MEASURES

_HERE = Path(__file__).resolve().parent
_PICTURE = {"format": "WEBP", "quality": 92, "method": 4}
_MOST_WEBP = 16383  # pixels along a side
_MAP = {"format": "WEBP", "quality": 80, "method": 4}


def write_report(folder: Path, findings: Findings) -> None:
    """report.json, error-time.svg and .png, and index.html in `folder`, which is there. Raises OutputError."""
    write_json(folder / "report.json", findings.document)
    charts = {measure: error_chart(findings.document, measure) for measure in MEASURES}
    with atomic_write(folder / "error-time.svg") as file:
        file.write_text(to_svg(charts[MEASURES[0]]), encoding="utf-8")
    save_png(charts[MEASURES[0]], folder / "error-time.png")
    drawings = {measure: to_svg(chart) for measure, chart in charts.items()}
    with atomic_write(folder / "index.html") as file:
        file.write_text(_page(findings, drawings), encoding="utf-8")


def _page(findings: Findings, drawings: dict[str, str]) -> str:
    pictures = {
        "reference": _encoded(findings.reference.srgb, _PICTURE),
        "points": [_encoded(point.image.srgb, _PICTURE) for point in findings.points],
        "maps": [_encoded(magma(point.errors.map), _MAP) for point in findings.points],
    }
    charts = "".join(f'<div class="chart" data-measure="{name}">{svg}</div>' for name, svg in drawings.items())
    body = fill("page.html", {"SCRIPT": resource("page.js"), "CHARTS": charts, "REPORT": embedded(findings.document),
                              "PICTURES": embedded(pictures)})
    return html_page("Error against time", body, resource("page.css"))


def fill(template: str, parts: dict[str, str]) -> str:
    """A template of this folder with each `{{NAME}}` replaced once: the inserted text is not searched again."""
    pieces = resource(template).split("{{")
    text = [pieces[0]]
    for piece in pieces[1:]:
        name, _, rest = piece.partition("}}")
        text += [parts[name], rest]
    return "".join(text)


def resource(name: str) -> str:
    """The text of a file beside this one."""
    return (_HERE / name).read_text(encoding="utf-8")


def embedded(content: Any) -> str:
    """JSON for a script element: it cannot contain the end of the element."""
    return json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _encoded(pixels: np.ndarray, options: dict[str, Any]) -> str:
    """(H, W, 3 or 4) uint8 as a data URL."""
    from PIL import Image as Pillow

    if max(pixels.shape) > _MOST_WEBP:
        options = {"format": "PNG"}
    file = io.BytesIO()
    Pillow.fromarray(pixels).save(file, **options)
    return f"data:image/{options['format'].lower()};base64,{base64.b64encode(file.getvalue()).decode()}"
