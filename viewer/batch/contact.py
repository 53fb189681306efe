"""Contact sheets: a small picture of each of many models, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.atomic import remove_leftovers, temporary_folder
from ..image.image import Image
from ..image.sheet import labelled_sheet
from ..jobs.outputs import model_names
from ..jobs.render_job import RenderJob, RenderTask
from .run import Batch, render_all


def render_contact_sheet(models: Sequence[str], output: Path, columns: int, job: RenderJob, batch: Batch) -> int:
    """Make the pictures of all models, and write them as one with their names. Returns the exit status.

    The place of a model that cannot be rendered stays empty. The pictures lie in a folder beside `output` until then,
    where workers on other machines can write them. Raises as `render_all`.
    """
    remove_leftovers(output.parent)
    with temporary_folder(output.parent) as folder:
        names = model_names(models)
        files = [folder / f"{name}.png" for name in names]
        status = render_all([RenderTask(*each) for each in zip(models, files, strict=True)], job, batch)
        cells = [(name if file.exists() else f"{name}: not rendered", Image.open(file).srgb if file.exists() else None)
                 for name, file in zip(names, files, strict=True)]
        labelled_sheet(cells, columns, job.options["size"]).save(output)
    return status
