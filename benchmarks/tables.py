"""Figures as Markdown."""

from __future__ import annotations

import math
import statistics

from .programs import OURS
from .summary import TARGETS, Rounds, Spread, judge, values

_UNITS = {"wall_s": ("s", 2), "frame_median_ms": ("ms", 1), "rss_mb": ("MB", 0)}


def phase_table(phase: str, rounds: Rounds, image_based: set[str]) -> str:
    """One row a program: time and peak memory, median (p10 to p90, n), and the ratio of medians to ours; and what it
    takes of processors, which is less disturbed by what else runs."""
    key = "frame_median_ms" if phase.startswith("frame") else "wall_s"
    unit, digits = _UNITS[key]
    lines = [f"### {phase}", "", f"| program | {unit}: median (p10 to p90, n) | of ours | s of processors | "
             "peak memory, MB | light |", "|---|---|---|---|---|---|"]
    base = values(rounds.get(OURS, []), key)
    for name, runs in rounds.items():
        times, memory = values(runs, key), values(runs, "rss_mb")
        if not times:
            lines.append(f"| {name} | {f'failed: {_errors(runs)}' if runs else 'not run'} | | | | |")
            continue
        spread = Spread.of(times)
        factor = f"x{spread.median / Spread.of(base).median:.2f}" if base else ""
        used = statistics.median(values(runs, "processor_s") or [math.nan])
        light = "image-based" if name in image_based else "punctual only"
        lines.append(f"| {name} | {spread.median:.{digits}f} ({spread.p10:.{digits}f} to {spread.p90:.{digits}f}, "
                     f"{spread.n}) | {factor} | {used:.2f} | {max(memory):.0f} | {light} |")
    return "\n".join(lines)


def target_table(phases: dict[str, Rounds], image_based: set[str]) -> str:
    """The targets that these phases can be held against; empty without a rival."""
    rows = []
    for target in TARGETS:
        verdict = judge(target, phases.get(target.phase, {}), image_based)
        if verdict:
            ratio = verdict.ratio
            what = "peak memory" if target.key == "rss_mb" else "time"
            rows.append(f"| {target.phase}, {what} | {verdict.rival} | {ratio.median:.2f} ({ratio.p10:.2f} to "
                        f"{ratio.p90:.2f}, {ratio.n}) | {target.bound:g} | {'yes' if verdict.reached else 'no'} |")
    if not rows:
        return ""
    head = ["### Ours against the best of the others", "",
            "| what | rival | ratio within a round: median (p10 to p90, n) | at most | reached |",
            "|---|---|---|---|---|"]
    return "\n".join([*head, *rows])


def conditions(facts: dict[str, object]) -> str:
    return "\n".join(f"- {name}: {value}" for name, value in facts.items())


def _errors(runs: list[dict[str, object]]) -> str:
    return "; ".join(sorted({str(run["error"]).replace("|", "/") for run in runs if "error" in run}))
