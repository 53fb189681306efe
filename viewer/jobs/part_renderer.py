"""Renders parts of one picture, or of one film, whose other parts others may render."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.messages import say
from ..base.progress import Progress
from ..scene.scene import Scene
from .assemble import make_scene
from .film import Film, make_film
from .makers import PathMaker
from .model_renderer import ModelRenderer, Record
from .render_job import RenderJob, RenderTask
from .views import View, views_of

if TYPE_CHECKING:
    from ..trace.paths.part import Part


class PartRenderer(ModelRenderer):
    """As `ModelRenderer`. What was loaded for a part is kept, since the next one is of the same model, as a rule."""

    def __init__(self, job: RenderJob, tell: Callable[[str], None] = say) -> None:
        super().__init__(job, tell)
        self._scene: tuple[str, Scene, View] | None = None
        self._film_of: tuple[str, Scene, Film] | None = None

    def part(self, task: RenderTask, wants_to_stop: Callable[[], bool]) -> tuple[list[Record], Part | None]:
        """As `render`, for a task with samples: its record, and what was traced, perhaps not all of them once
        `wants_to_stop` is true. Nothing is written; `whole` tells the warnings."""
        self.may_pass = False
        records: list[Record] = []
        assert isinstance(self._maker, PathMaker) and task.samples is not None
        with self._told(task.model, task.picture(), records):
            if self._scene is None or self._scene[0] != task.model:
                scene = make_scene(task.model, self._environment, self._job.options)
                self._scene = task.model, scene, views_of(task.model, scene, self._job.options)[0]
            _, scene, view = self._scene
            self._request.size = view.size
            part = None if wants_to_stop() else self._maker.part(scene, view.camera, task.samples, wants_to_stop)
            return [{"model": task.model, "output": str(task.picture())}], part
        return records, None

    def whole(self, task: RenderTask, halves: Sequence[Part], stopped: int | None) -> list[Record]:
        """As `render`, for a picture whose samples have been traced in parts: the sums of `halves` are all of them, or,
        if the signal `stopped` has ended that, those there are."""
        assert isinstance(self._maker, PathMaker)
        self._maker.given, self._maker.given_stopped = halves, stopped
        return self.render(task, Progress(1, enabled=False))

    def frames(self, task: RenderTask) -> tuple[list[Record], np.ndarray | None]:
        """As `render`, for a task with frames: its record, and the displayed frames, (n, H, W, 4) uint8. Nothing is
        written."""
        self.may_pass = False
        records: list[Record] = []
        path, nowhere = task.picture(), Progress(1, enabled=False)
        assert task.frames is not None
        with self._told(task.model, path, records):
            if self._film_of is None or self._film_of[0] != task.model:
                scene = make_scene(task.model, self._environment, self._job.options)
                film = make_film(task.model, path, scene, self._job.options)
                assert film is not None
                self._film_of = task.model, scene, film
            _, scene, film = self._film_of
            self._choose_quality(scene, self._request.size)
            if task.frames.start == 0:
                self._warn(task.model, scene)
            part = replace(film, frames=film.frames[task.frames.start:task.frames.stop])
            pictures = np.stack([image.srgb for image in self._frames(scene, part, path, nowhere)])
            if task.frames.start == 0:
                self._warn_after(task.model, scene)
            return [{"model": task.model, "output": str(path)}], pictures
        return records, None
