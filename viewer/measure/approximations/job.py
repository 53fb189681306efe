"""`pbr-viewer report --approximations`."""

from __future__ import annotations

from pathlib import Path

from ...base.atomic import make_folder
from ...base.progress import Progress
from ...gpu.context import open_context
from .document import PIECES, Document, measure_pieces
from .page import write_approximations


def report_approximations(folder: Path, backend: str = "auto", quiet: bool = False) -> Document:
    """Measure all pieces and write approximations.json, approximations.html and the charts; returns what JSON holds.

    Raises ContextError and OutputError.
    """
    make_folder(folder)
    with open_context(backend) as context, Progress(len(PIECES), enabled=not quiet) as progress:
        document = measure_pieces(context, progress=progress)
    write_approximations(folder, document)
    return document
