"""How fast many models are rendered: by one process and several, by Dask, and by other programs; and whether memory
grows.

    python -m benchmarks.batch [--models N] [--views N] [--size N] [--rounds N] [--pictures N] [--only PART]
                               [--peers DIR] [--results DIR]

Models of the corpus from 3 kB to 8 MB, evenly by their order in size. There are three parts:

- `ways`: several views of each model by one process and two, and by one worker of Dask and two. "After the start"
  leaves out what comes before the second model is done, so that it is the rate of a long batch.
- `programs`: one view of each by us, in the command's own process with the default quality and with `draft` (light of
  the environment and four samples a pixel, as `batch_peers.py` has of the others), with `--jobs 2`, and by the loops of
  other programs, whose virtual environments are in DIR. A rate counts the pictures that were made, from the start of
  the process to its end.
- `memory`: the resident set of one process that makes so many small pictures.

In each round those that are compared take turns, beginning with another one each time. The clock runs from the start of
a command to its end; stderr tells every ten seconds how far it is. Ctrl-C keeps what was measured. "Idle" is the share
of the cores' time in which the command does not use them; on a machine where others work it is theirs.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from . import corpus, machine, shot, tracing
from .shot import REPOSITORY

VIEWS = "front", "right", "back", "left", "top", "bottom", "iso"
"""And one by angles."""
WAYS = {"--jobs 1": ("--jobs", "1"), "--jobs 2": ("--jobs", "2"),
        "Dask, 1 worker": ("--dask=local", "--jobs", "1"), "Dask, 2 workers": ("--dask=local", "--jobs", "2")}
PAIRS = (("--jobs 2", "--jobs 1", 1.8), ("Dask, 2 workers", "Dask, 1 worker", 1.6))
PROGRAMS = {"pbr-viewer": (), "pbr-viewer, --jobs 2": ("--jobs", "2"), "pbr-viewer, draft": ("--quality", "draft"),
            "pbr-viewer, draft, --jobs 2": ("--quality", "draft", "--jobs", "2")}
LOOPS = "pyrender", "f3d", "open3d"
"""What batch_peers.py knows, and the names of the virtual environments."""


def main() -> None:
    options = _parse()
    models = chosen_models(options.models)
    rows: list[dict[str, object]] = []
    memory: dict[str, object] = {}
    with tempfile.TemporaryDirectory(prefix="batch-") as name, machine.until_stopped():
        folder = Path(name)
        for quality in ("auto", "draft"):  # not counted: fills the caches, of environments and of Mesa's programs
            render(models, ("--quality", quality), folder, options.size, 1)
        runs: dict[str, Callable[[], dict[str, object]]] = {}
        if options.only in (None, "ways"):
            runs |= {way: partial(render, models, more, folder, options.size, options.views)
                     for way, more in WAYS.items()}
        if options.only in (None, "programs"):
            runs |= {program: partial(render, models, more, folder, options.size, 1)
                     for program, more in PROGRAMS.items()}
            runs |= {loop: partial(other, models, loop, python, folder, options.size)
                     for loop, python in _loops(options.peers).items()}
        for number in range(options.rounds):
            names = list(runs)
            for way in names[number % len(names):] + names[:number % len(names)] if names else ():
                rows.append({"way": way} | runs[way]())
                print(rows[-1], flush=True)
        if options.only in (None, "memory"):
            memory = grown(models, folder, options)
    loads = [float(str(row["load"])) for row in rows]
    facts = machine.here() | {"models": len(models), "views of each in the first table": options.views,
                              "size": f"{options.size}x{options.size}", "rounds": options.rounds,
                              "load average": f"{min(loads):.1f} to {max(loads):.1f}" if loads else "unknown"}
    name = "batch" if options.only is None else f"batch_{options.only}"
    tracing.keep(name, facts, [*rows, memory], ["# Many pictures", "", *table(rows), *program_table(rows),
                                                *memory_table(memory)], options.results)


def chosen_models(count: int) -> list[Path]:
    index = json.loads((corpus.FOLDER / "INDEX.json").read_text())["models"]
    paths = [corpus.FOLDER / model["path"] for model in sorted(index, key=lambda model: model["bytes"])
             if 3e3 <= model["bytes"] <= 8e6]
    return [paths[k * len(paths) // count] for k in range(min(count, len(paths)))]


def render(models: list[Path], way: tuple[str, ...], folder: Path, size: int, views: int,
           *more: str) -> dict[str, object]:
    """The seconds of a batch in all, those after its start for each model, and what `_measured` tells."""
    out = Path(tempfile.mkdtemp(dir=folder))
    looks = ("--view", ",".join(VIEWS[:views - 1]), "--orbit", "30,15") if views > 1 else ()
    named = out.with_suffix(".txt")
    named.write_text("\n".join(map(str, models)))
    command = [sys.executable, "-m", "viewer", "render", "-", "-o", f"{out}/", "--size", str(size), *looks, "-q", *way,
               *more]
    seen: list[float] = []  # when each model was done

    def watch() -> int:
        done = _lines(out / "manifest.jsonl")
        seen.extend([time.perf_counter()] * (len({line["model"] for line in done}) - len(seen)))
        return len(seen)

    found = _measured(command, named, watch)
    lines = _lines(out / "manifest.jsonl")
    failed = sum(line["status"] == "failed" for line in lines)
    steady = (seen[-1] - seen[1]) / (len(seen) - 2) if len(seen) > 2 else None
    return found | {"s_a_model": steady, "pictures": len(lines) - failed, "failed": failed}


def other(models: list[Path], loop: str, python: Path, folder: Path, size: int) -> dict[str, object]:
    """The same of another program's loop, which makes one picture of each model."""
    out = Path(tempfile.mkdtemp(dir=folder))
    named, told = out / "models.txt", out / "told.jsonl"
    named.write_text("\n".join(map(str, models)))
    environment = shot.default_environment()
    command = [str(python), str(Path(__file__).with_name("batch_peers.py")), loop, str(named), str(size), str(out),
               str(told), environment]
    found = _measured(command, named, lambda: len(_lines(told)))
    errors = [line["error"] for line in _lines(told)]
    return found | {"s_a_model": None, "pictures": errors.count(None), "failed": len(models) - errors.count(None)}


def _measured(command: list[str], given: Path, watch: Callable[[], int]) -> dict[str, object]:
    """What a command takes that reads the file `given`: seconds, those of all its processes on the processor, the share
    of the cores that was idle or had other work, and the load when it began. `watch` tells how many models are done."""
    load, before, started, told = os.getloadavg()[0], _processor_s(), time.perf_counter(), 0.0
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    with given.open() as names:  # with bytecode of ours, as pip compiles packages
        process = subprocess.Popen(command, stdin=names, cwd=REPOSITORY, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, env=environment)
        try:
            while process.poll() is None:
                models, passed = watch(), time.perf_counter() - started
                if passed > told + 10:
                    told = passed
                    print(f"{models} models in {passed:.0f} s", file=sys.stderr, flush=True)
                time.sleep(0.02)
        finally:
            process.terminate()  # if this one is being stopped
            process.wait()
    wall, processor = time.perf_counter() - started, _processor_s() - before
    return {"wall_s": wall, "processor_s": processor, "idle": 1 - processor / (wall * len(os.sched_getaffinity(0))),
            "load": load}


def _processor_s() -> float:
    """Of all processes that this one has started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _loops(peers: Path | None) -> dict[str, Path]:
    pythons = {loop: peers / loop / "bin/python" for loop in LOOPS} if peers is not None else {}
    return {loop: python.absolute() for loop, python in pythons.items() if python.exists()}


def _lines(manifest: Path) -> list[dict[str, str]]:
    try:
        return [json.loads(line) for line in manifest.read_text().splitlines()]
    except (FileNotFoundError, ValueError):  # half of a line was read
        return []


def grown(models: list[Path], folder: Path, options: argparse.Namespace) -> dict[str, object]:
    """The memory of one process over many pictures of the same models, in another order each time."""
    stats, order = folder / "stats.json", random.Random(1)
    links = []
    for number in range(-(-options.pictures // len(models))):
        for k, model in enumerate(order.sample(models, len(models))):
            place = folder / f"links-{number}-{k}"
            place.symlink_to(model.parent, target_is_directory=True)
            links.append(place / model.name)
    render(links, (), folder, 64, 1, "--stats", str(stats))
    found = [record["memory"] for record in json.loads(stats.read_text()) if "memory" in record]
    hundreds = [found[first:first + 100] for first in range(0, len(found), 100)]
    return {"way": "memory", "hundreds": [
        {"pictures": 100 * k + len(each), "mean_rss_mb": statistics.mean(memory["rss_mb"] for memory in each),
         "peak_rss_mb": each[-1]["peak_rss_mb"]} for k, each in enumerate(hundreds)]}


def table(rows: list[dict[str, object]]) -> list[str]:
    if not any(row["way"] in WAYS for row in rows):
        return []
    lines = ["| way | s in all: median of the rounds | s a model after the start | s of processors | idle | pictures | "
             "failed |", "|---|---|---|---|---|---|---|"]
    medians: dict[tuple[str, str], float] = {}
    for way in WAYS:
        own = [row for row in rows if row["way"] == way]
        for key in ("wall_s", "s_a_model"):
            values = [float(str(row[key])) for row in own if row[key] is not None]
            medians[way, key] = statistics.median(values) if values else float("nan")
        if own:
            lines.append(f"| {way} | {medians[way, 'wall_s']:.1f} | {medians[way, 's_a_model']:.3f} | "
                         f"{_median(own, 'processor_s'):.1f} | {_median(own, 'idle'):.0%} | {own[-1]['pictures']} | "
                         f"{own[-1]['failed']} |")
    lines += ["", "| ratio | in all | after the start | aim |", "|---|---|---|---|"]
    for fast, slow, aim in PAIRS:
        ratios = [medians[slow, key] / medians[fast, key] for key in ("wall_s", "s_a_model")]
        lines.append(f"| {slow} / {fast} | {ratios[0]:.2f} | {ratios[1]:.2f} | {aim} |")
    return [*lines, ""]


def program_table(rows: list[dict[str, object]]) -> list[str]:
    """Pictures a minute of ours and of others."""
    found = {way: [row for row in rows if row["way"] == way] for way in (*PROGRAMS, *LOOPS)}
    if not any(found.values()):
        return []
    lines = ["| program | pictures a minute | s of processors a picture | idle | pictures | failed |",
             "|---|---|---|---|---|---|"]
    for way, own in found.items():
        if not own:
            continue
        made = _median(own, "pictures")
        rate = f"{60 * made / _median(own, 'wall_s'):.0f} | {_median(own, 'processor_s') / made:.3f}" if made else " | "
        lines.append(f"| {way} | {rate} | {_median(own, 'idle'):.0%} | {made:.0f} | {own[-1]['failed']} |")
    return [*lines, ""]


def _median(rows: list[dict[str, object]], key: str) -> float:
    return statistics.median(float(str(row[key])) for row in rows)


def memory_table(memory: dict[str, object]) -> list[str]:
    hundreds = memory.get("hundreds")
    if not isinstance(hundreds, list):
        return []
    return ["| pictures by one process | resident set, mean after each of the last 100, MB | the largest so far, MB |",
            "|---|---|---|",
            *(f"| {row['pictures']} | {row['mean_rss_mb']:.0f} | {row['peak_rss_mb']:.0f} |" for row in hundreds)]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=int, default=80)
    parser.add_argument("--views", type=int, choices=range(1, len(VIEWS) + 2), default=8,
                        help="of each model, in `ways`")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--pictures", type=int, default=1000, help="of the one process whose memory is measured")
    parser.add_argument("--only", choices=("ways", "programs", "memory"), help="one of the three parts")
    parser.add_argument("--peers", type=Path, help="the folder of the other programs' virtual environments")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
