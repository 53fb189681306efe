"""A film by several workers: each renders parts of its frames, and the film is written here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count
from time import perf_counter

from ..base.atomic import write_json
from ..base.messages import say
from ..base.signals import Stopped
from ..image.film import write_film
from ..image.image import Image
from ..jobs.assemble import make_environment, make_scene
from ..jobs.film import is_film, make_film
from ..jobs.render_job import RenderJob, RenderTask
from .run import Batch, Run, do_parts

_FRAMES = 4
"""Of a part. Beginning one takes little, as the model is loaded but once by each worker."""


def is_film_in_parts(tasks: Sequence[RenderTask], job: RenderJob, batch: Batch) -> bool:
    """Whether there is but one film, and workers that can share it; what `--resume` asks for is one task."""
    return len(tasks) == 1 and not batch.is_here and not batch.resume and is_film(tasks[0].output, job.options)


def render_film_in_parts(task: RenderTask, job: RenderJob, batch: Batch) -> int:
    """Make the film, and write it; after a signal to stop, the frames up to the first that is missing. Returns the exit
    status. Raises as `viewer.batch.run.render_all`, InputError for a model that cannot be used, and Stopped if the
    first frame is missing."""
    started = perf_counter()
    film = make_film(task.model, task.output, make_scene(task.model, make_environment(job.options), job.options),
                     job.options)
    assert film is not None
    length = len(film.frames)
    parts = [replace(task, frames=range(first, min(first + _FRAMES, length))) for first in range(0, length, _FRAMES)]
    run = do_parts(parts, job, batch)
    failed = [record for records in run.records.values() for record in records if "error" in record]
    record: dict[str, object] = failed[0] if failed else {"model": task.model, "output": str(task.output)}
    if not failed:
        if run.stopped is not None and 0 not in run.frames:
            raise Stopped(run.stopped)
        written = write_film(task.output, _pictures(run), film.fps)
        record |= {"size": list(job.options["size"]), "frames": written, "parts": len(parts),
                   "wall_s": {"total": perf_counter() - started}}
        if run.stopped is not None:
            say(f"pbr-viewer: {task.output}: stopped after {written} of {length} frames")
    if batch.stats is not None:
        write_json(batch.stats, record)
    return 1 if failed else 0 if run.stopped is None else Stopped(run.stopped).exit_status


def _pictures(run: Run) -> Iterator[Image]:
    """The frames of all parts up to the first that is missing."""
    for number in count():
        if number not in run.frames:
            return
        yield from map(Image.from_srgb, run.frames.pop(number))
