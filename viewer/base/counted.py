"""Numbers of things in words."""

from __future__ import annotations


def counted(count: int, noun: str) -> str:
    """As "1 surface" or "2 surfaces"."""
    return f"{count} {noun}{'s' * (count != 1)}"
