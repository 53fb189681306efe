"""What is said on a terminal: one line at a time, and nothing in it that a terminal would obey."""

from __future__ import annotations

from contextlib import suppress

import click

from ..errors import ContextError


def one_line(text: str) -> str:
    """`text` with its white space as single spaces and control characters (of a file's name, say) as escapes."""
    text = " ".join(text.split())
    return text if text.isprintable() else "".join(c if c.isprintable() else _escape(c) for c in text)


def say(text: str) -> None:
    """A line on stderr; nowhere to write it is no error."""
    with suppress(OSError):
        click.echo(one_line(text), err=True)


def say_error(error: BaseException | str) -> None:
    """`pbr-viewer: ` and what went wrong, in a line; of contexts, a line for each that was tried."""
    lines = str(error).splitlines() if isinstance(error, ContextError) else [str(error)]
    for number, line in enumerate(lines):
        say(line if number else f"pbr-viewer: {line}")


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()
