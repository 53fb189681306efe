"""A sheet of several pictures, each with a label below it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image as Pillow
from PIL import ImageDraw

from ..errors import UsageError
from .fonts import Font, font_for
from .image import Image

MAX_PIXELS = 1 << 27
"""As many as a picture may have that `Image.open` reads."""
_PAPER, _INK, _MISSING = (245, 245, 245, 255), (40, 40, 40, 255), (225, 225, 225, 255)
_GAP = 4


def labelled_sheet(cells: Sequence[tuple[str, np.ndarray | None]], columns: int, size: tuple[int, int]) -> Image:
    """The pictures of `cells`, (H, W, 4) uint8 as displayed, in rows of `columns`, each in the middle of a cell for
    pictures of `size` (width, height). None is a picture that is missing.

    A label that is too long has an ellipsis in its middle. Raises UsageError for a sheet of more than MAX_PIXELS.
    """
    strip = label_height(size)
    width, height = sheet_size(len(cells), columns, size)
    sheet = Pillow.new("RGBA", (width, height), _PAPER)
    draw = ImageDraw.Draw(sheet)
    for k, (label, pixels) in enumerate(cells):
        left = _GAP + k % columns * (size[0] + _GAP)
        top = _GAP + k // columns * (size[1] + strip + _GAP)
        if pixels is None:
            draw.rectangle((left, top, left + size[0] - 1, top + size[1] - 1), _MISSING)
        else:
            rows, across = pixels.shape[:2]
            sheet.paste(Pillow.fromarray(pixels), (left + (size[0] - across) // 2, top + (size[1] - rows) // 2))
        label = "".join(character if character.isprintable() else " " for character in label)
        font = font_for(label, 0.6 * strip)
        middle = left + size[0] / 2, top + size[1] + strip / 2
        draw.text(middle, _cut(label, font, size[0]), _INK, font, anchor="mm")
    return Image.from_srgb(np.asarray(sheet))


def label_height(size: tuple[int, int]) -> int:
    """The height of the strip with the label, for pictures of this size."""
    return max(round(0.09 * min(size)), 18)


def sheet_size(count: int, columns: int, size: tuple[int, int]) -> tuple[int, int]:
    """(width, height) of a sheet of `count` pictures. Raises UsageError for one of more than MAX_PIXELS."""
    columns, rows = min(columns, max(count, 1)), -(-count // columns)
    width, height = _GAP + columns * (size[0] + _GAP), _GAP + rows * (size[1] + label_height(size) + _GAP)
    if width * height > MAX_PIXELS:
        raise UsageError(f"a sheet of {count} pictures of {size[0]}x{size[1]} has {width}x{height} pixels, more than "
                         f"{MAX_PIXELS}; --size makes them smaller")
    return width, height


def _cut(label: str, font: Font, width: int) -> str:
    """The label, or as much of both ends as fits, with an ellipsis between them: alike names differ at the end, too."""
    shown, kept = label, len(label)
    while kept and font.getlength(shown) > width:
        kept -= 1
        shown = f"{label[:(kept + 1) // 2]}…{label[len(label) - kept // 2:]}"
    return shown
