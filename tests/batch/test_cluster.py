"""Tasks by Dask: workers that die, workers that come later, and a scheduler that is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import names
from fakes import FakeWorker
from needs import needs
from waiting import wait_until

from viewer.batch.cluster import Cluster
from viewer.batch.engines import ClusterLost, WorkerLost
from viewer.jobs.render_job import RenderTask

pytestmark = [needs("batch"), needs("posix")]
HERE = Path(__file__).parent


def task(model: str) -> RenderTask:
    return RenderTask(f"{model}.glb", Path(f"out/{model}.png"))


@pytest.fixture
def scheduler(folder: Path) -> Iterator[list[subprocess.Popen]]:
    """A scheduler, whose file is scheduler.json, and a worker beside it that sees the same files."""
    (folder / "out").mkdir()
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])}
    commands = [("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
                ("distributed.cli.dask_worker", "--nthreads", "3", "--no-nanny", "--no-dashboard")]
    started = [subprocess.Popen([sys.executable, "-m", module, *arguments, "--scheduler-file", "scheduler.json"],
                                env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for module, *arguments in commands]
    yield started
    for process in started:
        process.kill()
        process.wait()


def test_a_worker_of_a_local_cluster_that_dies_fails_its_own_task_alone(folder):
    (folder / "out").mkdir()
    with Cluster(FakeWorker, count=2) as engine:
        assert engine.room == 2
        waiting, killed = engine.submit(task("wait")), engine.submit(task("kill"))
        assert isinstance(killed.exception(60), WorkerLost) and not waiting.done()
        wait_until(lambda: engine.room == 2, what="another worker")
        assert engine.submit(task("a")).result(60).worker and not waiting.done()
        assert engine.submit(task("fail")).result(60).lines == ("fail.glb: broken",)
        Path("go").touch()
        assert waiting.result(60).worker != str(os.getpid())
    assert [name for name in names(folder / "out") if not name.startswith(".")] == ["a.png", "wait.png"]


def test_a_scheduler_that_is_killed_ends_the_batch_with_a_line(scheduler, monkeypatch):
    wait_until(Path("scheduler.json").is_file, what="a scheduler")
    with Cluster(FakeWorker, scheduler_file="scheduler.json") as engine:
        first = engine.submit(task("a"))
        assert first.result(60).worker == str(scheduler[1].pid), "it waits for a worker"
        wait_until(lambda: engine.room == 1)
        waiting = engine.submit(task("wait"))
        wait_until(Path("waits").exists)
        address = json.loads(Path("scheduler.json").read_text())["address"]
        os.kill(scheduler[0].pid, signal.SIGKILL)
        error = waiting.exception(60)
        assert isinstance(error, ClusterLost) and str(error).startswith(f"{address}: the scheduler is lost")
    assert Path("out/a.png").read_text() == "whole" and not Path("out/wait.png").exists()
