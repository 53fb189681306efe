"""Tells in words what differs between two snapshots of take.py; exits with status 1 where anything does.

    python tests/snapshot/compare.py before.json after.json

Only sections that both have are compared. That programs have other text is expected of some steps, and where all
pictures are equal, harmless: it is told by section, so that it can be told apart.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np

MOST_LINES, MOST_LETTERS = 12, 240
"""Of each section, of each line."""


def picture_lines(before: dict, after: dict, name: str, arrays: tuple[Mapping, Mapping], section: str) -> Iterator[str]:
    """The size of the difference comes first, so that lines can be sorted by it."""
    if before["shape"] != after["shape"]:
        yield f"shape {before['shape']} before, {after['shape']} after: {name}"
    elif before["sha256"] != after["sha256"]:
        first, second = (found.get(f"{section}/{name}") for found in arrays)
        if first is None or second is None:
            yield f"other pixels: {name}"
            return
        differs = ~((first == second) | (np.isnan(first) & np.isnan(second)))
        pixels = differs.any(axis=2) if differs.ndim == 3 else differs
        apart = np.abs(second - first, where=differs, out=np.zeros_like(first)).max()
        yield f"{apart:.2e} at most in {pixels.sum()} of {pixels.size} pixels: {name}" \
            if pixels.any() else f"equal numbers of other bits (signs of 0, NaN): {name}"


def _size(line: str) -> float:
    """Of a line of `picture_lines`; infinite where it tells none."""
    try:
        return float(line.split()[0])
    except ValueError:
        return float("inf")


def fact_lines(before: object, after: object, name: str) -> Iterator[str]:
    if isinstance(before, dict) and isinstance(after, dict):
        for key in dict.fromkeys((*before, *after)):
            if key not in before or key not in after:
                yield f"{name}.{key}: {'new' if key in after else 'gone'}"
            else:
                yield from fact_lines(before[key], after[key], f"{name}.{key}")
    elif before != after:
        if isinstance(before, list) and isinstance(after, list):
            before, after = ([item for item in these if item not in those]
                             for these, those in ((before, after), (after, before)))
        yield f"{name}: {_short(before)} before, {_short(after)} after"


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= MOST_LETTERS else text[:MOST_LETTERS] + " ..."


def program_lines(before: dict, after: dict, name: str) -> Iterator[str]:
    if before["sha256"] != after["sha256"]:
        yield f"{before['lines']} lines before, {after['lines']} after: {name}"


def section_lines(before: dict, after: dict, lines: Callable[[dict, dict, str], Iterator[str]]) -> list[str]:
    found = [f"gone: {name}" for name in before if name not in after]
    found += [f"new: {name}" for name in after if name not in before]
    return found + [line for name in before if name in after for line in lines(before[name], after[name], name)]


def program_summary(before: dict, after: dict) -> str:
    """Which files of the programs are concerned, and how often; and how many only have other switches or files."""
    changed = [name for name in dict.fromkeys((*before, *after)) if before.get(name) != after.get(name)]
    counts = Counter(" + ".join(part for part in name.split(" ") if part.endswith((".vert", ".frag")))
                     for name in changed)
    fresh = {after[name]["sha256"] for name in after if name not in before}
    moved = sum(before[name]["sha256"] in fresh for name in before if name not in after)
    parts = [f"{count} of {files}" for files, count in counts.most_common()]
    return "; ".join([*parts, f"{moved} that are gone have their text in one that is new"])


def main(first: str, second: str) -> int:
    paths = Path(first), Path(second)
    before, after = (json.loads(path.read_text()) for path in paths)
    arrays = tuple(np.load(npz) if (npz := path.with_suffix(".npz")).is_file() else {} for path in paths)
    for name, value in before["machine"].items():
        if value != after["machine"][name]:
            print(f"WARNING: taken on two machines, pixels may differ: {name} is {value} before, "
                  f"{after['machine'][name]} after")
    differs = False
    for section in dict.fromkeys((*before["sections"], *after["sections"])):
        if section not in before["sections"] or section not in after["sections"]:
            print(f"{section}: not compared, only one of the two has it")
            continue
        one, other = before["sections"][section], after["sections"][section]
        if section == "info":
            lines = section_lines(one, other, fact_lines)
        elif section.endswith("programs"):
            lines = section_lines(one, other, program_lines)
        else:
            lines = section_lines(one, other, lambda a, b, name, section=section: picture_lines(
                a, b, name, arrays, section))
            lines.sort(key=_size, reverse=True)
        differs |= bool(lines)
        print(f"{section}: {len(lines)} differences among {len(one)} entries" if lines
              else f"{section}: {len(one)} entries, all equal")
        if lines and section.endswith("programs"):
            print(f"  {program_summary(one, other)}")
        for line in lines[:MOST_LINES]:
            print(f"  {line if len(line) <= 2 * MOST_LETTERS else line[:2 * MOST_LETTERS] + ' ...'}")
        if len(lines) > MOST_LINES:
            print(f"  ... and {len(lines) - MOST_LINES} more")
    return int(differs)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: compare.py BEFORE.json AFTER.json")
    sys.exit(main(*sys.argv[1:]))
