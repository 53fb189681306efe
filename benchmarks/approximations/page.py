"""approximations.html: the tables and charts on a self-contained page, and the files beside it."""

from __future__ import annotations

import html
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from viewer.base.atomic import atomic_write, make_folder, write_json
from viewer.measure.drawing import to_svg
from viewer.measure.drawing_png import save_png
from viewer.measure.html_page import html_page

from .chart import cost_chart
from .table import HEADINGS, cells, conclusion

_BODY = """<header><h1>The renderer's approximations and their alternatives</h1>
<p id="summary">{device}, {backend}; {clock}, the median; pbr-viewer {version}</p></header>
<main>
<p>For each piece of the renderer this page compares the alternatives: the error over the range of the parameters, and
the time of one evaluation, without that of an empty loop. The highlighted row is what the renderer does. Rows in bold
are on the Pareto front: no other row is as fast, as exact and as small. "Bake" is processor time spent beforehand.</p>
<ul>{contents}</ul>
{sections}
</main>"""
_STYLE = """
.chart { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: .5rem; margin: .8rem 0;
  overflow-x: auto; max-width: 61rem } .chart svg { display: block; width: 100%; min-width: 34rem }
td:nth-child(n+4), th:nth-child(n+4) { text-align: right; white-space: nowrap }
tr.front td:nth-child(2) { font-weight: 600 } tr.default { background: var(--mark) }
"""


def write_approximations(folder: Path, document: Mapping[str, Any]) -> None:
    """Write approximations.json and .html into `folder`, made if it is missing, and each chart as SVG and PNG.

    Raises OutputError.
    """
    charts_folder = folder / "approximations"
    make_folder(folder)
    make_folder(charts_folder)
    write_json(folder / "approximations.json", document)
    sections = []
    for piece in document["pieces"]:
        chart = cost_chart(piece)
        drawing = to_svg(chart)
        with atomic_write(charts_folder / f"{piece['name']}.svg") as file:
            file.write_text(drawing, encoding="utf-8")
        save_png(chart, charts_folder / f"{piece['name']}.png")
        sections.append(_section(piece, drawing))
    contents = "".join(f'<li><a href="#{piece["name"]}">{html.escape(piece["title"])}</a></li>'
                       for piece in document["pieces"])
    facts = {name: html.escape(str(document[name])) for name in ("device", "backend", "clock", "version")}
    body = _BODY.format(contents=contents, sections="\n".join(sections), **facts)
    with atomic_write(folder / "approximations.html") as file:
        file.write_text(html_page("Approximations", body, _STYLE), encoding="utf-8")


def _section(piece: Mapping[str, Any], drawing: str) -> str:
    heads = "".join(f"<th>{html.escape(name)}</th>" for name in (*HEADINGS[:2], "after", *HEADINGS[2:]))
    rows = "\n".join(_row(row) for row in piece["variants"])
    where = f"{piece['over']}; errors in {piece['unit']}, against {piece['truth']}; times of one {piece['per']}"
    return (f'<section id="{piece["name"]}"><h2>{html.escape(piece["title"])}</h2>\n'
            f'<p class="soft">{html.escape(where)}.</p>\n<div class="chart">{drawing}</div>\n'
            f'<div class="wide"><table><thead><tr>{heads}</tr></thead><tbody>\n'
            f"{rows}\n</tbody></table></div>\n<p>{html.escape(conclusion(piece))}</p></section>")


def _row(row: Mapping[str, Any]) -> str:
    mark, name, *numbers = cells(row)
    kinds = " ".join(kind for kind, is_it in (("default", row["is_default"]), ("front", row["pareto"])) if is_it)
    columns = (mark, name, row["source"], *numbers)
    return f'<tr class="{kinds}">' + "".join(f"<td>{html.escape(column)}</td>" for column in columns) + "</tr>"
