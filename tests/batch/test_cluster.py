"""Tasks by Dask: workers that die, workers that come later, and a scheduler that is killed."""

from __future__ import annotations

import json
import os
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
SCHEDULER = """
import asyncio
from pathlib import Path
from distributed import Scheduler, Worker

async def serve():
    async with Scheduler(host="127.0.0.1", port=0, dashboard=False, scheduler_file="scheduler.json") as scheduler:
        while not Path("wanted").exists():
            await asyncio.sleep(0.01)
        async with Worker(scheduler.address, nthreads=3, dashboard=False):
            await scheduler.finished()

asyncio.run(serve())
"""


def task(model: str) -> RenderTask:
    return RenderTask(f"{model}.glb", Path(f"out/{model}.png"))


@pytest.fixture
def scheduler(folder: Path) -> Iterator[subprocess.Popen]:
    """A process with a scheduler, whose file is scheduler.json, and with a worker that comes later and sees the same
    files."""
    (folder / "out").mkdir()
    process = subprocess.Popen([sys.executable, "-c", SCHEDULER], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env=os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])})
    yield process
    process.kill()
    process.wait()


def test_a_worker_of_a_local_cluster_that_dies_fails_its_own_task_alone(folder):
    (folder / "out").mkdir()
    with Cluster(FakeWorker, count=1) as engine:
        assert engine.room == 1
        first = engine.submit(task("a")).result(60).worker
        assert isinstance(engine.submit(task("kill")).exception(60), WorkerLost)
        assert engine.submit(task("b")).result(60).worker not in (first, str(os.getpid())), "another worker"
        assert engine.submit(task("fail")).result(60).lines == ("fail.glb: broken",)
    half, *whole = names(folder / "out")
    assert half.startswith(".pbr-viewer-") and whole == ["a.png", "b.png"], "only --retries says how often it is tried"


def test_a_scheduler_that_is_killed_ends_the_batch_with_a_line(scheduler, monkeypatch):
    wait_until(Path("scheduler.json").is_file, what="a scheduler")
    with Cluster(FakeWorker, scheduler_file="scheduler.json") as engine:
        first = engine.submit(task("a"))
        Path("wanted").touch()
        assert first.result(60).worker == str(scheduler.pid), "it waits for a worker"
        wait_until(lambda: engine.room == 1)
        waiting = engine.submit(task("wait"))
        wait_until(Path("waits").exists)
        address = json.loads(Path("scheduler.json").read_text())["address"]
        scheduler.kill()
        error = waiting.exception(60)
        assert isinstance(error, ClusterLost) and str(error).startswith(f"{address}: the scheduler is lost")
    assert Path("out/a.png").read_text() == "whole" and not Path("out/wait.png").exists()
