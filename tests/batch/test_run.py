"""The loop over the tasks of a batch."""

from __future__ import annotations

import signal
from concurrent.futures import Future
from pathlib import Path

from viewer.base.progress import Progress
from viewer.batch.run import Attempt, Batch, Run
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
