"""Keys of pictures: digests of all that they are made from, by which a later run knows what need not be made again."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any
from xml.sax.saxutils import unescape

from ..base.digest import digest
from ..errors import InputError
from ..jobs.render_job import RenderJob
from ..scene.files import path_inside, read_file
from ..scene.gltf.container import read_container
from ..scene.mtl import files_named

_NOT_SEEN = frozenset(("quiet", "verbose", "no_cache", "backend", "error_map", "write_cameras"))
"""Options that change no pixel, or only where they are computed."""
_COLLADA_IMAGE = re.compile(rb"<(?:\w+:)?init_from\s*>\s*(?:<(?:\w+:)?ref\s*>\s*)?([^<]+?)\s*</")
_PLY_IMAGE = re.compile(rb"^\s*comment\s+texturefile\s+(.+?)\s*$", re.MULTILINE | re.IGNORECASE)


class Keys:
    """The keys of the models of a job."""

    def __init__(self, job: RenderJob) -> None:
        options = {name: value for name, value in sorted(job.options.items()) if name not in _NOT_SEEN}
        files = [_content(path) for path in _named_files(options)]
        self._common = digest(version("pbr-viewer"), options, job.chooses, files)

    def of(self, model: str, out: str) -> str:
        """The digest of the model's file, of the files that it names, of all options, of the files that these name, of
        the version of this package, and of the picture's name `out`."""
        return digest(self._common, out, [_content(path) for path in (Path(model), *_referred(Path(model)))])


def _content(path: Path) -> str:
    """A digest of the file; "" if it cannot be read, which whoever needs it will say. A pipe would be waited for."""
    if not _is_file(path):
        return ""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()
    except (OSError, ValueError):
        return ""


def _named_files(value: Any) -> Iterator[Path]:
    """The files that options name: as a whole, or as a setting's value (`weave=FILE.json,MATERIAL`)."""
    if isinstance(value, str):
        for text in (value, value.partition("=")[2].split(",")[0]):
            if text and _is_file(Path(text)):
                yield Path(text)
    elif isinstance(value, dict):
        for part in value.values():
            yield from _named_files(part)
    elif isinstance(value, (list, tuple)):
        for part in value:
            yield from _named_files(part)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _referred(model: Path) -> Iterator[Path]:
    """The files that a glTF file, an OBJ, a PLY or a COLLADA file names and that are in its folder. Of a broken one
    there are none."""
    try:
        if model.suffix.lower() in (".gltf", ".glb"):
            root = read_container(model, read_file(model))[0]
            parts = [part for name in ("buffers", "images") for part in root.get(name, ())]
            names = [part["uri"] for part in parts if isinstance(part, dict) and isinstance(part.get("uri"), str)]
            yield from _inside(model, [name for name in names if not name.startswith("data:")])
        elif model.suffix.lower() == ".obj":
            yield from files_named(model, read_file(model))
        elif model.suffix.lower() == ".ply":
            header = read_file(model).partition(b"end_header")[0]
            yield from _inside(model, map(_text, _PLY_IMAGE.findall(header)))
        elif model.suffix.lower() == ".dae":
            yield from _inside(model, (unescape(_text(name)) for name in _COLLADA_IMAGE.findall(read_file(model))))
    except (InputError, TypeError):
        return


def _inside(model: Path, names: Any) -> Iterator[Path]:
    for name in names:
        try:
            yield path_inside(model, name.replace("\\", "/"), "")
        except InputError:
            continue


def _text(name: bytes) -> str:
    return name.decode("utf-8", errors="surrogateescape")
