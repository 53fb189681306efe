"""The loop over the tasks of a batch."""

from __future__ import annotations

import json
import signal
from concurrent.futures import Future
from pathlib import Path
from typing import Self

import pytest

from viewer.base.progress import Progress
from viewer.base.signals import Stopped
from viewer.batch.engines import WorkerLost
from viewer.batch.manifest import Manifest
from viewer.batch.run import Attempt, Batch, Run, render_all
from viewer.batch.work import Done
from viewer.jobs.render_job import RenderJob, RenderTask


class AtOnce:
    """Tasks that end together, in any order; the first is stopped by Ctrl-C."""

    room = 20

    def __init__(self) -> None:
        self.models: list[str] = []

    def submit(self, task: RenderTask) -> Future[Done]:
        future: Future[Done] = Future()
        future.set_result(Done(({"model": task.model},), "", stopped=None if self.models else int(signal.SIGINT)))
        self.models.append(task.model)
        return future


def test_a_signal_is_kept_when_another_task_ends_at_the_same_time():
    run, engine = Run(RenderJob({"quiet": True}), Batch(), None), AtOnce()
    tasks = [RenderTask(f"{number}.glb", Path(f"{number}.png")) for number in range(2 * engine.room)]
    run.do([Attempt(number, task) for number, task in enumerate(tasks)], engine, Progress(len(tasks), enabled=False))
    assert run.stopped == signal.SIGINT
    assert len(engine.models) == len(run.records) == engine.room


class Interrupted:
    """Ctrl-C comes with the third task; while the engine ends, the first is done, and the second given up."""

    room = 20

    def __init__(self) -> None:
        self.futures: list[Future[Done]] = []

    def submit(self, task: RenderTask) -> Future[Done]:
        if len(self.futures) == 2:
            raise Stopped(signal.SIGINT)
        self.futures.append(Future())
        return self.futures[-1]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.futures[0].set_result(Done(({"model": "0.glb", "output": "0.png"},), ""))
        self.futures[1].set_exception(WorkerLost("given up"))


def test_what_is_done_while_ctrl_c_ends_the_others_has_a_line(folder, monkeypatch, capsys):
    monkeypatch.setattr("viewer.batch.run.make_engine", lambda *_: Interrupted())
    monkeypatch.setattr(Run, "_key", lambda self, task: task.model)
    tasks = [RenderTask(f"{number}.glb", Path(f"{number}.png")) for number in range(3)]
    with pytest.raises(Stopped):
        render_all(tasks, RenderJob({"quiet": False}), Batch(folder=Path(), jobs=2))
    assert [json.loads(line)["out"] for line in Path("manifest.jsonl").read_text().splitlines()] == ["0.png"]
    assert "1 of 3 models are rendered" in capsys.readouterr().err


def test_a_manifest_is_told_of_only_if_there_is_one(tmp_path, capsys):
    manifest = Manifest(tmp_path)
    run = Run(RenderJob({"quiet": False}), Batch(folder=tmp_path), manifest)
    run.tell(2)
    assert "0 of 2 models" in (told := capsys.readouterr().err) and "manifest" not in told
    manifest.path.write_text("")
    run.tell(2)
    assert f"{manifest.path} has a line for each picture, by which --resume goes on" in capsys.readouterr().err
