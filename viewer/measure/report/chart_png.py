"""A chart as PNG, drawn with Pillow: for what shows no SVG."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from ...base.atomic import atomic_write
from .chart import Chart, Line, Mark, Words

SCALE = 2
"""Pixels of the file to one of the layout."""
_FINE = 2 * SCALE  # drawn twice as large and shrunk: Pillow's lines have no soft edges
_ANCHORS = {"start": "l", "middle": "m", "end": "r"}


def save_png(chart: Chart, file: Path) -> None:
    """Raises OutputError."""
    size = round(chart.width * _FINE), round(chart.height * _FINE)
    picture = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(picture)
    for shape in chart.shapes:
        if isinstance(shape, Line):
            _draw_line(draw, shape)
        elif isinstance(shape, Mark):
            corners = [(x * _FINE, y * _FINE) for x, y in shape.outline()]
            draw.polygon(corners, shape.color if shape.is_on_front else "white", shape.color, round(1.5 * _FINE))
        else:
            _draw_words(picture, draw, shape)
    with atomic_write(file) as temporary:
        picture.reduce(_FINE // SCALE).save(temporary, "PNG", optimize=True)


def _draw_line(draw: ImageDraw.ImageDraw, line: Line) -> None:
    width = max(round(line.width * _FINE), 1)
    points = [(x * _FINE, y * _FINE) for x, y in line.points]
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


def _draw_words(picture: Image.Image, draw: ImageDraw.ImageDraw, words: Words) -> None:
    font = ImageFont.load_default(words.size * _FINE)
    color = "#222222" if words.kind == "ink" else "#666666"
    x, y = words.x * _FINE, words.y * _FINE
    if not words.is_upright:
        draw.text((x, y), words.text, color, font, _ANCHORS[words.anchor] + "s")
        return
    _, top, right, bottom = font.getbbox(words.text, anchor="ls")
    label = Image.new("L", (math.ceil(right), math.ceil(bottom - top)), 0)
    ImageDraw.Draw(label).text((0, -top), words.text, 255, font, "ls")
    label = label.transpose(Image.Transpose.ROTATE_90)
    start = {"start": y - label.height, "middle": y - label.height / 2, "end": y}[words.anchor]
    picture.paste(color, (round(x + top), round(start)), label)
