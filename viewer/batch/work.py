"""What a worker does: one task at a time, with the OpenGL context and the programs of the tasks before."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.atomic import remove_leftovers
from ..base.heap import share_one_heap
from ..base.progress import Progress
from ..jobs.model_renderer import Record
from ..jobs.part_renderer import PartRenderer
from ..jobs.render_job import RenderJob, RenderTask

if TYPE_CHECKING:
    from ..trace.paths.part import Part


@dataclass(frozen=True)
class Done:
    """What has become of a task: what `--stats` tells of each picture, the lines for the user that were not told yet,
    and the number of the signal that ended it early. `may_pass` says that another try may do what this one could not.
    `part` is that of a task with samples, and `frames` those of a task with frames.
    """

    records: tuple[Record, ...]
    worker: str
    lines: tuple[str, ...] = ()
    stopped: int | None = None
    may_pass: bool = False
    part: Part | None = None
    frames: np.ndarray | None = None


class Worker:
    """Does tasks of a job in this process. `tell` gets the lines for the user; without it they are in `Done`."""

    def __init__(self, job: RenderJob, tell: Callable[[str], None] | None = None) -> None:
        share_one_heap()
        self._lines: list[str] = []
        self.renderer = PartRenderer(job, tell or self._lines.append)
        self._name = f"{platform.node()}:{os.getpid()}"
        self._folders: set[Path] = set()

    def do(self, task: RenderTask, progress: Progress, wants_to_stop: Callable[[], bool] = lambda: False) -> Done:
        """A task with samples ends with those it has once `wants_to_stop` is true. Raises as `ModelRenderer.render`."""
        folder = task.output.parent
        if folder not in self._folders:
            self._folders.add(folder)
            remove_leftovers(folder)
        self._lines.clear()
        renderer, part, frames = self.renderer, None, None
        if task.samples is not None:
            found, part = renderer.part(task, wants_to_stop)
        elif task.frames is not None:
            found, frames = renderer.frames(task)
        else:
            found = renderer.render(task, progress)
        return Done(tuple(found), self._name, tuple(self._lines), renderer.stopped, renderer.may_pass, part, frames)
