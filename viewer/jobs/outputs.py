"""Where the pictures of models go, and whether they can be written there."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import OutputError, UsageError
from ..image.film import FILM_FORMATS
from ..image.image import LINEAR_WRITABLE, WRITABLE
from ..settings import Settings


@dataclass(frozen=True)
class Outputs:
    """The file of each model's picture, and the folders to make for them where they are missing."""

    paths: tuple[Path, ...]
    folders: tuple[Path, ...]


def output_paths(models: Sequence[str], output: str, option: str = "-o") -> Outputs:
    """A picture is OUT itself, OUT with {name} replaced, or OUT/name.png if OUT is a folder or ends in "/".

    The name is that of the model's file without its ending. Models of the same name have their folders before it, from
    the folder on in which all of them are: chair/scene and lamp/scene. Raises UsageError for a path that is not a
    picture's or that two models have; it names the `option` of `output`.
    """
    if "{name}" in output:
        paths = [Path(output.replace("{name}", name)) for name in model_names(models)]
    elif output.endswith(("/", "\\")) or Path(output).is_dir():
        paths = [Path(output) / f"{name}.png" for name in model_names(models)]
    elif len(models) > 1:
        raise UsageError(f"{option} {output}: several models need a folder, {output}/, or a pattern with {{name}}")
    else:
        paths = [Path(output)]
    for path in paths:
        if path.suffix.lower() not in (*WRITABLE, *FILM_FORMATS):
            raise UsageError(f"{option} {path}: the name of a picture must end in one of {', '.join(WRITABLE)}; that "
                             f"of a film in one of {', '.join(FILM_FORMATS)}; that of a folder in /")
    twice = sorted(str(path) for path, count in Counter(paths).items() if count > 1)
    if twice:
        raise UsageError(f"{option} {output}: several models would be written to {', '.join(twice)}")
    return Outputs(tuple(paths), tuple(dict.fromkeys(_without_views(path.parent) for path in paths)))


def _without_views(folder: Path) -> Path:
    """The folder in which folders of views are."""
    while "{view}" in str(folder):
        folder = folder.parent
    return folder


def base_folder(output: str) -> Path:
    """The folder that all pictures of OUT are in, or folders of."""
    fixed = re.split(r"\{name\}|\{view\}", output)[0]
    if fixed == output and Path(output).is_dir():
        return Path(output)
    return Path(fixed) if fixed.endswith(("/", "\\")) else Path(fixed).parent


def model_names(models: Sequence[str]) -> list[str]:
    """A name for each model, all of them different. Models of one name in one folder have their endings, too."""
    names = [Path(model).stem for model in models]
    counts = Counter(names)
    shared: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        if counts[name] > 1:
            shared.setdefault(name, []).append(k)
    for name, members in shared.items():
        folders = [os.path.dirname(os.path.abspath(models[k])) for k in members]
        common, here = os.path.commonpath(folders), Counter(folders)
        for k, folder in zip(members, folders):
            own = Path(models[k]).name if here[folder] > 1 else name
            names[k] = Path(os.path.relpath(folder, common), own).as_posix()
    return names


def check_layers(names: Sequence[str], settings: Settings, paths: Sequence[Path], chooses: bool = False) -> None:
    """Raises UsageError for layers that the mode does not make or that a file cannot store.

    With `chooses`, a method that makes the layers is chosen.
    """
    if not chooses:
        settings.check_layers(names)
    other = [path for path in paths if path.suffix.lower() not in LINEAR_WRITABLE]
    if names and other:
        raise UsageError(f"--aov with -o {other[0]}: only {' and '.join(LINEAR_WRITABLE)} can store layers")


def check_apart(paths: Sequence[str | Path]) -> None:
    """Raises UsageError if two of these files are one."""
    counts = Counter(os.path.abspath(path) for path in paths)
    for path in paths:
        if counts[os.path.abspath(path)] > 1:
            raise UsageError(f"{path}: two outputs would be written to one file")


def check_output(path: str | Path) -> None:
    """Raises OutputError if `path` cannot be written, before any work is done for it. Folders of views are made later.
    """
    path = Path(path)
    if "{view}" in str(path.parent):
        return
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; a file name is needed")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: the folder {path.parent} does not exist")
