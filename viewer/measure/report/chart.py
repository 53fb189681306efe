"""Error against time as a chart: laid out once, written as SVG and as PNG."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .pareto import BUDGETS_MS

WIDTH, PLOT_BOTTOM = 720, 400
LEFT, RIGHT, TOP = 70, 16, 34
LEGEND_COLUMNS, LEGEND_ROW = 3, 20
INK, FAINT, _PAPER = "#222222", "#d8d8d8", "#ffffff"
# Okabe & Ito 2008, colours that most eyes tell apart; the shape tells them apart as well.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f5fc0", "#777777")
SHAPES = ("circle", "square", "diamond", "triangle")
_NAMES = {"relmse_trimmed": "trimmed relMSE", "relmse": "relMSE", "rmse": "RMSE", "flip": "FLIP"}
_AXES = _NAMES | {"relmse_trimmed": "trimmed relMSE (its root: off by)", "relmse": "relMSE (its root: off by)"}


@dataclass(frozen=True)
class Line:
    """Through `points`, in pixels from the upper left; `kind` is its class in the SVG, `dash` 0 for a whole one."""

    points: tuple[tuple[float, float], ...]
    color: str
    width: float = 1.0
    dash: float = 0.0
    kind: str = ""


@dataclass(frozen=True)
class Mark:
    """Of a point, filled where it is on the Pareto front."""

    x: float
    y: float
    color: str
    shape: str
    is_on_front: bool = True
    point: int | None = None
    """The number of the report's point, None in the legend."""
    title: str = ""

    def outline(self) -> list[tuple[float, float]]:
        """The corners of its shape."""
        r = 5.5 if self.is_on_front else 4.0
        steps, turn = {"circle": (24, 0.0), "square": (4, 0.25), "diamond": (4, 0.0), "triangle": (3, 0.0)}[self.shape]
        return [(self.x + r * math.sin(2 * math.pi * (k + turn * 2) / steps),
                 self.y - r * math.cos(2 * math.pi * (k + turn * 2) / steps)) for k in range(steps)]


@dataclass(frozen=True)
class Words:
    """Text whose baseline begins, has its middle or ends at (x, y), as `anchor` says."""

    x: float
    y: float
    text: str
    anchor: str = "middle"
    size: float = 12
    kind: str = "ink"
    is_upright: bool = False
    """Written from bottom to top."""


Shape = Line | Mark | Words


@dataclass(frozen=True)
class Chart:
    """What is drawn, the last in front."""

    width: float
    height: float
    shapes: tuple[Shape, ...]


def error_chart(document: Mapping[str, Any], measure: str) -> Chart:
    """The points of report.json by their time, with its spread, and one of their errors, on logarithmic axes."""
    points = document["points"]
    times = [point["time_ms"]["median"] for point in points]
    floor = document["reference"]["floor"][measure]
    values = off_zero([point["error"][measure] for point in points])
    spreads = [(point["time_ms"]["p10"], point["time_ms"]["p90"]) for point in points]
    x = LogAxis([time for spread in spreads for time in spread], LEFT, WIDTH - RIGHT)
    y = LogAxis([*values, *[floor] * (floor > 0)], PLOT_BOTTOM, TOP)
    title = "{} against time, {} x {}".format(_NAMES[measure], *document["size"])
    shapes: list[Shape] = [Words(LEFT, 18, title, "start", 14)]
    shapes += _frame(x, y, measure)
    if y.low < floor:
        shapes += [Line(((LEFT, y(floor)), (WIDTH - RIGHT, y(floor))), INK, 1, 3, "floor"),
                   Words(LEFT + 6, y(floor) - 4, "noise of the reference", "start", 11, "soft")]
    on_front = [k for k, point in enumerate(points) if point["pareto_by"][measure]]
    shapes.append(stairs([(x(times[k]), y(values[k])) for k in on_front]))
    styles = _styles(points)
    for k in sorted(range(len(points)), key=on_front.__contains__):
        color, shape = styles[points[k]["title"]]
        error = points[k]["error"][measure]
        title = f"{points[k]['label']}: {spell_time(times[k])}, {_NAMES[measure]} {error:.3g}"
        shapes.append(Line(tuple((x(time), y(values[k])) for time in spreads[k]), color, 1, 0, "spread"))
        shapes.append(Mark(x(times[k]), y(values[k]), color, shape, k in on_front, k, title))
    rows = _legend(styles, shapes)
    return Chart(WIDTH, PLOT_BOTTOM + 52 + rows * LEGEND_ROW, tuple(shapes))


def off_zero(errors: Sequence[float]) -> list[float]:
    """No error at all has no place on a logarithmic axis: it is drawn at a tenth of the least there is."""
    least = min((error for error in errors if error > 0), default=1.0) / 10
    return [max(error, least) for error in errors]


def spell_time(milliseconds: float) -> str:
    """Three digits in the unit that suits."""
    return f"{milliseconds:.3g} ms" if milliseconds < 999.5 else f"{milliseconds / 1e3:.3g} s"


class LogAxis:
    """A logarithmic axis from pixel `start` to `end` on which all `values` have room."""

    def __init__(self, values: Sequence[float], start: float, end: float) -> None:
        self.low, self.high = min(values) / 1.4, max(values) * 1.4
        self._start, self._end = start, end

    def __call__(self, value: float) -> float:
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self._start + share * (self._end - self._start)

    def ticks(self) -> list[float]:
        """Powers of ten, some of them where there are many, with other numbers between where there are few."""
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        for every, steps in ((5, (1,)), (2, (1,)), (1, (1,)), (1, (1, 3)), (1, (1, 2, 5)), (1, range(1, 10))):
            powers = [10.0**power for power in range(first, last + 1) if power % every == 0]
            found = [step * power for power in powers for step in steps if self.low <= step * power <= self.high]
            if len(found) >= 4:
                break
        return found


def _frame(x: LogAxis, y: LogAxis, measure: str) -> list[Shape]:
    shapes: list[Shape] = []
    for tick in x.ticks():
        shapes += [Line(((x(tick), TOP), (x(tick), PLOT_BOTTOM)), FAINT, 1, 0, "grid"),
                   Words(x(tick), PLOT_BOTTOM + 16, spell_time(tick))]
    for tick in y.ticks():
        shapes += [Line(((LEFT, y(tick)), (WIDTH - RIGHT, y(tick))), FAINT, 1, 0, "grid"),
                   Words(LEFT - 6, y(tick) + 4, f"{tick:g}", "end")]
        if measure.startswith("relmse"):
            shapes.append(Words(LEFT - 6, y(tick) + 16, f"{float(f'{100 * tick**0.5:.2g}'):g} %", "end", 10, "soft"))
    for budget in BUDGETS_MS:
        if x.low < budget < x.high:
            name = "30 a second" if budget < 100 else spell_time(budget)
            shapes += [Line(((x(budget), TOP), (x(budget), PLOT_BOTTOM)), INK, 1, 2, "budget"),
                       Words(x(budget) - 4, TOP + 4, name, "end", 11, "soft", True)]
    corner = ((LEFT, TOP), (LEFT, PLOT_BOTTOM), (WIDTH - RIGHT, PLOT_BOTTOM))
    return [*shapes, Line(corner, INK, 1, 0, "axis"),
            Words((LEFT + WIDTH) / 2, PLOT_BOTTOM + 34, "time of a picture"),
            Words(14, (TOP + PLOT_BOTTOM) / 2, _AXES[measure], "middle", 12, "ink", True)]


def stairs(corners: Sequence[tuple[float, float]]) -> Line:
    """What can be had: down where a point of the front stands, level until the next."""
    steps: list[tuple[float, float]] = []
    for k, (x, y) in enumerate(corners):
        steps += [(x, corners[k - 1][1] if k else y), (x, y)]
    steps.append((WIDTH - RIGHT, corners[-1][1]))
    return Line(tuple(steps), INK, 1.5, 0, "front")


def _styles(points: Sequence[Mapping[str, Any]]) -> dict[str, tuple[str, str]]:
    """Colour and shape of each title, in the order of first sight."""
    titles = dict.fromkeys(point["title"] for point in points)
    return {title: (COLORS[k % len(COLORS)], SHAPES[(k + k // len(COLORS)) % len(SHAPES)])
            for k, title in enumerate(titles)}


def _legend(styles: Mapping[str, tuple[str, str]], shapes: list[Shape]) -> int:
    """Adds the legend to `shapes`; how many rows it has."""
    for k, (title, (color, shape)) in enumerate(styles.items()):
        column, row = k % LEGEND_COLUMNS, k // LEGEND_COLUMNS
        left = LEFT + column * (WIDTH - LEFT - RIGHT) / LEGEND_COLUMNS
        top = PLOT_BOTTOM + 54 + row * LEGEND_ROW
        shapes += [Mark(left + 6, top, color, shape), Words(left + 18, top + 4, title, "start")]
    return -(-len(styles) // LEGEND_COLUMNS)


def to_svg(chart: Chart) -> str:
    """A picture that stands alone; the marks of points have `data-point`, and classes tell what a line is."""
    box = f"0 0 {chart.width:g} {chart.height:g}"
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" font-family="system-ui, sans-serif">',
             f'<rect class="paper" width="100%" height="100%" fill="{_PAPER}"/>']
    parts += [_SVG[type(shape)](shape) for shape in chart.shapes]
    return "".join([*parts, "</svg>"])


def _line_svg(line: Line) -> str:
    dash = f' stroke-dasharray="{line.dash:g}"' if line.dash else ""
    return (f'<polyline class="{line.kind}" points="{_listed(line.points)}" fill="none" stroke="{line.color}" '
            f'stroke-width="{line.width:g}"{dash}/>')


def _mark_svg(mark: Mark) -> str:
    shape = (f'<polygon points="{_listed(mark.outline())}" fill="{mark.color if mark.is_on_front else _PAPER}" '
             f'stroke="{mark.color}" stroke-width="1.5" class="{"full" if mark.is_on_front else "hollow"}"/>')
    if mark.point is None:
        return shape
    return (f'<g class="point" data-point="{mark.point}"><title>{html.escape(mark.title)}</title>'
            f'<circle cx="{mark.x:.1f}" cy="{mark.y:.1f}" r="11" fill="none" pointer-events="all"/>{shape}</g>')


def _words_svg(words: Words) -> str:
    turn = f' transform="rotate(-90 {words.x:.1f} {words.y:.1f})"' if words.is_upright else ""
    fill = INK if words.kind == "ink" else "#666666"
    return (f'<text class="{words.kind}" x="{words.x:.1f}" y="{words.y:.1f}" text-anchor="{words.anchor}" '
            f'font-size="{words.size:g}" fill="{fill}"{turn}>{html.escape(words.text)}</text>')


_SVG: dict[type, Callable[[Any], str]] = {Line: _line_svg, Mark: _mark_svg, Words: _words_svg}


def _listed(points: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
