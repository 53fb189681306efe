"""The errors a user can mend.

Each one is a single line that says what is wrong and where; the command line prints it on stderr and exits with
`exit_status`. Anything else that escapes is a bug of ours.
"""

from __future__ import annotations

from os import PathLike


class ViewerError(Exception):
    """Base of everything pbr-viewer raises on purpose."""

    exit_status = 1


class InputError(ViewerError):
    """A file that cannot be used: which one, the place in it, and what is wrong there.

    `place` is a path into the file in its own terms (``accessors[3].count``, ``line 12``), or "" for the whole file.
    """

    def __init__(self, file: str | PathLike[str], place: str, problem: str) -> None:
        self.file, self.place, self.problem = str(file), place, problem
        text = ": ".join(part for part in (self.file, place, problem) if part)
        super().__init__(" ".join(text.split()))


class OutputError(ViewerError):
    """A result that cannot be written."""


class UsageError(ViewerError):
    """Options that contradict each other or name something that does not exist."""

    exit_status = 2


class ContextError(ViewerError):
    """No OpenGL context: the text lists what was tried, why each failed and what to install."""

    exit_status = 3


class ShaderError(ViewerError):
    """A shader that does not compile or link; the text names the real file and line."""
