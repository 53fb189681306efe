"""Tasks in processes that crash, are killed or take long: the others go on, and no file is left half written."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from concurrent.futures import Future, wait
from pathlib import Path

import pytest
from command_line import names
from fakes import FakeWorker
from needs import needs
from waiting import wait_until

from viewer.base.cores import core_count
from viewer.batch.engines import WorkerLost
from viewer.batch.processes import Processes, how_it_ended
from viewer.batch.work import Done
from viewer.errors import ContextError, InputError
from viewer.jobs.render_job import RenderTask

pytestmark = needs("posix")


def submitted(engine: Processes, *models: str) -> list[Future[Done]]:
    return [engine.submit(RenderTask(f"{model}.glb", Path(f"out/{model}.png"))) for model in models]


@pytest.fixture
def out(folder):
    (folder / "out").mkdir()
    return folder / "out"


def test_a_process_that_dies_fails_its_own_task_alone(out):
    with Processes(FakeWorker, 2) as engine:
        waiting, killed, *others = submitted(engine, "wait", "kill", "a", "b")
        assert [future.result().records[0]["output"] for future in others] == ["out/a.png", "out/b.png"]
        assert isinstance(killed.exception(), WorkerLost) and not waiting.done()
        Path("go").touch()
        assert waiting.result().worker != others[0].result().worker
    assert str(killed.exception()) == "the process that rendered it was killed (SIGKILL), perhaps for want of memory"
    assert how_it_ended(-signal.SIGSEGV) == "the process that rendered it has crashed (SIGSEGV)"
    assert how_it_ended(3) == "the process that rendered it has ended (exit status 3)"
    assert [name for name in names(out) if not name.startswith(".")] == ["a.png", "b.png", "wait.png"]
    assert all((out / name).read_text() == "whole" for name in ("a.png", "b.png", "wait.png"))


def test_what_is_in_progress_may_end_early_and_nothing_is_begun_after_it(out):
    with Processes(FakeWorker, 2) as engine:
        waiting, other = submitted(engine, "wait", "a")
        wait([other])
        wait_until(Path("waits").exists)
        assert not waiting.done() and engine.finish()
        assert waiting.result().records[0]["output"] == "out/wait.png" and not Path("go").exists()
        later, = submitted(engine, "b")
        assert isinstance(later.exception(), WorkerLost)
    assert (out / "wait.png").read_text() == "whole" and not (out / "b.png").exists()


@needs("linux")
def test_cores_are_those_that_a_container_leaves(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {3, 5, 7})
    monkeypatch.setattr("os.cpu_count", lambda: 64)
    assert core_count() == 3


def test_what_concerns_all_models_arrives_as_it_is_and_the_end_gives_up_what_is_in_progress(out):
    before = threading.active_count()
    with Processes(FakeWorker, 1) as engine:
        context, failed, broken, done = submitted(engine, "context", "fail", "input", "a")
        wait([done])
        assert isinstance(context.exception(), ContextError) and failed.result().lines == ("fail.glb: broken",)
        assert str(broken.exception()) == "env.hdr: line 1: is broken" and type(broken.exception()) is InputError
        assert done.result().worker == failed.result().worker, "the process goes on"
        running, pending = submitted(engine, "wait", "b")
        wait_until(Path("waits").exists)
    assert isinstance(running.exception(), WorkerLost) and pending.cancelled()
    assert names(out) == ["a.png"] and threading.active_count() == before
    assert multiprocessing.active_children() == []


def test_a_process_that_python_lets_miss_its_end_is_told_again(out):
    with Processes(FakeWorker, 1) as engine:
        running, = submitted(engine, "deaf")
        wait_until(Path("waits").exists)
    assert str(running.exception()) == "the process that rendered it has ended (exit status 0)"
    assert names(out) == []
