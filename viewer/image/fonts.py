"""Fonts for text in pictures."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from PIL import ImageFont

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont
_OF_SYSTEMS = (
    "DejaVuSans.ttf", "NotoSans-Regular.ttf", "NotoSansCJK-Regular.ttc", "DroidSansFallbackFull.ttf", "wqy-zenhei.ttc",
    "wqy-microhei.ttc", "Arial Unicode.ttf", "PingFang.ttc", "Hiragino Sans GB.ttc", "msyh.ttc", "YuGothM.ttc",
    "malgun.ttf", "segoeui.ttf", "seguisym.ttf")
"""Files that Pillow finds in the folders for fonts of Linux, macOS and Windows, those with many scripts first."""
_NO_CHARACTER = "\U0010ffff"


def roboto_file() -> Path:
    """A font with Latin, Greek and Cyrillic letters, which comes with imgui-bundle."""
    spec = find_spec("imgui_bundle")
    assert spec is not None and spec.origin is not None  # a dependency; it is not imported, which takes long
    return Path(spec.origin).parent / "assets" / "fonts" / "Roboto" / "Roboto-Regular.ttf"


def font_for(text: str, size: float) -> Font:
    """The first font of those on this machine that has all characters of `text`; if none has, the one that lacks the
    fewest, with boxes in their place. `size` is in pixels.

    Pillow's own font comes first: it is the same everywhere, and has ASCII alone.
    """
    best = ImageFont.load_default(size)
    fewest = _lacking(best, text)
    for name in (str(roboto_file()), *_OF_SYSTEMS):
        if not fewest:
            break
        font = _font(name, size)
        lacking = fewest if font is None else _lacking(font, text)
        if font is not None and lacking < fewest:
            best, fewest = font, lacking
    return best


@cache
def _font(name: str, size: float) -> Font | None:
    try:
        return ImageFont.truetype(name, size)
    except OSError:  # there is none
        return None


def _lacking(font: Font, text: str) -> int:
    """How many characters of the text the font draws as it draws what is no character."""
    box = bytes(font.getmask(_NO_CHARACTER))
    return sum(bytes(font.getmask(character)) == box for character in set(text) if not character.isspace())
