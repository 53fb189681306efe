"""Loads files of curves as a Scene: Cem Yuksel's .hair and .bcc, and Mitsuba's text, .curves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from .bcc import read_bcc
from .curves import Curves
from .curves_text import read_curves
from .hair import read_hair
from .scene import Scene

_READERS: dict[str, Callable[[Path, bytes, list[str]], tuple[Curves, str]]] = {
    "hair": read_hair, "bcc": read_bcc, "curves": read_curves}


def load_curve_file(path: Path, data: bytes, kind: str) -> Scene:
    """Read `data`, the content of `path`, as the format `kind`, one of `load.CURVE_FORMATS`. Raises InputError."""
    warnings: list[str] = []
    curves, text = _READERS[kind](path, data, warnings)
    facts: dict[str, object] = {"format": kind.upper()}
    if text:
        facts["comment"] = text
    return Scene(path.stem, curves=(curves,), warnings=tuple(warnings), facts=facts)
