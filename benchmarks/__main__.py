"""Measure ours and, where there are any, the others, in turn: `python -m benchmarks --help`."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from . import shot
from .machine import facts, until_stopped
from .process import Run, run
from .programs import Program, ours, peers
from .summary import Rounds
from .tables import conditions, phase_table, target_table

SCREENSHOT = (512, 512)
FRAME_SIZES = ((512, 512), (1280, 720))
PHASES = {"cold": ("cold",), "warm": ("warm",), "frame": ("frame",), "memory": ("cold", "warm"),
          "all": ("cold", "warm", "frame")}


def main() -> None:
    options = _parse()
    programs = ours()
    if options.peers:
        programs += peers(options.peers, options.peer_scripts)
    if options.only:
        programs = [program for program in programs if program.name in options.only.split(",")]
    with tempfile.TemporaryDirectory(prefix="benchmarks-") as folder:
        comparison = Comparison(programs, options.model, options.env, options.frames, Path(folder))
        with until_stopped():
            comparison.measure(PHASES[options.phase], options.rounds)
    image_based = {program.name for program in programs if program.image_based}
    about = {**facts(comparison.named, comparison.phases), "model": Path(options.model).name,
             "environment": Path(options.env).name, "rounds": options.rounds, "frames a round": options.frames}
    report = "\n\n".join(filter(None, [
        conditions(about), *(phase_table(phase, rounds, image_based) for phase, rounds in comparison.phases.items()),
        target_table(comparison.phases, image_based)]))
    print(report)
    if options.json:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps({"about": about, "phases": comparison.phases}, indent=1) + "\n")
        options.json.with_suffix(".md").write_text(report + "\n")


class Comparison:
    """Every round goes once through all programs, starting with another one each time."""

    def __init__(self, programs: list[Program], model: str, environment: str, frames: int, folder: Path) -> None:
        self.programs, self.model, self.environment = programs, model, environment
        self.frames, self.folder = frames, folder
        self.phases: dict[str, Rounds] = {}
        self.named: dict[str, Run] = {}
        self.picture = folder / "picture.png"

    def measure(self, phases: tuple[str, ...], rounds: int) -> None:
        # Fills the folders that "warm" keeps, compiles Python, and has every program's files in the page cache; and
        # has each name its version and renderer, which our command line does not print.
        for program in self.programs:
            self.named[program.name] = self._frames(program, SCREENSHOT, 0)
            self._log("prepare", program, self._warm(program))
        for index in range(rounds):
            first = index % len(self.programs)
            turn = self.programs[first:] + self.programs[:first]
            for name, measure in [part for phase in phases for part in self._parts(phase).items()]:
                rows = self.phases.setdefault(name, {program.name: [] for program in self.programs})
                for program in turn:
                    result = measure(program)
                    rows[program.name].append(result)
                    self._log(name, program, result)

    def _parts(self, phase: str) -> dict[str, Callable[[Program], Run]]:
        if phase == "frame":
            return {"frame {}x{}".format(*size): partial(self._frames, size=size, count=self.frames)
                    for size in FRAME_SIZES}
        return {"cold": self._cold} if phase == "cold" else {"warm": self._warm}

    def _cold(self, program: Program) -> Run:
        with tempfile.TemporaryDirectory(dir=self.folder) as home:
            return self._screenshot(program, Path(home))

    def _warm(self, program: Program) -> Run:
        return self._screenshot(program, self._kept(program))

    def _screenshot(self, program: Program, home: Path) -> Run:
        command = program.screenshot(self.model, self.environment, SCREENSHOT, self.picture)
        return run(command, self.picture, SCREENSHOT, home, program.folder or home)

    def _frames(self, program: Program, size: tuple[int, int], count: int) -> Run:
        command = program.frames(self.model, self.environment, size, self.picture, count)
        home = self._kept(program)
        return run(command, self.picture, size, home, program.folder or home)

    def _kept(self, program: Program) -> Path:
        home = self.folder / program.name
        home.mkdir(exist_ok=True)
        return home

    def _log(self, phase: str, program: Program, result: Run) -> None:
        shown = result.get("error") or ", ".join(f"{key} {result[key]}" for key in
                                                 ("wall_s", "frame_median_ms", "rss_mb", "load") if key in result)
        print(f"{time.strftime('%H:%M:%S')} {phase} {program.name}: {shown}", file=sys.stderr, flush=True)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("phase", nargs="?", choices=PHASES, default="all")
    parser.add_argument("--rounds", type=int, default=3, help="how often each program runs in each phase (3)")
    parser.add_argument("--frames", type=int, default=15, help="timed frames in one process, after warm-up (15)")
    parser.add_argument("--model", default=shot.default_model())
    parser.add_argument("--env", default=shot.default_environment(),
                        help="an equirectangular HDR; without others also a name of our own")
    parser.add_argument("--peers", type=Path, help="a folder with a virtual environment for each other program")
    parser.add_argument("--peer-scripts", type=Path, help="a folder with their peer_*.py; by default that of --peers")
    parser.add_argument("--only", default="", help="names of programs, with commas")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep every run there, and the tables beside it, .md")
    options = parser.parse_args()
    options.peer_scripts = options.peer_scripts or options.peers
    try:
        options.model, options.env = shot.inputs(options.model, options.env)
    except FileNotFoundError as error:
        parser.error(str(error))
    if options.peers and not Path(options.env).is_file():
        parser.error(f"--env {options.env}: the other programs need a file")
    return options


if __name__ == "__main__":
    main()
