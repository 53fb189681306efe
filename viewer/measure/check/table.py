"""The checks as a table on a terminal, with colours, or as plain text elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from .checks import Check, summary

_STYLES = {"pass": "green", "known": "yellow", "FAIL": "bold red", "GONE": "bold red"}


def verdict(check: Check) -> str:
    """One word: pass; known (it fails as expected); FAIL; GONE (it was expected to fail and passes)."""
    if check.expected:
        return "GONE" if check.passed else "known"
    return "pass" if check.passed else "FAIL"


def print_table(checks: Sequence[Check]) -> None:
    """To standard output, with the summary below it."""
    if sys.stdout.isatty():
        _print_rich(checks)
    else:
        widths = [max((len(text) for text in column), default=0) for column in zip(*map(_cells, checks))]
        for check in checks:
            print("  ".join(cell.ljust(width) for cell, width in zip(_cells(check), widths)).rstrip())
    print(summary(checks))


def _cells(check: Check) -> tuple[str, ...]:
    return verdict(check), check.check, check.case, f"{check.value:.2e}", f"<= {check.bound:.2e}", check.note


def _print_rich(checks: Sequence[Check]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, header_style="bold")
    for name in ("", "check", "case", "value", "bound", "note"):
        table.add_column(name, overflow="fold", no_wrap=name in ("", "value", "bound"))
    for check in checks:
        first, *rest = _cells(check)
        table.add_row(Text(first, _STYLES[first]), *map(Text, rest))
    Console().print(table)
