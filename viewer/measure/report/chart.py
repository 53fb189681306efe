"""The report's charts: error against time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..drawing import INK, SOFT, Drawing, Label, Line, Mark, Shape, style
from ..log_axes import (
    LEFT,
    PLOT_BOTTOM,
    RIGHT,
    TOP,
    WIDTH,
    LogAxis,
    frame,
    front_line,
    height_with_legend,
    legend_place,
    log_axes,
    off_zero,
)
from .pareto import BUDGETS_MS

_LEGEND_COLUMNS = 3
_NAMES = {"relmse_trimmed": "trimmed relMSE", "relmse": "relMSE", "rmse": "RMSE", "flip": "FLIP"}
_AXES = _NAMES | {"relmse_trimmed": "trimmed relMSE (its root: relative error)",
                  "relmse": "relMSE (its root: relative error)"}


def error_chart(document: Mapping[str, Any], measure: str) -> Drawing:
    """The points of report.json by their time, with its spread, and one of their errors, on logarithmic axes.

    Marks of points on the Pareto front are filled.
    """
    points = document["points"]
    times = [point["time_ms"]["median"] for point in points]
    floor = document["reference"]["floor"][measure]
    values = off_zero([point["error"][measure] for point in points])
    spreads = [(point["time_ms"]["p10"], point["time_ms"]["p90"]) for point in points]
    x, y = log_axes([time for spread in spreads for time in spread], [*values, *[floor] * (floor > 0)])
    title = "{} against time, {} x {}".format(_NAMES[measure], *document["size"])
    shapes = frame(x, y, title, "time of a picture", _AXES[measure], spell_time)
    shapes += _relative_errors(y) if measure.startswith("relmse") else []
    shapes += _budgets(x)
    if y.low < floor:
        shapes += [Line(((LEFT, y(floor)), (WIDTH - RIGHT, y(floor))), INK, 1, 3, "floor"),
                   Label(LEFT + 6, y(floor) - 4, "noise of the reference", "start", 11, SOFT)]
    on_front = [k for k, point in enumerate(points) if point["pareto_by"][measure]]
    shapes.append(front_line([(x(times[k]), y(values[k])) for k in on_front]))
    titles = dict.fromkeys(point["title"] for point in points)
    styles = {title: style(k) for k, title in enumerate(titles)}
    for k in sorted(range(len(points)), key=on_front.__contains__):
        color, shape = styles[points[k]["title"]]
        error = points[k]["error"][measure]
        title = f"{points[k]['label']}: {spell_time(times[k])}, {_NAMES[measure]} {error:.3g}"
        shapes.append(Line(tuple((x(time), y(values[k])) for time in spreads[k]), color, kind="spread"))
        shapes.append(Mark(x(times[k]), y(values[k]), color, shape, k in on_front, k, title))
    shapes += _legend(styles)
    return Drawing(WIDTH, height_with_legend(len(styles), _LEGEND_COLUMNS), tuple(shapes))


def spell_time(milliseconds: float) -> str:
    """Three digits in the unit that suits."""
    return f"{milliseconds:.3g} ms" if milliseconds < 999.5 else f"{milliseconds / 1e3:.3g} s"


def _relative_errors(y: LogAxis) -> list[Shape]:
    """Under the ticks of a relMSE its root."""
    return [Label(LEFT - 6, y(tick) + 16, f"{float(f'{100 * tick**0.5:.2g}'):g} %", "end", 10, SOFT)
            for tick in y.ticks()]


def _budgets(x: LogAxis) -> list[Shape]:
    """A line at each time for which a method is recommended."""
    shapes: list[Shape] = []
    for budget in BUDGETS_MS:
        if x.low < budget < x.high:
            name = "30 a second" if budget < 100 else spell_time(budget)
            shapes += [Line(((x(budget), TOP), (x(budget), PLOT_BOTTOM)), INK, 1, 2, "budget"),
                       Label(x(budget) - 4, TOP + 4, name, "end", 11, SOFT, is_upright=True)]
    return shapes


def _legend(styles: Mapping[str, tuple[str, str]]) -> Sequence[Shape]:
    shapes: list[Shape] = []
    for k, (title, (color, shape)) in enumerate(styles.items()):
        left, middle = legend_place(k, _LEGEND_COLUMNS)
        shapes += [Mark(left + 6, middle, color, shape), Label(left + 18, middle + 4, title, "start")]
    return shapes
