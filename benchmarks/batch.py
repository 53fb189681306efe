"""How much faster several processes, or several workers of Dask, render many models, and whether their memory grows.

    python -m benchmarks.batch [--models N] [--size N] [--rounds N] [--results DIR]

Models of the corpus from 10 kB to 8 MB, evenly by their order in size, with four views each. The ways take turns in
each round, beginning with another one each time. The clock runs from the start of the command to its end; "after the
start" leaves out what comes before the second model is done, so that it is the rate of a long batch. The memory is the
largest resident set that the one process of `--jobs 1` has had by then.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from . import corpus, machine, tracing
from .shot import REPOSITORY

VIEWS = "front,right,top,iso"
WAYS = {"--jobs 1": ("--jobs", "1"), "--jobs 2": ("--jobs", "2"),
        "Dask, 1 worker": ("--dask=local", "--jobs", "1"), "Dask, 2 workers": ("--dask=local", "--jobs", "2")}
PAIRS = (("--jobs 2", "--jobs 1", 1.8), ("Dask, 2 workers", "Dask, 1 worker", 1.6))


def main() -> None:
    options = _parse()
    models = chosen_models(options.models)
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory(prefix="batch-") as name, machine.until_stopped():
        render(models, ("--jobs", "1"), Path(name), options.size)  # bakes the environment, and is not counted
        for number in range(options.rounds):
            ways = list(WAYS)
            for way in ways[number % len(ways):] + ways[:number % len(ways)]:
                rows.append({"way": way} | render(models, WAYS[way], Path(name), options.size))
                print(rows[-1], flush=True)
        memory = grown(models, Path(name), options)
    loads = [float(str(row["load"])) for row in rows]
    facts = machine.here() | {"models": len(models), "views of each": len(VIEWS.split(",")),
                              "size": f"{options.size}x{options.size}", "rounds": options.rounds,
                              "load average": f"{min(loads):.1f} to {max(loads):.1f}" if loads else "unknown"}
    tracing.keep("batch", facts, [*rows, memory], ["# Many pictures", "", *table(rows), "", *memory_table(memory)],
                 options.results)


def chosen_models(count: int) -> list[Path]:
    index = json.loads((corpus.FOLDER / "INDEX.json").read_text())["models"]
    paths = [corpus.FOLDER / model["path"] for model in sorted(index, key=lambda model: model["bytes"])
             if 1e4 <= model["bytes"] <= 8e6]
    return [paths[k * len(paths) // count] for k in range(min(count, len(paths)))]


def render(models: list[Path], way: tuple[str, ...], folder: Path, size: int, *more: str) -> dict[str, object]:
    """The seconds of a batch in all, those after its start for each model, and the load when it began."""
    out = Path(tempfile.mkdtemp(dir=folder))
    arguments = ["render", "-", "-o", f"{out}/", "--size", str(size), "--view", VIEWS, "-q", *way, *more]
    load, started = os.getloadavg()[0], time.perf_counter()
    process = subprocess.Popen([sys.executable, "-m", "viewer", *arguments], stdin=subprocess.PIPE, text=True,
                               cwd=REPOSITORY)
    assert process.stdin is not None
    process.stdin.write("\n".join(map(str, models)))
    process.stdin.close()
    seen: list[float] = []  # when each model was done
    while process.poll() is None:
        done = _lines(out / "manifest.jsonl")
        seen += [time.perf_counter()] * (len({line["model"] for line in done}) - len(seen))
        time.sleep(0.01)
    ended = time.perf_counter()
    lines = _lines(out / "manifest.jsonl")
    failed = sum(line["status"] == "failed" for line in lines)
    steady = (seen[-1] - seen[1]) / (len(seen) - 2) if len(seen) > 2 else None
    return {"wall_s": ended - started, "s_a_model": steady, "pictures": len(lines) - failed, "failed": failed,
            "load": load}


def _lines(manifest: Path) -> list[dict[str, str]]:
    try:
        return [json.loads(line) for line in manifest.read_text().splitlines()]
    except (FileNotFoundError, ValueError):  # half of a line was read
        return []


def grown(models: list[Path], folder: Path, options: argparse.Namespace) -> dict[str, object]:
    """The memory of one process over many pictures of the same models."""
    stats = folder / "stats.json"
    links = []
    for number in range(-(-options.pictures // len(models))):
        for k, model in enumerate(models):
            place = folder / f"links-{number}-{k}"
            place.symlink_to(model.parent, target_is_directory=True)
            links.append(place / model.name)
    render(links, ("--jobs", "1"), folder, 64, "--view", "iso", "--stats", str(stats))
    peaks = [record["memory"]["peak_rss_mb"] for record in json.loads(stats.read_text()) if "memory" in record]
    return {"way": "memory", "peak_rss_mb": {count: peaks[count - 1] for count in (10, 50, 100, 200, 500, 1000)
                                             if count <= len(peaks)} | {len(peaks): peaks[-1]}}


def table(rows: list[dict[str, object]]) -> list[str]:
    lines = ["| way | s in all: median of the rounds | s a model after the start | pictures | failed |",
             "|---|---|---|---|---|"]
    medians: dict[tuple[str, str], float] = {}
    for way in WAYS:
        own = [row for row in rows if row["way"] == way]
        for key in ("wall_s", "s_a_model"):
            values = [float(str(row[key])) for row in own if row[key] is not None]
            medians[way, key] = statistics.median(values) if values else float("nan")
        if own:
            lines.append(f"| {way} | {medians[way, 'wall_s']:.1f} | {medians[way, 's_a_model']:.3f} | "
                         f"{own[-1]['pictures']} | {own[-1]['failed']} |")
    lines += ["", "| ratio | in all | after the start | aim |", "|---|---|---|---|"]
    for fast, slow, aim in PAIRS:
        ratios = [medians[slow, key] / medians[fast, key] for key in ("wall_s", "s_a_model")]
        lines.append(f"| {slow} / {fast} | {ratios[0]:.2f} | {ratios[1]:.2f} | {aim} |")
    return lines


def memory_table(memory: dict[str, object]) -> list[str]:
    peaks = memory["peak_rss_mb"]
    assert isinstance(peaks, dict)
    return ["| pictures by one process | largest resident set so far, MB |", "|---|---|",
            *(f"| {count} | {peak:.0f} |" for count, peak in peaks.items())]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=int, default=20)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--pictures", type=int, default=300, help="of the one process whose memory is measured")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
