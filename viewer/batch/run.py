"""Does the tasks of a render job, one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.atomic import write_json
from ..base.progress import Progress
from ..base.signals import Stopped
from ..jobs.model_renderer import ModelRenderer, Record
from ..jobs.render_job import RenderJob, RenderTask


def render_all(tasks: Sequence[RenderTask], job: RenderJob, stats: str | None = None) -> int:
    """Make the pictures of all models. Returns the exit status: 0, or 1 if some picture could not be made.

    A model that cannot be rendered is reported on stderr, and the others are still rendered. `stats` names a JSON file
    for the times, plan and memory, or the error, of each picture. A signal that ends a picture early ends the job, too;
    the exit status is then the shell's for that signal. Raises ContextError and UsageError, which concern all models.
    """
    records: list[Record] = []
    stopped: int | None = None
    with Progress(len(tasks), enabled=not job.options["quiet"]) as progress, ModelRenderer(job) as renderer:
        if len(tasks) > 1:
            renderer.decode_environment()
        for task in tasks:
            records += renderer.render(task, progress)
            stopped = renderer.stopped
            if stopped is not None:
                break
    if stats is not None:
        write_json(stats, records[0] if len(tasks) == len(records) == 1 else records)
    if stopped is not None:
        return Stopped(stopped).exit_status
    return 1 if any("error" in record for record in records) else 0
