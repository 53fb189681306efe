"""The frame of a chart with two logarithmic axes, cost to the right and error upwards, and its Pareto front."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from .drawing import FAINT, INK, Label, Line, Shape

WIDTH, PLOT_BOTTOM = 720, 400
LEFT, RIGHT, TOP = 70, 16, 34
LEGEND_TOP, LEGEND_ROW = PLOT_BOTTOM + 54, 20


class LogAxis:
    """A logarithmic axis from pixel `start` to `end` on which all `values` have room."""

    def __init__(self, values: Sequence[float], start: float, end: float) -> None:
        self.low, self.high = min(values) / 1.4, max(values) * 1.4
        self._start, self._end = start, end

    def __call__(self, value: float) -> float:
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self._start + share * (self._end - self._start)

    def ticks(self) -> list[float]:
        """Powers of ten: some of them where there are many, with other numbers between where there are few."""
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        for every, steps in ((5, (1,)), (2, (1,)), (1, (1,)), (1, (1, 3)), (1, (1, 2, 5)), (1, range(1, 10))):
            powers = [10.0**power for power in range(first, last + 1) if power % every == 0]
            found = [step * power for power in powers for step in steps if self.low <= step * power <= self.high]
            if len(found) >= 4:
                break
        return found


def log_axes(costs: Sequence[float], errors: Sequence[float]) -> tuple[LogAxis, LogAxis]:
    """The axes of a chart in which all these values have room."""
    return LogAxis(costs, LEFT, WIDTH - RIGHT), LogAxis(errors, PLOT_BOTTOM, TOP)


def frame(x: LogAxis, y: LogAxis, title: str, x_name: str, y_name: str,
          spell_x: Callable[[float], str]) -> list[Shape]:
    """Title, grid, ticks and the names of the axes; `spell_x` writes a tick's number."""
    shapes: list[Shape] = [Label(LEFT, 18, title, "start", 14)]
    for tick in x.ticks():
        shapes += [Line(((x(tick), TOP), (x(tick), PLOT_BOTTOM)), FAINT, kind="grid"),
                   Label(x(tick), PLOT_BOTTOM + 16, spell_x(tick))]
    for tick in y.ticks():
        shapes += [Line(((LEFT, y(tick)), (WIDTH - RIGHT, y(tick))), FAINT, kind="grid"),
                   Label(LEFT - 6, y(tick) + 4, f"{tick:g}", "end")]
    corner = ((LEFT, TOP), (LEFT, PLOT_BOTTOM), (WIDTH - RIGHT, PLOT_BOTTOM))
    return [*shapes, Line(corner, INK, kind="axis"),
            Label((LEFT + WIDTH) / 2, PLOT_BOTTOM + 34, x_name),
            Label(14, (TOP + PLOT_BOTTOM) / 2, y_name, is_upright=True)]


def legend_place(k: int, columns: int) -> tuple[float, float]:
    """The left end and the middle height of the legend's k-th entry, row by row in so many columns."""
    return LEFT + k % columns * (WIDTH - LEFT - RIGHT) / columns, LEGEND_TOP + k // columns * LEGEND_ROW


def height_with_legend(entries: int, columns: int) -> float:
    """Of the whole drawing."""
    return LEGEND_TOP - 2 + -(-entries // columns) * LEGEND_ROW


def off_zero(errors: Sequence[float]) -> list[float]:
    """An error of 0 has no place on a logarithmic axis: it is drawn at a tenth of the smallest that is not 0."""
    least = min((error for error in errors if error > 0), default=1.0) / 10
    return [max(error, least) for error in errors]


def front_line(corners: Sequence[tuple[float, float]]) -> Line:
    """The Pareto front as a staircase through its points, which are in order of cost."""
    steps: list[tuple[float, float]] = []
    for k, (x, y) in enumerate(corners):
        steps += [(x, corners[k - 1][1] if k else y), (x, y)]
    steps.append((WIDTH - RIGHT, corners[-1][1]))
    return Line(tuple(steps), INK, 1.5, kind="front")
