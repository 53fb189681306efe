"""Names of files for libraries that take UTF-8 alone, where the file system takes any bytes."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike, fspath
from pathlib import Path


@contextmanager
def utf8_name(path: str | PathLike[str]) -> Iterator[str]:
    """A name, valid in the block, of the existing file `path`: its own, or a link's where its own is no UTF-8."""
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
