"""Reloads shaders when their files change, and notices when those of a model do."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path

from ..errors import ShaderError
from ..gpu.programs import Programs
from ..scene.files import Stamp, stamp_of

INTERVAL = 0.5
"""Seconds between two checks of the files."""


class ShaderWatch:
    """Watches the files of all programs in use. If a program fails to compile, the one before stays in use."""

    def __init__(self, programs: Programs) -> None:
        self._programs = programs
        self._in_use: tuple[int, int] | None = None
        self._stamps: dict[Path, Stamp] = {}
        self._next = 0.0

    def poll(self) -> str | None:
        """Reload the programs if a file has changed; it is checked at most every `INTERVAL`.

        Returns None if nothing has changed, "" after a successful reload, or the error.
        """
        self._note_files()
        if time.monotonic() < self._next:
            return None
        self._next = time.monotonic() + INTERVAL
        stamps = {file: stamp_of(file) for file in self._stamps}
        if stamps == self._stamps:
            return None
        self._stamps = stamps
        return self.reload()

    def reload(self) -> str:
        """Compile all programs again. Returns the error, or "" after success."""
        error = self._programs.reload()
        self._note_files()
        return error or ""

    def _note_files(self) -> None:
        """Update the list of watched files, which changes only with the programs. Files watched before keep their
        stamps."""
        in_use = (len(self._programs), self._programs.generation)
        if in_use == self._in_use:
            return
        try:
            files = self._programs.files()
        except ShaderError:  # an editor may have deleted a file and not written the new one yet
            return
        self._stamps = {file: self._stamps.get(file) or stamp_of(file) for file in files}
        self._in_use = in_use


class FileWatch:
    """Watches files that another program may be writing."""

    def __init__(self) -> None:
        self._stamps: dict[Path, Stamp] = {}
        self._changing: dict[Path, Stamp] | None = None
        self._next = 0.0

    def follow(self, files: Mapping[Path, Stamp]) -> None:
        """Watch these files, and no others, for being other than they were. One may have changed since."""
        self._stamps, self._changing = dict(files), None

    def poll(self) -> bool:
        """Whether a file has changed, and all have been left alone since the check before, which is at least `INTERVAL`
        ago: a program that writes one takes a while. It is told once."""
        if not self._stamps or time.monotonic() < self._next:
            return False
        self._next = time.monotonic() + INTERVAL
        stamps = {file: stamp_of(file) for file in self._stamps}
        if stamps == self._stamps:
            self._changing = None
            return False
        if stamps != self._changing:
            self._changing = stamps
            return False
        self._stamps, self._changing = stamps, None
        return True
