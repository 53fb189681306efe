"""Batches whose workers, schedulers, commands, disks and models fail: whether every picture is there in the end.

    python -m benchmarks.faults [--only NAME...] [--slow SECONDS] [--results DIR]

Each run is a command with real processes, which renders 24 models of this project from two sides each, and is
disturbed in the middle. What has the name of a picture then has to be whole. After it the same command is given again,
with `--resume`, and nothing disturbs it. The run passes if each picture is there once, equal to the last bit to the one
that a command makes for its model alone, and `manifest.jsonl` has it once, as done; if no other file is left, and no
process; and if no command has told of an error by a traceback.

Needs Linux and the extra [batch]. The full disk is a small file system in memory where one may be mounted, as by root;
elsewhere a limit on the size of files. What crashes and what takes long is the reading of a model, by a hook that its
worker has.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from . import machine, tracing
from .fault_runs import PATIENCE_S, Case, Command, Disturbed, made_alone, wait_until
from .shot import REPOSITORY

JOBS = ("--jobs", "2")
DASK = ("--dask=local", "--jobs", "2")
FILE = ("--scheduler-file", "scheduler.json")


@dataclass(frozen=True)
class Fault:
    """`disturb` starts the command with the words `way` and disturbs it; its exit status has to be `status`."""

    way: tuple[str, ...]
    disturb: Callable[[Case, tuple[str, ...]], Command]
    status: int


def kill_workers(case: Case, way: tuple[str, ...]) -> Command:
    """the worker that made the last picture, three times, `kill -9`"""
    command = case.render(*way, "--retries", "3")
    for count in (6, 18, 30):
        case.wait_for(count, command)
        os.kill(case.last_worker, signal.SIGKILL)
    return command


def kill_command(case: Case, way: tuple[str, ...]) -> Command:
    """the command, `kill -9`, and with it the scheduler if there is one"""
    command = case.render(*way)
    case.wait_for(12, command)
    command.process.kill()
    return command


def interrupt(case: Case, way: tuple[str, ...]) -> Command:
    """Ctrl-C"""
    command = case.render(*way)
    case.wait_for(12, command)
    command.interrupt()
    return command


def fill_disk(case: Case, way: tuple[str, ...]) -> Command:
    """the disk is full after some of the pictures; it has room again for `--resume`"""
    case.out.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=128k", "none", str(case.out)],
                             capture_output=True).returncode == 0
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    if not mounted:
        resource.setrlimit(resource.RLIMIT_FSIZE, (6000, hard))
    try:
        command = case.render(*way)
        command.process.wait(PATIENCE_S)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    if mounted:
        subprocess.run(["mount", "-o", "remount,size=64m", str(case.out)], check=True)
    return command


def crash(case: Case, way: tuple[str, ...]) -> Command:
    """a model at which its process aborts"""
    case.add("crash", "alpha")
    return case.render(*way, disturbed=True)


def wait_for_model(case: Case, way: tuple[str, ...]) -> Command:
    """a model that takes minutes, beside the others"""
    case.add("slow", "alpha")
    command = case.render(*way, disturbed=True)
    started = time.monotonic()
    case.wait_for(48, command)
    if time.monotonic() - started > case.slow_s or any("slow" in line["out"] for line in case.lines):
        raise Disturbed("the others have waited for the slow model")
    return command


def stop_worker(case: Case, way: tuple[str, ...]) -> Command:
    """a worker that stands still, `kill -STOP`; Ctrl-C when the others are done"""
    command = case.render(*way)
    case.wait_for(10, command)
    os.kill(case.last_worker, signal.SIGSTOP)
    case.wait_for(46, command)
    command.interrupt()
    return command


def remove_folder(case: Case, way: tuple[str, ...]) -> Command:
    """the folder of the pictures is removed"""
    command = case.render(*way)
    case.wait_for(12, command)
    while case.out.exists():  # pictures may be written into it meanwhile
        shutil.rmtree(case.out, ignore_errors=True)
    return command


def run_twice(case: Case, way: tuple[str, ...]) -> Command:
    """the same command twice at once, into the same folder"""
    first, second = case.render(*way), case.render(*way, name="second")
    if second.end():
        raise Disturbed(f"the second: {second.told}")
    return first


def kill_scheduler(case: Case, way: tuple[str, ...]) -> Command:
    """the scheduler, `kill -9`; another one for `--resume`"""
    scheduler = _cluster(case, "1")
    command = case.render(*way)
    case.wait_for(12, command)
    scheduler.process.kill()
    command.process.wait(60)
    (case.folder / "scheduler.json").unlink()
    _cluster(case, "2")
    return command


def replace_workers(case: Case, way: tuple[str, ...]) -> Command:
    """all workers of a scheduler, `kill -9`; others come"""
    _cluster(case, "1")
    workers = case.commands[-2:]
    command = case.render(*way)
    case.wait_for(12, command)
    for worker in workers:
        worker.kill()
    for number in (3, 4):
        _dask(case, "worker", f"worker-{number}", "--nthreads", "1", "--no-dashboard")
    return command


def _cluster(case: Case, name: str) -> Command:
    """A scheduler, and two workers."""
    scheduler = _dask(case, "scheduler", f"scheduler-{name}", "--port", "0", "--no-dashboard", "--host", "127.0.0.1")
    wait_until((case.folder / "scheduler.json").is_file, "a scheduler")
    for number in (1, 2):
        _dask(case, "worker", f"worker-{name}-{number}", "--nthreads", "1", "--no-dashboard")
    return scheduler


def _dask(case: Case, what: str, name: str, *more: str) -> Command:
    return case.run([sys.executable, "-m", f"distributed.cli.dask_{what}", *FILE, *more], name, LP_NUM_THREADS="1")


FAULTS = {
    "worker killed (--jobs)": Fault(JOBS, kill_workers, 0),
    "command killed (--jobs)": Fault(JOBS, kill_command, -signal.SIGKILL),
    "Ctrl-C (--jobs)": Fault(JOBS, interrupt, 128 + signal.SIGINT),
    "disk full (--jobs)": Fault(JOBS, fill_disk, 1),
    "model crashes (--jobs)": Fault(JOBS, crash, 1),
    "model is slow (--jobs)": Fault(JOBS, wait_for_model, 0),
    "worker hangs (--jobs)": Fault(JOBS, stop_worker, 128 + signal.SIGINT),
    "folder vanishes (--jobs)": Fault(JOBS, remove_folder, 1),
    "two commands (--jobs)": Fault(JOBS, run_twice, 0),
    "worker killed (--dask)": Fault(DASK, kill_workers, 0),
    "command killed (--dask)": Fault(DASK, kill_command, -signal.SIGKILL),
    "Ctrl-C (--dask)": Fault(DASK, interrupt, 128 + signal.SIGINT),
    "scheduler killed (--scheduler-file)": Fault(FILE, kill_scheduler, 1),
    "workers killed (--scheduler-file)": Fault(FILE, replace_workers, 0),
}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory(prefix="faults-") as name, machine.until_stopped():
        truth = made_alone(Path(name) / "alone")
        for number, fault in enumerate(options.only or FAULTS):
            case = Case(Path(name) / str(number), truth, options.slow)
            rows.append({"fault": fault} | outcome(FAULTS[fault], case))
            print(rows[-1], flush=True)
    failed = [row for row in rows if row["problems"]]
    facts = machine.here() | {"pictures": "48 or 50 in a run, 64x64", "slow model": f"{options.slow:g} s",
                              "runs that passed": f"{len(rows) - len(failed)} of {len(rows)}"}
    tracing.keep("faults", facts, rows, ["# Faults of batches", "", *_table(rows)], options.results)
    sys.exit(bool(failed))


def outcome(fault: Fault, case: Case) -> dict[str, object]:
    """What became of a batch that was disturbed: `there` is the number of pictures after the fault, `status` the exit
    status, `told` the last line of the command, and `problems` all that is wrong then and after `--resume`."""
    row: dict[str, object] = {"what": " ".join(str(fault.disturb.__doc__).split())}
    try:
        command = fault.disturb(case, fault.way)
        status = command.end()
        problems = case.wrong_pictures()
        row |= {"status": status, "told": command.told[-1:], "there": len(case.there() & case.wanted())}
        if status != fault.status:
            problems.append(f"exit status {status} and not {fault.status}: {command.told[-3:]}")
        resumed = case.render(*fault.way, "--resume", name="resumed")
        if resumed.end():
            problems.append(f"--resume fails: {resumed.told[-3:]}")
        problems += case.problems()
        problems += [f"{each.name}: {line}" for each in case.commands for line in each.told
                     if line.startswith("Traceback") and "-m viewer" in " ".join(each.words)]
    except (Disturbed, subprocess.TimeoutExpired) as error:
        problems = [str(error)]
    finally:
        case.close()
    return row | {"problems": problems}


def _table(rows: list[dict[str, object]]) -> list[str]:
    lines = ["| run | what happens | exit status, last line | pictures after it | after `--resume` |",
             "|---|---|---|---|---|"]
    for row in rows:
        told = " ".join(row.get("told", ())).replace("|", "/")
        problems = row["problems"]
        lines.append(f"| {row['fault']} | {row['what']} | {row.get('status', '')}: {told} | {row.get('there', '')} | "
                     f"{'; '.join(problems).replace('|', '/') if problems else 'all whole, once, as made alone'} |")
    return [*lines, ""]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=FAULTS, metavar="NAME", help="; ".join(FAULTS))
    parser.add_argument("--slow", type=float, default=120.0, help="seconds that the slow model takes")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
