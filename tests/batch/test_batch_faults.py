"""Batches by real processes, which are killed in the middle: `--resume` goes on, and every picture is there once,
whole, and as it is when it is made alone."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import SCENES, Run, names
from needs import needs
from waiting import PATIENCE_S, wait_until

from viewer.batch.manifest import MANIFEST
from viewer.image.image import Image

pytestmark = needs("posix")
MODELS = ("unlit", "emissive", "vertex-colors", "two-sided", "alpha")
SMALL = ("--size", "24", "--mode", "phong")


@pytest.fixture
def models(folder: Path) -> Path:
    """Two folders of models, which have the same names."""
    for part in ("a", "b"):
        (folder / "models" / part).mkdir(parents=True)
        for name in MODELS:
            shutil.copy(SCENES / f"{name}.glb", folder / "models" / part)
    return folder / "models"


def lines() -> list[dict]:
    try:
        return [json.loads(text) for text in Path("out", MANIFEST).read_text().splitlines()]
    except FileNotFoundError:
        return []


def start(*arguments: str) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-m", "viewer", "render", "models", "-o", "out/", *SMALL, *arguments],
                            stderr=subprocess.PIPE, text=True)


def stop_a_worker(process: subprocess.Popen, count: int) -> int:
    """Wait for `count` pictures, and stop the process that made the last of them, so that the batch cannot end."""
    wait_until(lambda: len(lines()) >= count or process.poll() is not None, what="a picture")
    assert process.poll() is None, process.communicate()
    worker = int(lines()[-1]["worker"].rpartition(":")[2])
    os.kill(worker, signal.SIGSTOP)
    return worker


def is_gone(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


@needs("linux")  # /proc
def test_kills_and_ctrl_c_lose_no_picture(run: Run, models: Path) -> None:
    killed = start("--jobs", "1", "--retries", "1")
    os.kill(stop_a_worker(killed, 1), signal.SIGKILL)  # the worker: its model is tried again
    worker = stop_a_worker(killed, 4)
    killed.kill()  # the command itself
    os.kill(worker, signal.SIGCONT)
    killed.communicate(timeout=PATIENCE_S)
    wait_until(lambda: is_gone(worker), what="the end of a worker without its command")

    stopped = start("--jobs", "1", "--resume")
    worker = stop_a_worker(stopped, len(lines()) + 1)
    stopped.send_signal(signal.SIGINT)
    os.kill(worker, signal.SIGCONT)
    told = stopped.communicate(timeout=PATIENCE_S)[1].splitlines()
    assert stopped.returncode == 130 and told[-1] == "pbr-viewer: interrupted"
    assert told[0].endswith(" of 10 models are done already") and told[-2].endswith(", by which --resume goes on")

    before = {line["out"]: line["worker"] for line in lines()}
    assert 5 <= len(before) < 10 and all(line["status"] == "done" for line in lines())
    outcome = run("render", "models", "-o", "out/", *SMALL, "--resume")
    assert (outcome.status, outcome.err) == (0, f"{len(before)} of 10 models are done already\n")
    after = {line["out"]: line["worker"] for line in lines()}
    assert len(lines()) == len(after) == 10 and before.items() <= after.items()
    made = sorted(path.relative_to("out").as_posix() for path in Path("out").rglob("*") if path.is_file())
    assert made == sorted([MANIFEST, *(f"{part}/{name}.png" for part in "ab" for name in MODELS)])
    for name in MODELS:
        run("render", models / "a" / f"{name}.glb", "-o", "alone.png", *SMALL)
        alone = Image.open("alone.png").srgb
        assert all(np.array_equal(Image.open(f"out/{part}/{name}.png").srgb, alone) for part in "ab"), name


def test_a_disk_that_is_full_fails_what_does_not_fit(run: Run, folder: Path) -> None:
    """A limit on the size of files stands in for it."""
    arguments = ["render", *(SCENES / f"{name}.glb" for name in ("unlit", "emissive")), "-o", "out/", "--no-cache",
                 "--mode", "phong"]
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        small, count = run(*arguments, "--size", "8"), len(lines())
        large = run(*arguments, "--size", "128")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert (small.status, small.err, count) == (0, "", 2)
    assert large.status == 1 and large.err.count("cannot be written: File too large") == 4, "each is tried twice"
    assert names(folder / "out") == ["emissive.png", MANIFEST, "unlit.png"]
    assert [line["status"] for line in lines()] == ["failed", "failed"]
    assert Image.open("out/unlit.png").size == (8, 8), "the older picture stays as it was"
