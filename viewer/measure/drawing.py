"""Drawings of lines, areas, marks and text: laid out once, written as SVG here and as PNG by drawing_png.py."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

INK, SOFT, FAINT, PAPER = "#222222", "#666666", "#d8d8d8", "#ffffff"
# Okabe & Ito 2008: colours that most eyes tell apart; the shape of a mark tells them apart as well.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f5fc0", "#777777")
SHAPES = ("circle", "square", "diamond", "triangle")

Points = tuple[tuple[float, float], ...]


def style(k: int) -> tuple[str, str]:
    """Colour and shape of the k-th kind of mark; the first 32 differ."""
    return COLORS[k % len(COLORS)], SHAPES[(k + k // len(COLORS)) % len(SHAPES)]


@dataclass(frozen=True)
class Line:
    """Through `points`, in pixels from the upper left; `kind` is its class in the SVG. `dash` is the length of dashes,
    0 for a solid line."""

    points: Points
    color: str = INK
    width: float = 1.0
    dash: float = 0.0
    kind: str = ""


@dataclass(frozen=True)
class Area:
    """A filled polygon with these corners."""

    corners: Points
    color: str


@dataclass(frozen=True)
class Mark:
    """Of a data point, filled or an outline."""

    x: float
    y: float
    color: str
    shape: str
    is_filled: bool = True
    point: int | None = None
    """The number of the data point, None in a legend."""
    title: str = ""

    def outline(self) -> list[tuple[float, float]]:
        """The corners of its shape."""
        r = 5.5 if self.is_filled else 4.0
        steps, turn = {"circle": (24, 0.0), "square": (4, 0.25), "diamond": (4, 0.0), "triangle": (3, 0.0)}[self.shape]
        return [(self.x + r * math.sin(2 * math.pi * (k + turn * 2) / steps),
                 self.y - r * math.cos(2 * math.pi * (k + turn * 2) / steps)) for k in range(steps)]


@dataclass(frozen=True)
class Label:
    """Text whose baseline starts, has its middle or ends at (x, y), as `anchor` says."""

    x: float
    y: float
    text: str
    anchor: str = "middle"
    size: float = 12
    color: str = INK
    is_upright: bool = False
    """Written from bottom to top."""


Shape = Line | Area | Mark | Label


@dataclass(frozen=True)
class Drawing:
    """What is drawn, the last in front."""

    width: float
    height: float
    shapes: tuple[Shape, ...]


def to_svg(drawing: Drawing) -> str:
    """A picture that stands alone. The marks of data points have `data-point`; classes let a page choose its colours.

    Coordinates that are not finite are left out of lines.
    """
    box = f"0 0 {drawing.width:g} {drawing.height:g}"
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" font-family="system-ui, sans-serif">',
             f'<rect class="paper" width="100%" height="100%" fill="{PAPER}"/>']
    parts += [_SVG[type(shape)](shape) for shape in drawing.shapes]
    return "".join([*parts, "</svg>"])


def _line_svg(line: Line) -> str:
    dash = f' stroke-dasharray="{line.dash:g}"' if line.dash else ""
    kind = f' class="{line.kind}"' if line.kind else ""
    return (f'<polyline{kind} points="{_listed(line.points)}" fill="none" stroke="{line.color}" '
            f'stroke-width="{line.width:g}"{dash}/>')


def _area_svg(area: Area) -> str:
    return f'<polygon points="{_listed(area.corners)}" fill="{area.color}"/>'


def _mark_svg(mark: Mark) -> str:
    shape = (f'<polygon points="{_listed(mark.outline())}" fill="{mark.color if mark.is_filled else PAPER}" '
             f'stroke="{mark.color}" stroke-width="1.5" class="{"full" if mark.is_filled else "hollow"}"/>')
    if mark.point is None:
        return shape
    return (f'<g class="point" data-point="{mark.point}"><title>{html.escape(mark.title)}</title>'
            f'<circle cx="{mark.x:.1f}" cy="{mark.y:.1f}" r="11" fill="none" pointer-events="all"/>{shape}</g>')


def _label_svg(label: Label) -> str:
    turn = f' transform="rotate(-90 {label.x:.1f} {label.y:.1f})"' if label.is_upright else ""
    kind = {INK: ' class="ink"', SOFT: ' class="soft"'}.get(label.color, "")
    return (f'<text{kind} x="{label.x:.1f}" y="{label.y:.1f}" text-anchor="{label.anchor}" '
            f'font-size="{label.size:g}" fill="{label.color}"{turn}>{html.escape(label.text)}</text>')


_SVG: dict[type, Callable[[Any], str]] = {Line: _line_svg, Area: _area_svg, Mark: _mark_svg, Label: _label_svg}


def _listed(points: Iterable[Sequence[float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points if math.isfinite(x) and math.isfinite(y))
