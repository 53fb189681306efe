"""One path-traced picture by several workers: each traces parts of its samples, and the picture is made here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

from ..base.atomic import write_json
from ..base.messages import say
from ..base.signals import Stopped
from ..jobs.assemble import make_settings
from ..jobs.directions import directions_of
from ..jobs.film import is_film
from ..jobs.part_renderer import PartRenderer
from ..jobs.render_job import RenderJob, RenderTask
from .run import Batch, do_parts
from .sums import parts_of


def is_in_parts(tasks: Sequence[RenderTask], job: RenderJob, batch: Batch) -> bool:
    """Whether there is but one picture, by paths, and workers that can share it. If only the picture is of a kind that
    cannot be shared, a line says why."""
    if len(tasks) != 1 or batch.is_here or is_film(tasks[0].output, job.options):
        return False
    settings, options = make_settings(job.options), job.options
    if job.chooses or settings.mode != "path" or len(parts_of(settings.most_spp)) == 1:
        return False
    why = ("--resume" if batch.resume else "--time-budget" if settings.time_budget is not None
           else "--error" if settings.error is not None else "caustics=photons" if settings.caustics != "off"
           else "--sheet" if options["sheet"] is not None else "--cameras" if options["cameras"] is not None
           else "--write-cameras" if options["write_cameras"] is not None
           else "several views" if len(directions_of(options)) > 1 else "")
    if why and batch.jobs != 1 and not options["quiet"]:
        say(f"{tasks[0].model}: with {why} one worker makes the picture: its samples are not shared")
    return not why


def render_in_parts(task: RenderTask, job: RenderJob, batch: Batch) -> int:
    """Make the picture, and write it; after a signal to stop, with the samples there are. Returns the exit status.
    Raises as `viewer.batch.run.render_all`, and Stopped if there are none."""
    started, settings = perf_counter(), make_settings(job.options)
    parts = [replace(task, samples=part) for part in parts_of(settings.most_spp)]
    run = do_parts(parts, job, batch)
    if run.stopped is not None and not run.sums.halves:
        raise Stopped(run.stopped)
    failed = [record for records in run.records.values() for record in records if "error" in record]
    if failed:
        record = failed[0]
    else:
        with PartRenderer(job) as renderer:
            record, = renderer.whole(task, run.sums.halves, run.stopped)
        times = record.get("wall_s")
        seconds = (times if isinstance(times, dict) else {}) | {"total": perf_counter() - started}
        record |= {"parts": len(parts), "wall_s": seconds}
    if batch.stats is not None:
        write_json(batch.stats, record)
    return 1 if "error" in record else 0 if run.stopped is None else Stopped(run.stopped).exit_status
