"""A drawing as PNG, by Pillow: for programs that show no SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from ..base.atomic import atomic_write
from .drawing import PAPER, Area, Drawing, Label, Line, Mark

SCALE = 2
"""Pixels of the file to one of the layout."""
_FINE = 2 * SCALE  # drawn twice as large and shrunk: Pillow's lines have no soft edges
_ANCHORS = {"start": "l", "middle": "m", "end": "r"}


def save_png(drawing: Drawing, file: Path) -> None:
    """Raises OutputError."""
    size = round(drawing.width * _FINE), round(drawing.height * _FINE)
    picture = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(picture)
    for shape in drawing.shapes:
        if isinstance(shape, Line):
            _draw_line(draw, shape)
        elif isinstance(shape, Mark):
            draw.polygon(_scaled(shape.outline()), shape.color if shape.is_filled else PAPER, shape.color,
                         round(1.5 * _FINE))
        elif isinstance(shape, Area):
            draw.polygon(_scaled(shape.corners), shape.color)
        else:
            _draw_label(picture, draw, shape)
    with atomic_write(file) as temporary:
        picture.reduce(_FINE // SCALE).save(temporary, "PNG", optimize=True)


def _draw_line(draw: ImageDraw.ImageDraw, line: Line) -> None:
    width = max(round(line.width * _FINE), 1)
    points = _scaled(line.points)
    if not line.dash:
        draw.line(points, line.color, width, joint="curve")
        return
    step = line.dash * _FINE
    for (x0, y0), (x1, y1) in pairwise(points):
        length = math.hypot(x1 - x0, y1 - y0)
        for k in range(0, int(length / step), 2):
            a, b = k * step / length, min((k + 1) * step / length, 1.0)
            draw.line([(x0 + a * (x1 - x0), y0 + a * (y1 - y0)), (x0 + b * (x1 - x0), y0 + b * (y1 - y0))],
                      line.color, width)


def _draw_label(picture: Image.Image, draw: ImageDraw.ImageDraw, label: Label) -> None:
    font = ImageFont.load_default(label.size * _FINE)
    x, y = label.x * _FINE, label.y * _FINE
    if not label.is_upright:
        draw.text((x, y), label.text, label.color, font, _ANCHORS[label.anchor] + "s")
        return
    _, top, right, bottom = font.getbbox(label.text, anchor="ls")
    mask = Image.new("L", (math.ceil(right), math.ceil(bottom - top)), 0)
    ImageDraw.Draw(mask).text((0, -top), label.text, 255, font, "ls")
    mask = mask.transpose(Image.Transpose.ROTATE_90)
    start = {"start": y - mask.height, "middle": y - mask.height / 2, "end": y}[label.anchor]
    picture.paste(label.color, (round(x + top), round(start)), mask)


def _scaled(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(x * _FINE, y * _FINE) for x, y in points]
