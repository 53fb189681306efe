"""One path-traced picture by several workers: each traces parts of its samples, and the sums are added here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

from ..base.atomic import write_json
from ..base.messages import say
from ..base.signals import Stopped
from ..image.image import Image
from ..jobs.assemble import make_settings
from ..jobs.directions import directions_of
from ..jobs.film import is_film
from ..jobs.render_job import RenderJob, RenderTask
from ..plan.warnings import sample_warnings
from ..settings import Settings
from .run import Batch, do_parts
from .sums import parts_of

if TYPE_CHECKING:
    import numpy as np


def is_in_parts(tasks: Sequence[RenderTask], job: RenderJob, batch: Batch) -> bool:
    """Whether there is but one picture, by paths, and workers that can share it. What needs more than the mean of all
    samples, as layers, denoising, photons, a shadow on the ground, a time or an error to reach do, is one task; so is
    what `--resume` asks for."""
    if len(tasks) != 1 or batch.is_here or batch.resume or job.chooses:
        return False
    settings, options = make_settings(job.options), job.options
    return (settings.mode == "path" and settings.denoise == "off" and settings.caustics == "off"
            and settings.ground == "off"
            and settings.time_budget is None and settings.error is None and not options["aov"]
            and options["sheet"] is None and options["cameras"] is None and options["write_cameras"] is None
            and len(directions_of(options)) == 1 and not is_film(tasks[0].output, options))


def render_in_parts(task: RenderTask, job: RenderJob, batch: Batch) -> int:
    """Make the picture, and write it. Returns the exit status. Raises as `viewer.batch.run.render_all`."""
    started, settings = perf_counter(), make_settings(job.options)
    parts = [replace(task, samples=part) for part in parts_of(settings.most_spp)]
    run = do_parts(parts, job, batch)
    if run.stopped is not None:
        raise Stopped(run.stopped)
    failed = [record for records in run.records.values() for record in records if "error" in record]
    record: dict[str, object] = failed[0] if failed else {"model": task.model, "output": str(task.output)}
    if not failed:
        assert run.sums.total is not None
        image = _developed(run.sums.total, settings, str(job.options["backend"]))
        image.save(task.output)
        count = round(float(run.sums.total[0, ..., 3].sum()))
        lost = settings.most_spp * image.size[0] * image.size[1] - count
        for warning in () if job.options["quiet"] else sample_warnings({"bad_samples": lost, "samples": count}):
            say(f"{task.model}: warning: {warning}")
        record |= {"size": list(image.size), "spp": settings.most_spp, "parts": len(parts),
                   "wall_s": {"total": perf_counter() - started}}
    if batch.stats is not None:
        write_json(batch.stats, record)
    return 1 if failed else 0


def _developed(total: np.ndarray, settings: Settings, backend: str) -> Image:
    """The picture of sums as `viewer.trace.paths.film.Film.read_sums` has them: rgb and the number of samples, and
    alpha in the last channel of the second."""
    import numpy as np

    from ..gpu.context import open_context
    from ..gpu.programs import Programs
    from ..image.displayed import displayed

    counts = np.maximum(total[0, ..., 3:], 1)
    linear = np.concatenate([total[0, ..., :3], total[1, ..., 3:]], axis=-1) / counts
    with open_context(backend) as context:
        image = displayed(context, Programs(context), linear.astype(np.float32), settings)
    clamped = {"clamped": f"indirect light to luminance {settings.clamp:g} (biased)"} if settings.clamp > 0 else {}
    return replace(image, attributes={"samples": f"{total[0, ..., 3].mean():g} a pixel"} | clamped)
