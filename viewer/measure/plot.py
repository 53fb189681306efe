"""Small plots as SVG text: lines, polar lobes and heat maps."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence

import numpy as np

_COLORS = ("#0b62a4", "#d1495b", "#2a9d8f", "#e08e0b", "#6a4c93", "#555555", "#8ab17d", "#b56576")
_WIDTH, _HEIGHT = 420, 280
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 12, 28, 40

Series = Mapping[str, tuple[np.ndarray, np.ndarray]]


def lines(title: str, series: Series, x_label: str, y_label: str) -> str:
    """Lines of (x, y) by name, on linear axes from 0."""
    x_max = max(float(x.max()) for x, _ in series.values())
    y_max = _rounded_up(max(float(y.max()) for _, y in series.values()))
    x_ticks, y_ticks = ([f"{k / 4 * largest:g}" for k in range(5)] for largest in (x_max, y_max))
    body = [_frame(x_label, y_label, x_ticks, y_ticks)]
    for k, (x, y) in enumerate(series.values()):
        points = " ".join(f"{_x(a / x_max):.1f},{_y(b / y_max):.1f}" for a, b in zip(x, y) if math.isfinite(b))
        body.append(f'<polyline fill="none" stroke="{_color(k)}" stroke-width="1.5" points="{points}"/>')
    return _svg(title, body + _legend(list(series)))


def polar(title: str, series: Series) -> str:
    """Lobes over a horizontal surface: (angle from the normal, length), each drawn to its own longest length."""
    center, radius = (_WIDTH / 2, _HEIGHT - _BOTTOM), _HEIGHT - _TOP - _BOTTOM
    left = f"M{center[0] - radius} {center[1]}"
    body = [f'<path d="{left}h{2 * radius}" stroke="#999"/>',
            f'<path d="{left}a{radius} {radius} 0 0 1 {2 * radius} 0" fill="none" stroke="#ddd"/>']
    for k, (angle, length) in enumerate(series.values()):
        length = length / max(float(length.max()), 1e-30) * radius
        points = " ".join(f"{center[0] + r * math.sin(a):.1f},{center[1] - r * math.cos(a):.1f}"
                          for a, r in zip(angle, length))
        body.append(f'<polygon fill="none" stroke="{_color(k)}" stroke-width="1.5" points="{points}"/>')
    return _svg(title, body + _legend(list(series)))


def heat_map(title: str, values: np.ndarray, x_label: str, y_label: str, x_ticks: Sequence[str],
             y_ticks: Sequence[str]) -> str:
    """Relative errors (rows: y upwards, columns: x) by their power of ten, white at 1e-8 and dark at 1e-3 and above."""
    rows, columns = values.shape
    wide, high = (_WIDTH - _LEFT - _RIGHT) / columns, (_HEIGHT - _TOP - _BOTTOM) / rows
    power = np.clip((np.log10(np.maximum(values, 1e-8)) + 8) / 5, 0, 1)
    cells = []
    for row in range(rows):
        for column in range(columns):
            shade = power[row, column]
            color = f"#{int(255 - 175 * shade):02x}{int(250 - 230 * shade):02x}{int(245 - 190 * shade):02x}"
            cells.append(f'<rect x="{_LEFT + column * wide:.1f}" y="{_HEIGHT - _BOTTOM - (row + 1) * high:.1f}" '
                         f'width="{wide + 0.3:.1f}" height="{high + 0.3:.1f}" fill="{color}"/>')
    return _svg(f"{title}: at most {values.max():.1e}", [*cells, _frame(x_label, y_label, x_ticks, y_ticks)])


def _svg(title: str, body: Sequence[str]) -> str:
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" '
            f'font-family="system-ui, sans-serif" font-size="11"><text x="{_LEFT}" y="16" font-size="13">'
            f'{html.escape(title)}</text>{"".join(body)}</svg>')


def _frame(x_label: str, y_label: str, x_ticks: Sequence[str], y_ticks: Sequence[str]) -> str:
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    parts = [f'<path d="M{_LEFT} {_TOP}V{bottom}H{right}" fill="none" stroke="#666"/>',
             _text(x_label, "middle", (_LEFT + right) / 2, _HEIGHT - 6),
             f'<g transform="translate(12 {(_TOP + bottom) / 2}) rotate(-90)">{_text(y_label, "middle", 0, 0)}</g>']
    for k, text in enumerate(x_ticks):
        parts.append(_text(text, "middle", _x(k / max(len(x_ticks) - 1, 1)), bottom + 14))
    for k, text in enumerate(y_ticks):
        parts.append(_text(text, "end", _LEFT - 4, _y(k / max(len(y_ticks) - 1, 1)) + 4))
    return "".join(parts)


def _text(text: str, anchor: str, x: float, y: float, color: str = "#222") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}">{html.escape(text)}</text>'


def _legend(names: Sequence[str]) -> list[str]:
    return [_text(name, "end", _WIDTH - _RIGHT, _TOP + 12 + 14 * k, _color(k)) for k, name in enumerate(names)]


def _color(k: int) -> str:
    return _COLORS[k % len(_COLORS)]


def _x(share: float) -> float:
    return _LEFT + share * (_WIDTH - _LEFT - _RIGHT)


def _y(share: float) -> float:
    return _HEIGHT - _BOTTOM - share * (_HEIGHT - _TOP - _BOTTOM)


def _rounded_up(value: float) -> float:
    """The next of 1, 1.2, 1.6, 2, 4, 8 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(max(value, 1e-30)))
    return next(step * power for step in (1, 1.2, 1.6, 2, 4, 8, 10) if step * power >= value * 0.9999)
