"""How load time, memory and frames grow with triangles, materials, lights, textures and instances: ours by both plans,
and others.

    python -m benchmarks.growth [--kinds triangles materials lights textures instances] [--most N] [--results DIR]
    python -m benchmarks.growth --peers DIR --peer-scripts DIR --limit 20

Each scene is a glTF file made for it, and each run a process of its own, so that the memory it tells is its own. All
programs draw a scene in turn. Every shader is compiled anew; what a program keeps of the environment it has kept from a
run before. A program that fails or takes longer than `--limit` is not asked for more of the same.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from . import corpus, machine, shot, tracing
from .growth_scenes import KINDS, write
from .process import Run, run
from .programs import OURS, OURS_MULTISAMPLED, Program, ours, peers

COUNTS = {"triangles": (1_000, 10_000, 100_000, 1_000_000, 5_000_000), "materials": (1, 10, 50, 200, 1_000),
          "lights": (1, 10, 100, 1_000), "textures": (0, 1, 4, 16, 64),
          "instances": (1_000, 20_000, 200_000)}
COLUMNS = {"count": "count:,", "program": "program", "load, s": "load_s:.2f", "to the first frame, s": "ready_s:.2f",
           "steady frame, ms": "frame_median_ms:.1f", "peak memory, MB": "rss_mb:.0f",
           "textures and buffers, MB": "gpu_mb:.0f", "programs": "programs", "": "error"}
GROWING = {"load_s": "load", "ready_s": "first frame", "frame_median_ms": "steady frame", "rss_mb": "memory"}
ANEW = {"MESA_SHADER_CACHE_DISABLE": "true", "MESA_GLSL_CACHE_DISABLE": "true"}
_BEFORE_FIRST = ("load_s", "env_s", "first_frame_s")


def main() -> None:
    options = _parse()
    programs = [program for program in ours() if program.name != OURS_MULTISAMPLED]
    if options.peers:
        programs += peers(options.peers, options.peer_scripts)
    if options.only:
        programs = [program for program in programs if program.name in options.only.split(",")]
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory(prefix="growth-") as folder, machine.until_stopped():
        growth = Growth(programs, Path(folder), options)
        growth.prepare()
        for kind in options.kinds:
            for row in growth.measure(kind, [n for n in COUNTS[kind] if n <= (options.most or n)]):
                rows.append(row)
                print(row, flush=True)
    text = ["# Growth"]
    for kind in options.kinds:
        own = [row for row in rows if row["kind"] == kind]
        text += ["", f"## {kind.capitalize()}", "", *tracing.table(own, COLUMNS), "", *exponents(own)]
    loads = [row["load"] for row in rows if "load" in row]
    facts = machine.here() | {"size": f"{options.size}x{options.size}", "environment": Path(options.env).name,
                              "load average": f"{min(loads)} to {max(loads)}" if loads else "unknown",
                              "limit": f"{options.limit:g} s a run", "rounds": options.rounds}
    tracing.keep("growth", facts, rows, text, options.results)


class Growth:
    """Runs of programs on growing scenes; each program's home stays in `folder`."""

    def __init__(self, programs: Sequence[Program], folder: Path, options: argparse.Namespace) -> None:
        self._programs, self._folder, self._options = programs, folder, options
        self._scenes = options.scenes or folder
        self._scenes.mkdir(parents=True, exist_ok=True)

    def prepare(self) -> None:
        """A run of each program that does not count: it filters the environment, and Python is compiled."""
        for program in self._programs:
            self._run(program, write("triangles", 1_000, self._scenes), 120.0)

    def measure(self, kind: str, counts: Sequence[int]) -> Iterator[dict[str, object]]:
        """A row for each count and program."""
        given_up: dict[str, str] = {}
        for count in counts:
            path = write(kind, count, self._scenes)
            runs: dict[str, list[Run]] = {program.name: [] for program in self._programs}
            for _ in range(self._options.rounds):
                for program in self._programs:
                    if program.name not in given_up:
                        found = self._run(program, path, self._options.limit)
                        runs[program.name].append(found)
                        if "error" in found:
                            given_up[program.name] = f"not asked: {found['error']} with {count:,}"
            for name, several in runs.items():
                yield {"kind": kind, "count": count, "program": name} | _median(several or [{"error": given_up[name]}])

    def _run(self, program: Program, path: Path, limit: float) -> Run:
        size = self._options.size, self._options.size
        picture, home = self._folder / "picture.png", self._folder / program.name
        home.mkdir(exist_ok=True)
        command = program.frames(str(path.resolve()), self._options.env, size, picture, self._options.frames)
        found = run(command, picture, size, home, program.folder or home, limit, ANEW)
        if "error" not in found:
            found["ready_s"] = sum(float(found.get(name, 0.0)) for name in _BEFORE_FIRST)
        return found


def _median(runs: Sequence[Run]) -> Run:
    """Of each figure, over the runs that have it."""
    row: Run = {}
    for key in dict.fromkeys(key for one in runs for key in one):
        found = [one[key] for one in runs if key in one]
        is_figure = all(isinstance(value, (int, float)) for value in found)
        row[key] = statistics.median(found) if is_figure else found[-1]
    return row


def exponents(rows: Sequence[dict[str, object]]) -> list[str]:
    """Of each program the power of the count by which each figure grew at last: 1 is linear, 0 not at all."""
    lines = ["| grows by the power, at last | " + " | ".join(GROWING.values()) + " |", "|---|" + "---|" * len(GROWING)]
    for name in dict.fromkeys(row["program"] for row in rows):
        found = [row for row in rows if row["program"] == name and "error" not in row and row["count"]]
        if len(found) > 1:
            powers = [f"{power(found[-2], found[-1], key):.2f}" for key in GROWING]
            lines.append(f"| {name}, {found[-2]['count']:,} to {found[-1]['count']:,} | " + " | ".join(powers) + " |")
    return lines if len(lines) > 2 else []


def power(fewer: dict[str, object], more: dict[str, object], key: str) -> float:
    """Of the count, by which `key` grew from one row to the other; nan where one does not tell it."""
    if not (fewer.get(key) and more.get(key)):
        return math.nan
    return math.log(more[key] / fewer[key]) / math.log(more["count"] / fewer["count"])


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--most", type=int, help="no scene of more than this")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--env", default=shot.default_environment())
    parser.add_argument("--peers", type=Path, help="a folder with a virtual environment for each other program")
    parser.add_argument("--peer-scripts", type=Path, help="a folder with their peer_*.py; by default that of --peers")
    parser.add_argument("--only", default="", help=f"names of programs, with commas; ours is {OURS}")
    parser.add_argument("--limit", type=float, default=30.0, help="seconds that one run may take (30)")
    parser.add_argument("--scenes", type=Path, metavar="DIR", help="keep the scenes there, and take those that are")
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    options.peer_scripts = options.peer_scripts or options.peers
    options.env = shot.inputs(shot.default_model(), corpus.environment(options.env))[1]
    if options.peers and not Path(options.env).is_file():
        parser.error(f"--env {options.env}: the other programs need a file")
    return options


if __name__ == "__main__":
    main()
