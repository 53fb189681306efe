"""Where tasks are done: in this process, or elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol, Self

from ..base.messages import say
from ..base.progress import Progress
from ..errors import ViewerError
from ..jobs.render_job import RenderJob, RenderTask
from .work import Done, Worker


class WorkerLost(ViewerError):
    """The worker has ended in the midst of a task; the text says how."""


class ClusterLost(ViewerError):
    """The scheduler has ended, or cannot be reached any more; the text says which."""


class Doer(Protocol):
    """What does tasks, one at a time: `viewer.batch.work.Worker`."""

    def do(self, task: RenderTask, progress: Progress, wants_to_stop: Callable[[], bool] = ...) -> Done: ...


class Engine(Protocol):
    """Does tasks. A `with` block ends its workers, and what they are doing then is given up."""

    @property
    def room(self) -> int:
        """How many tasks it takes at a time."""

    def submit(self, task: RenderTask) -> Future[Done]:
        """The future raises WorkerLost, or what `Worker.do` raises."""

    def finish(self) -> bool:
        """Let tasks with samples end with what they have, and take no more. Returns whether their futures will soon be
        done."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *exc: object) -> None: ...


class Here:
    """An `Engine` that does a task in this process, as soon as it is submitted."""

    room = 1

    def __init__(self, job: RenderJob, has_several: bool, progress: Progress) -> None:
        self._worker, self._progress = Worker(job, say), progress
        if has_several:
            self._worker.renderer.decode_environment()

    def expect(self, task: RenderTask) -> None:
        """Begin with the task that is submitted after the next one."""
        self._worker.renderer.expect(task)

    def submit(self, task: RenderTask) -> Future[Done]:
        future: Future[Done] = Future()
        future.set_result(self._worker.do(task, self._progress))
        return future

    def finish(self) -> bool:
        return True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self._worker.renderer.release()
