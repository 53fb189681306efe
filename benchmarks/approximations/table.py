"""The approximations as tables on a terminal, with colours, or as plain text elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

HEADINGS = ("", "alternative", "RMS error", "largest", "ns", "kB", "bake s")


def cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    """A row of the table, a cell for each of HEADINGS: `*` marks the renderer's own way, `+` others on the front."""
    mark = "*" if row["is_default"] else "+" if row["pareto"] else ""
    size = f"{row['bytes'] / 1e3:.{0 if row['bytes'] > 1e5 else 1}f}" if row["bytes"] else ""
    bake = f"{row['bake_s']:.2g}" if row["bake_s"] is not None else ""
    error = row["error"]
    return mark, row["name"], f"{error['rms']:.2g}", f"{error['max']:.2g}", spell_ns(row), size, bake


def spell_ns(row: Mapping[str, Any]) -> str:
    return f"{row['cost_ns']['median']:.1f}" if row["cost_ns"]["median"] < 99.95 else f"{row['cost_ns']['median']:.0f}"


def heading(piece: Mapping[str, Any]) -> str:
    return f"{piece['title']}: errors in {piece['unit']}, nanoseconds for one {piece['per']}"


def conclusion(piece: Mapping[str, Any]) -> str:
    """Why the renderer does it in its way, and which alternatives are better by these figures."""
    if piece["better"]:
        return f"Better than the renderer's way by these figures: {', '.join(piece['better'])}. {piece['reason']}"
    return piece["reason"]


def print_table(document: Mapping[str, Any]) -> None:
    """To standard output."""
    write = _print_rich if sys.stdout.isatty() else _print_plain
    for piece in document["pieces"]:
        write(piece)
    print(f"* the renderer's way, + others on the front; on {document['device']}, {document['clock']}")


def _print_plain(piece: Mapping[str, Any]) -> None:
    rows = [HEADINGS, *map(cells, piece["variants"])]
    widths = [max(map(len, column)) for column in zip(*rows)]
    print(heading(piece))
    for row in rows:
        print("  " + "  ".join(cell.ljust(width) if k < 2 else cell.rjust(width)
                               for k, (cell, width) in enumerate(zip(row, widths))).rstrip())
    print(f"  {conclusion(piece)}\n")


def _print_rich(piece: Mapping[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, header_style="bold", title=heading(piece), title_justify="left", title_style="bold",
                  caption=conclusion(piece), caption_justify="left")
    for k, name in enumerate(HEADINGS):
        table.add_column(name, justify="left" if k < 2 else "right", no_wrap=k != 1)
    for row in piece["variants"]:
        style = "bold" if row["is_default"] else "green" if row["pareto"] else ""
        table.add_row(*(Text(cell, style) for cell in cells(row)))
    Console().print(table, "")
