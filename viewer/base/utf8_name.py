"""UTF-8 file names for libraries that accept nothing else; a file system may allow names of any bytes."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike, fspath
from pathlib import Path


@contextmanager
def utf8_name(path: str | PathLike[str]) -> Iterator[str]:
    """A UTF-8 name of the existing file `path`: its own, or that of a temporary link that exists during the block."""
    name = fspath(path)
    try:
        name.encode()
    except UnicodeEncodeError:
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder, "file").with_suffix(Path(name).suffix)
            link.symlink_to(os.path.abspath(name))
            yield str(link)
    else:
        yield name
