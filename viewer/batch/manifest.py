"""`manifest.jsonl`: what has become of each picture of a batch, a line of JSON each, for `--resume` and pipelines."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any, Literal, Self

from ..base.atomic import atomic_write
from ..base.messages import say
from ..errors import OutputError
from ..jobs.render_job import RenderTask

MANIFEST = "manifest.jsonl"


@dataclass(frozen=True)
class Line:
    """`out` is the picture's file, relative to the manifest's folder; `key` is of `viewer.batch.keys`. `error` is None
    for a picture that is done. `seconds` is the time of loading, rendering and saving, and `worker` says where.
    `cameras` are those of `viewer.scene.camera_file.camera_facts`, if cameras are written: one, or a sheet's."""

    model: str
    out: str
    key: str
    status: Literal["done", "failed"]
    error: str | None
    seconds: float | None
    worker: str
    cameras: list[dict[str, Any]] = field(default_factory=list)


class Manifest:
    """The manifest of a folder, which must be there. Of several lines of a picture the last one counts, and the end of
    a `with` block removes the others, unless another command has written here meanwhile.

    A line is written at once, so that a process that is killed leaves those of all that it has done. Raises OutputError
    where it cannot be written, and for a file that is no manifest.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / MANIFEST
        self._folder = folder
        self._lines: dict[str, Line] = {}
        self._by_key: dict[str, dict[str, Line]] = {}
        self._repeats = 0
        self._size = 0  # of the lines that this object has read and written
        self._file: int | None = None
        if self.path.is_file():
            self._read(self._opened())
        elif self.path.exists():  # a pipe would be waited for
            raise OutputError(f"{self.path}: is not a regular file")

    def _opened(self) -> int:
        """The file, which the first line makes. It is opened again where another command has put a shorter one in its
        place: what is added to the old one would be lost. Raises OutputError where it is gone, and perhaps pictures
        with it."""
        if self._file is not None and not self._is_in_place():
            if not self.path.exists():
                raise OutputError(f"{self.path}: was removed while pictures were made; --resume makes what is missing")
            os.close(self._file)
            self._file, self._size = None, -1  # its lines are the other command's
        if self._file is None:
            flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
            try:
                self._file = os.open(self.path, flags, 0o666)
            except OSError as error:
                raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from error
        return self._file

    def _is_in_place(self) -> bool:
        assert self._file is not None
        try:
            return os.path.samestat(os.fstat(self._file), os.stat(self.path))
        except OSError:
            return False

    def _is_ours(self) -> bool:
        """Whether the file holds the lines that this object knows, and no others."""
        return self._file is not None and self._is_in_place() and os.fstat(self._file).st_size == self._size

    def _read(self, file: int) -> None:
        text = self.path.read_bytes()
        whole, _, rest = text.rpartition(b"\n")
        self._size = len(text) - len(rest)
        if rest:
            say(f"{self.path}: warning: the last line is cut off, and left out")
            os.ftruncate(file, self._size)
        for number, line in enumerate(whole.split(b"\n") if whole else (), 1):
            try:
                self._note([_checked(Line(**json.loads(line)))])
            except (ValueError, TypeError, RecursionError) as error:
                raise OutputError(f"{self.path}: line {number}: is no line of a manifest of pictures; move the file "
                                  "away, or give another -o") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        is_ours = self._is_ours()
        if self._file is not None:
            os.close(self._file)
        if self._repeats and is_ours:
            with suppress(OutputError), atomic_write(self.path) as temporary:
                temporary.write_bytes(_text(self._lines.values()))

    def _note(self, lines: Iterable[Line]) -> None:
        for line in lines:
            if line.out in self._lines:
                self._drop(line.out)
            self._lines[line.out] = line
            self._by_key.setdefault(line.key, {})[line.out] = line

    def _drop(self, out: str) -> None:
        self._repeats += 1
        del self._by_key[self._lines.pop(out).key][out]

    def add(self, lines: Sequence[Line], instead_of: str = "") -> None:
        """Add the lines of a model, all or none. They take the place of a failure of the file `instead_of`: a model
        that could not be loaded has a line without views. Raises OutputError."""
        text, file = _text(lines), self._opened()
        before, size = os.fstat(file).st_size, self._size
        try:
            while text:
                written = os.write(file, text)
                text, self._size = text[written:], self._size + written
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(file, before)
            self._size = size
            raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from error
        self._note(lines)
        old = self._lines.get(instead_of)
        if old is not None and old.status == "failed" and all(line.out != instead_of for line in lines):
            self._drop(instead_of)

    def out(self, path: Path) -> str:
        """How lines name the file `path`."""
        return Path(os.path.relpath(path, self._folder)).as_posix()

    def is_done(self, task: RenderTask, key: str) -> bool:
        """Whether all pictures of the model were made with this key and are there.

        How many views a model has is known only when it is loaded; but the lines of all of them are written at once. A
        model that could not be loaded, or whose worker died, has one line without a view instead.
        """
        lines = self.lines_of(task, key)
        return bool(lines) and all(line.status == "done" and self.file_of(line).is_file() for line in lines)

    def lines_of(self, task: RenderTask, key: str) -> list[Line]:
        """The lines of all pictures of the model that were made with this key."""
        lines = list(self._by_key.get(key, {}).values())
        return [line for line in lines if line.out != self.out(task.picture())] or lines

    def failed(self) -> list[Path]:
        """The files of the pictures that were not made the last time."""
        return [self.file_of(line) for line in self._lines.values() if line.status == "failed"]

    def file_of(self, line: Line) -> Path:
        """The file of its picture."""
        return self._folder / line.out


def _checked(line: Line) -> Line:
    """Raises ValueError or TypeError for a line of another form than that of `Line`."""
    texts = (line.model, line.out, line.key, line.worker, line.error or "")
    if not (all(isinstance(text, str) for text in texts) and line.status in ("done", "failed")
            and isfinite(line.seconds or 0)
            and isinstance(line.cameras, list) and all(isinstance(camera, dict) for camera in line.cameras)):
        raise ValueError
    return line


def _text(lines: Iterable[Line]) -> bytes:
    shown = ({key: value for key, value in asdict(line).items() if key != "cameras" or value} for line in lines)
    return "".join(json.dumps(line, allow_nan=False) + "\n" for line in shown).encode()
