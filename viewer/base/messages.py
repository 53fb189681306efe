"""Messages on the terminal: one line at a time, with control characters escaped."""

from __future__ import annotations

from contextlib import suppress

import click

from ..errors import ContextError


def one_line(text: str) -> str:
    """`text` with single spaces for white space, and escapes for control characters, for example in a file name."""
    text = " ".join(text.split())
    return text if text.isprintable() else "".join(c if c.isprintable() else _escape(c) for c in text)


def say(text: str) -> None:
    """Write a line to stderr. It is no error if stderr cannot be written."""
    with suppress(OSError):
        click.echo(one_line(text), err=True)


def say_error(error: BaseException | str) -> None:
    """Write `pbr-viewer: ` and the error in one line; a ContextError has one line for each back end that was tried."""
    lines = str(error).splitlines() if isinstance(error, ContextError) else [str(error)]
    for number, line in enumerate(lines):
        say(line if number else f"pbr-viewer: {line}")


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()
