"""The reports of several models on one page."""

from __future__ import annotations

import html
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ...base.atomic import atomic_write
from ..html_page import html_page
from .chart import spell_time
from .errors import MEASURES
from .page import fill

_STYLE = "body { max-width: 90rem } td { min-width: 5rem }"


def write_summary(folder: Path, reports: Mapping[Path, Mapping[str, Any]]) -> None:
    """index.html in `folder`: a row for each report.json, by the folder in it that holds it. Raises OutputError."""
    rows = "\n".join(_row(quote(path.name), report) for path, report in reports.items())
    sizes = sorted({f"{report['size'][0]} x {report['size'][1]} on {report['device']}" for report in reports.values()})
    body = fill("summary.html", {"ROWS": rows, "WHERE": html.escape("; ".join(sizes))})
    with atomic_write(folder / "index.html") as file:
        file.write_text(html_page("Error against time", body, _STYLE), encoding="utf-8")


def _row(link: str, report: Mapping[str, Any]) -> str:
    cells = [f'<a href="{link}/index.html">{html.escape(report["scene"])}</a>', str(report["triangles"]),
             _percent(report["reference"]["floor"][MEASURES[0]])]
    for row in report["recommend"]:
        cells.append("no method is fast enough" if row["point"] is None else _choice(report["points"][row["point"]]))
    raster = report["raster"]
    if raster is None:
        cells.append("")
    else:
        best = raster[MEASURES[0]]
        cells.append(f"{best['ratio']:.2f}<br><small>{html.escape(report['points'][best['best']]['label'])}</small>")
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _choice(point: Mapping[str, Any]) -> str:
    return (f"{html.escape(point['label'])}<br><small>{spell_time(point['time_ms']['median'])}, relative error "
            f"{_percent(point['error'][MEASURES[0]])}</small>")


def _percent(relmse: float) -> str:
    """The typical relative error of a pixel: the root of relMSE."""
    return f"{float(f'{100 * relmse**0.5:.2g}'):g} %"
