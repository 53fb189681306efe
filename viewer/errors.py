"""The errors that a user can fix.

The text of each is a single line that says what is wrong and where. The command line prints it on stderr and exits with
`exit_status`. Any other exception that reaches the user is a bug.
"""

from __future__ import annotations

from os import PathLike


class ViewerError(Exception):
    """The base class of all errors that pbr-viewer raises on purpose."""

    exit_status = 1


class InputError(ViewerError):
    """A file that cannot be used. The text names the file, the place in it and the problem.

    `place` is in terms of the file's format (``accessors[3].count``, ``line 12``), or "" for the whole file.
    """

    def __init__(self, file: str | PathLike[str], place: str, problem: str) -> None:
        self.file, self.place, self.problem = str(file), place, problem
        text = ": ".join(part for part in (self.file, place, problem) if part)
        super().__init__(" ".join(text.split()))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, str]]:
        return type(self), (self.file, self.place, self.problem)


class OutputError(ViewerError):
    """A result that cannot be written."""


class UsageError(ViewerError):
    """Arguments or options that contradict each other, have wrong values or name something that does not exist."""

    exit_status = 2


class ContextError(ViewerError):
    """No OpenGL context. The text has one line for each back end tried, with the reason, and one about what to
    install."""

    exit_status = 3


class ShaderError(ViewerError):
    """A shader that does not compile or link. The text names the source file and line."""
