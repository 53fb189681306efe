"""Small plots: lines, polar lobes and heat maps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from .drawing import COLORS, FAINT, INK, SOFT, Area, Drawing, Label, Line, Shape

_WIDTH, _HEIGHT = 420, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 20, 48, 40
_TEXT = 11

Series = Mapping[str, tuple[np.ndarray, np.ndarray]]


def lines(title: str, series: Series, x_label: str, y_label: str) -> Drawing:
    """Lines of (x, y) by name, on linear axes from 0."""
    x_max = max(float(x.max()) for x, _ in series.values())
    y_max = _rounded_up(max(float(y.max()) for _, y in series.values()))
    x_ticks, y_ticks = ([f"{k / 4 * largest:g}" for k in range(5)] for largest in (x_max, y_max))
    drawn = [Line(tuple((_x(a / x_max), _y(b / y_max)) for a, b in zip(x, y)), _color(k), 1.5)
             for k, (x, y) in enumerate(series.values())]
    return _plot(title, [*_frame(x_label, y_label, x_ticks, y_ticks), *drawn, *_legend(series)])


def polar(title: str, series: Series) -> Drawing:
    """Lobes over a horizontal surface: (angle from the normal, length), each drawn to its own longest length."""
    x, y, radius = _WIDTH / 2, _HEIGHT - _BOTTOM, min(_HEIGHT - _TOP - _BOTTOM, _WIDTH / 2 - _RIGHT)
    half = np.linspace(-np.pi / 2, np.pi / 2, 61)
    shapes: list[Shape] = [Line(((x - radius, y), (x + radius, y)), SOFT),
                           Line(_around(x, y, half, np.full(61, radius)), FAINT)]
    for k, (angle, length) in enumerate(series.values()):
        outline = _around(x, y, angle, length / max(float(length.max()), 1e-30) * radius)
        shapes.append(Line((*outline, outline[0]), _color(k), 1.5))
    return _plot(title, [*shapes, *_legend(series)])


def heat_map(title: str, values: np.ndarray, x_label: str, y_label: str, x_ticks: Sequence[str],
             y_ticks: Sequence[str]) -> Drawing:
    """Relative errors (rows: y upwards, columns: x) by their power of ten, white at 1e-8 and dark at 1e-3 and above."""
    rows, columns = values.shape
    power = np.clip((np.log10(np.maximum(values, 1e-8)) + 8) / 5, 0, 1)
    shapes: list[Shape] = []
    for (row, column), shade in np.ndenumerate(power):
        color = f"#{int(255 - 175 * shade):02x}{int(250 - 230 * shade):02x}{int(245 - 190 * shade):02x}"
        left, right = _x(column / columns), _x((column + 1) / columns) + 0.3
        bottom, top = _y(row / rows), _y((row + 1) / rows) - 0.3
        shapes.append(Area(((left, bottom), (right, bottom), (right, top), (left, top)), color))
    return _plot(f"{title}: at most {values.max():.1e}", [*shapes, *_frame(x_label, y_label, x_ticks, y_ticks)])


def _plot(title: str, shapes: Sequence[Shape]) -> Drawing:
    return Drawing(_WIDTH, _HEIGHT, (Label(_LEFT, 16, title, "start", 13), *shapes))


def _frame(x_label: str, y_label: str, x_ticks: Sequence[str], y_ticks: Sequence[str]) -> list[Shape]:
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    shapes: list[Shape] = [Line(((_LEFT, _TOP), (_LEFT, bottom), (right, bottom)), INK, kind="axis"),
                           Label((_LEFT + right) / 2, _HEIGHT - 6, x_label, size=_TEXT),
                           Label(12, (_TOP + bottom) / 2, y_label, size=_TEXT, is_upright=True)]
    for k, text in enumerate(x_ticks):
        shapes.append(Label(_x(k / max(len(x_ticks) - 1, 1)), bottom + 14, text, size=_TEXT))
    for k, text in enumerate(y_ticks):
        shapes.append(Label(_LEFT - 4, _y(k / max(len(y_ticks) - 1, 1)) + 4, text, "end", _TEXT))
    return shapes


def _legend(series: Series) -> list[Shape]:
    """The names in a line between title and plot, where no curve comes."""
    step = (_WIDTH - _LEFT - _RIGHT) / max(len(series), 1)
    return [Label(_LEFT + k * step, _TOP - 14, name, "start", _TEXT, _color(k)) for k, name in enumerate(series)]


def _around(x: float, y: float, angle: np.ndarray, length: np.ndarray) -> tuple[tuple[float, float], ...]:
    """The points at these angles from the vertical and distances from (x, y)."""
    return tuple((x + r * math.sin(a), y - r * math.cos(a)) for a, r in zip(angle, length))


def _color(k: int) -> str:
    return COLORS[k % len(COLORS)]


def _x(share: float) -> float:
    return _LEFT + share * (_WIDTH - _LEFT - _RIGHT)


def _y(share: float) -> float:
    return _HEIGHT - _BOTTOM - share * (_HEIGHT - _TOP - _BOTTOM)


def _rounded_up(value: float) -> float:
    """The next of 1, 1.2, 1.6, 2, 4, 8 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(max(value, 1e-30)))
    return next(step * power for step in (1, 1.2, 1.6, 2, 4, 8, 10) if step * power >= value * 0.9999)
