"""A piece's ways by cost and error, as a chart."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from viewer.measure.report import pareto
from viewer.measure.report.chart import (
    COLORS,
    FAINT,
    INK,
    LEFT,
    LEGEND_ROW,
    PLOT_BOTTOM,
    RIGHT,
    SHAPES,
    TOP,
    WIDTH,
    Chart,
    Line,
    LogAxis,
    Mark,
    Shape,
    Words,
    off_zero,
    stairs,
)

_LEAST_NS = 0.05
"""What costs less is drawn here: no difference of two times tells more."""
_LEGEND_COLUMNS = 2


def cost_chart(piece: Mapping[str, Any]) -> Chart:
    """RMS error by nanoseconds, both on logarithmic axes; the stairs are what can be had.

    Full marks are on the front, which heeds size as well; a ring is about the default."""
    rows = piece["variants"]
    costs = [max(row["cost_ns"]["median"], _LEAST_NS) for row in rows]
    errors = off_zero([row["error"]["rms"] for row in rows])
    x, y = LogAxis(costs, LEFT, WIDTH - RIGHT), LogAxis(errors, PLOT_BOTTOM, TOP)
    shapes: list[Shape] = [Words(LEFT, 18, piece["title"], "start", 14)]
    for tick in x.ticks():
        shapes += [Line(((x(tick), TOP), (x(tick), PLOT_BOTTOM)), FAINT, 1, 0, "grid"),
                   Words(x(tick), PLOT_BOTTOM + 16, f"{tick:g} ns")]
    for tick in y.ticks():
        shapes += [Line(((LEFT, y(tick)), (WIDTH - RIGHT, y(tick))), FAINT, 1, 0, "grid"),
                   Words(LEFT - 6, y(tick) + 4, f"{tick:g}", "end")]
    shapes += [Line(((LEFT, TOP), (LEFT, PLOT_BOTTOM), (WIDTH - RIGHT, PLOT_BOTTOM)), INK, 1, 0, "axis"),
               Words((LEFT + WIDTH) / 2, PLOT_BOTTOM + 34, f"time of one {piece['per']}"),
               Words(14, (TOP + PLOT_BOTTOM) / 2, f"RMS error ({piece['unit']})", "middle", 12, "ink", True)]
    best = sorted(point for point, is_on in zip(zip(costs, errors), pareto.front(costs, errors)) if is_on)
    shapes.append(stairs([(x(cost), y(error)) for cost, error in best]))
    for k, row in enumerate(rows):
        color, shape = _style(k)
        left = LEFT + k % _LEGEND_COLUMNS * (WIDTH - LEFT - RIGHT) / _LEGEND_COLUMNS
        top = PLOT_BOTTOM + 54 + k // _LEGEND_COLUMNS * LEGEND_ROW
        title = f"{row['name']}: {row['cost_ns']['median']:.3g} ns, RMS {row['error']['rms']:.3g}"
        for across, down, point in ((x(costs[k]), y(errors[k]), k), (left + 8, top, None)):
            if row["is_default"]:
                shapes.append(_ring(across, down))
            shapes.append(Mark(across, down, color, shape, row["pareto"], point, title))
        words = f"{row['name']} (the renderer's)" if row["is_default"] else row["name"]
        shapes.append(Words(left + 22, top + 4, words, "start"))
    legend_rows = -(-len(rows) // _LEGEND_COLUMNS)
    return Chart(WIDTH, PLOT_BOTTOM + 52 + legend_rows * LEGEND_ROW, tuple(shapes))


def _style(k: int) -> tuple[str, str]:
    """Colour and shape of the k-th way; the first 32 differ."""
    return COLORS[k % len(COLORS)], SHAPES[(k + k // len(COLORS)) % len(SHAPES)]


def _ring(x: float, y: float) -> Line:
    circle = Mark(0, 0, INK, "circle").outline()
    return Line(tuple((x + 1.8 * a, y + 1.8 * b) for a, b in [*circle, circle[0]]), INK, 1.5, 0, "front")
