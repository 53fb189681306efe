"""What `reach` found, as Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from viewer.measure.report.ladder import PLAIN

_SAYING_LITTLE = ("Phong", "lights only")

Row = dict[str, Any]


def summary(rows: Sequence[Row]) -> list[str]:
    """How many reach it, and which do not."""
    told = [row for row in rows if row["verdict"] != "at the noise"]
    missed = [f"{row['model']} ({_place(row)}, {row['gain']:.1f})" for row in told if row["verdict"] != "yes"]
    lines = [f"{len(told) - len(missed)} of {len(told)} reach a third of plain's error; {len(rows) - len(told)} are at "
             "the noise."]
    return lines + ([f"Not reached, with the gain: {', '.join(missed)}."] if missed else [])


def by_family(rows: Sequence[Row], times: float) -> list[str]:
    """A line for each row: the least error of each family of methods, in brackets its time over plain's.

    What takes more than `times` plain's does not count.
    """
    families = list(dict.fromkeys(method["family"] for row in rows for method in row["methods"]))
    families = [family for family in families if family not in _SAYING_LITTLE]
    lines = ["| model | direct | plain | " + " | ".join(families) + " |", "|---|---|---|" + "---|" * len(families)]
    for row in rows:
        plain = next(method["ms"] for method in row["methods"] if method["label"] == PLAIN.label)
        cells = [_cell(row, family, plain, times) for family in families]
        lines.append(f"| {row['model']}, {_place(row)} | {max(row['direct'], 0):.3f} | {row['plain']:.4f} | "
                     f"{' | '.join(cells)} |")
    return lines


def _cell(row: Row, family: str, plain_ms: float, times: float) -> str:
    found = [method for method in row["methods"] if method["family"] == family and method["ms"] <= times * plain_ms]
    if not found:
        return ""
    best = min(found, key=lambda method: method["relmse"])
    return f"{max(best['relmse'], 0):.4f} ({best['ms'] / plain_ms:.1f})"


def _place(row: Row) -> str:
    return str(row["environment"]).split("_")[0]
