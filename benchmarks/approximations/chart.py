"""A piece's alternatives by cost and error, as a chart."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from viewer.measure.drawing import INK, Drawing, Label, Line, Mark, Shape, style
from viewer.measure.log_axes import WIDTH, frame, front_line, height_with_legend, legend_place, log_axes, off_zero
from viewer.measure.report import pareto

_LEAST_NS = 0.05
"""What costs less is drawn here: the difference of two times is no more exact."""
_LEGEND_COLUMNS = 2


def cost_chart(piece: Mapping[str, Any]) -> Drawing:
    """RMS error by nanoseconds, both on logarithmic axes; the staircase is the Pareto front of these two.

    Filled marks are on the front of cost, error and size; a ring is about the renderer's own way."""
    rows = piece["variants"]
    costs = [max(row["cost_ns"]["median"], _LEAST_NS) for row in rows]
    errors = off_zero([row["error"]["rms"] for row in rows])
    x, y = log_axes(costs, errors)
    shapes = frame(x, y, piece["title"], f"time of one {piece['per']}", f"RMS error ({piece['unit']})",
                   lambda tick: f"{tick:g} ns")
    best = sorted(point for point, is_on in zip(zip(costs, errors), pareto.front(costs, errors)) if is_on)
    shapes.append(front_line([(x(cost), y(error)) for cost, error in best]))
    for k, row in enumerate(rows):
        color, shape = style(k)
        left, middle = legend_place(k, _LEGEND_COLUMNS)
        title = f"{row['name']}: {row['cost_ns']['median']:.3g} ns, RMS {row['error']['rms']:.3g}"
        for across, down, point in ((x(costs[k]), y(errors[k]), k), (left + 8, middle, None)):
            if row["is_default"]:
                shapes.append(_ring(across, down))
            shapes.append(Mark(across, down, color, shape, row["pareto"], point, title))
        name = f"{row['name']} (the renderer's)" if row["is_default"] else row["name"]
        shapes.append(Label(left + 22, middle + 4, name, "start"))
    return Drawing(WIDTH, height_with_legend(len(rows), _LEGEND_COLUMNS), tuple(shapes))


def _ring(x: float, y: float) -> Shape:
    circle = Mark(0, 0, INK, "circle").outline()
    return Line(tuple((x + 1.8 * a, y + 1.8 * b) for a, b in [*circle, circle[0]]), INK, 1.5, kind="front")
