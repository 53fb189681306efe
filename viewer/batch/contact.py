"""Contact sheets: a small picture of each of many models, in one file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ..base.atomic import made_folders, remove_leftovers, temporary_folder
from ..errors import InputError
from ..image.image import Image
from ..image.sheet import labelled_sheet
from ..jobs.outputs import model_names
from ..jobs.render_job import RenderJob, RenderTask
from .manifest import Manifest
from .run import Batch, render_all


def render_contact_sheet(models: Sequence[str], output: Path, columns: int, job: RenderJob, batch: Batch) -> int:
    """Make the pictures of all models, and write them as one with their names. Returns the exit status.

    The place of a model that cannot be rendered stays empty. The pictures lie in a folder beside `output` until then,
    where workers on other machines can write them, and to `resume` for good, with their manifest; one that is broken
    then, or of another size, is made again. Raises as `render_all`.
    """
    remove_leftovers(output.parent)
    with _kept_folder(output) if batch.resume else temporary_folder(output.parent) as folder:
        names = model_names(models)
        files = [folder / f"{name}.png" for name in names]
        _remove_broken(files, job.options["size"])
        tasks = [RenderTask(*each) for each in zip(models, files, strict=True)]
        status = render_all(tasks, job, replace(batch, folder=folder if batch.resume else None))
        with Manifest(folder) as manifest:
            failed = manifest.failed()  # of which there may be older pictures
        pictures = [Image.open(file).srgb if file.exists() and file not in failed else None for file in files]
        cells = [(name if picture is not None else f"{name}: not rendered", picture)
                 for name, picture in zip(names, pictures, strict=True)]
        labelled_sheet(cells, columns, job.options["size"]).save(output)
    return status


def _remove_broken(files: Sequence[Path], size: tuple[int, int]) -> None:
    for file in files:
        if not file.is_file():
            continue
        try:
            is_whole = Image.open(file).size == size
        except InputError:
            is_whole = False
        if not is_whole:
            file.unlink()


@contextmanager
def _kept_folder(output: Path) -> Iterator[Path]:
    folder = output.with_name(f"{output.name}.parts")
    with made_folders(folder):
        yield folder
