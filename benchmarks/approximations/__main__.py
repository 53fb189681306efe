"""The renderer's approximations beside their alternatives: `python -m benchmarks.approximations -o DIR`.

For each piece of the renderer (a table, a fit, a lookup) measures the error of every way to compute it over the range
of its parameters, and the time of one evaluation on this device. Prints a table and writes approximations.html (a page
that stands alone), approximations.json, and the charts as SVG and PNG into DIR.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from viewer.base.atomic import make_folder
from viewer.base.progress import Progress
from viewer.errors import ViewerError
from viewer.gpu.context import open_context

from .document import PIECES, Document, measure_pieces
from .page import write_approximations
from .table import print_table


def main(arguments: Sequence[str] | None = None) -> None:
    options = _parse(arguments)
    try:
        print_table(measure(options.output, options.backend, options.quiet))
    except ViewerError as error:
        sys.exit(f"error: {error}")


def measure(folder: Path, backend: str, quiet: bool) -> Document:
    """Measure all pieces and write the files; returns what approximations.json holds.

    Raises ContextError and OutputError.
    """
    make_folder(folder)
    with open_context(backend) as context, Progress(len(PIECES), enabled=not quiet) as progress:
        document = measure_pieces(context, progress=progress)
    write_approximations(folder, document)
    return document


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.approximations", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR",
                        help="where the files go; made where it is missing")
    parser.add_argument("--backend", choices=("auto", "egl", "osmesa"), default="auto",
                        help="the OpenGL context (auto)")
    parser.add_argument("--quiet", action="store_true", help="no progress line")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    main()
