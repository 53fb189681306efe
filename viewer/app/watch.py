"""Shaders taken up again when their files change."""

from __future__ import annotations

import time
from pathlib import Path

from ..errors import ShaderError
from ..gpu.programs import Programs

INTERVAL = 0.5
"""Seconds between two looks at the files."""


class ShaderWatch:
    """Looks at the files of all programs in use. A program that fails to compile leaves the one before in place."""

    def __init__(self, programs: Programs) -> None:
        self._programs = programs
        self._in_use: tuple[int, int] | None = None
        self._stamps: dict[Path, tuple[int, int]] = {}
        self._next = 0.0

    def poll(self) -> str | None:
        """Reload what has changed, at most every `INTERVAL`: None if nothing has, "" if it went well, or the error."""
        self._note_files()
        if time.monotonic() < self._next:
            return None
        self._next = time.monotonic() + INTERVAL
        stamps = {file: _stamp(file) for file in self._stamps}
        if stamps == self._stamps:
            return None
        self._stamps = stamps
        return self.reload()

    def reload(self) -> str:
        """Compile all programs again; the error, or "" when it went well."""
        error = self._programs.reload()
        self._note_files()
        return error or ""

    def _note_files(self) -> None:
        """Which files there are to watch changes with the programs only; those already watched keep their stamps."""
        in_use = (len(self._programs), self._programs.generation)
        if in_use == self._in_use:
            return
        try:
            files = self._programs.files()
        except ShaderError:  # an editor is between deleting a file and writing it anew
            return
        self._stamps = {file: self._stamps.get(file) or _stamp(file) for file in files}
        self._in_use = in_use


def _stamp(file: Path) -> tuple[int, int]:
    """What changes when a file is written: its time and size; zeros while it is away."""
    try:
        status = file.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
