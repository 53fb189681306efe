"""The files that a window shows one after the other."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..errors import InputError
from ..scene.files import Stamp, noting_files
from ..scene.load import load_scene
from ..scene.model_files import MODEL_ENDINGS, models_in
from ..scene.scene import Scene


class ModelFiles:
    """The file that is shown, what it was made of, and those before and after it.

    `path` is the file of the scene that is shown at first, None if it has none. With `folder` the files are the models
    in it and in its folders, else those beside the file. `load` reads a file. `read` are the files of the scene, as
    `noting_files` has them.
    """

    def __init__(self, path: str | None = None, folder: str | None = None,
                 load: Callable[[str], Scene] = load_scene, read: Mapping[Path, Stamp] | None = None,
                 words: Callable[[str], Sequence[str]] = lambda path: ()) -> None:
        self.path = self.shown = path
        """The file whose place in the folder counts, and the one of the scene that is shown. Where the former cannot be
        read, the latter is the one before."""
        self.read: Mapping[Path, Stamp] = read or {}
        """The file and all that it refers to, as far as they were looked for, as they were before they were read."""
        self.words = words
        """The words of a command line that say how a file is read."""
        self._folder, self._load = folder, load

    def load(self, path: str) -> Scene:
        """The scene of another file, or of the same one again. Raises as `load_scene`; one goes on from there even
        so."""
        with noting_files() as found:
            try:
                scene = self._load(path)
            finally:
                self.path, self.read = path, found
        self.shown = path
        return scene

    def beside(self, step: int) -> str:
        """The file so many places after the one that is shown, in the order of names; after the last comes the first.

        Raises InputError if there is none.
        """
        if self.path is None:
            raise InputError("the scene", "", "it has no file, so there is none beside it")
        shown = Path(self.path)
        if self._folder is not None:
            files = models_in(Path(self._folder))
        else:
            files = sorted(file for file in shown.parent.iterdir() if file.suffix.lower() in MODEL_ENDINGS
                           and not file.name.startswith(".") and file.is_file())
        others = [file for file in files if os.path.abspath(file) != os.path.abspath(shown)]
        if not others:
            raise InputError(shown, "", "there is no other model in its folder")
        behind = [file for file in others if _place(file) > _place(shown)]
        ring = [*behind, *others[:len(others) - len(behind)]]
        return str(ring[step - 1 if step > 0 else step])


def _place(file: Path) -> list[tuple[bool, str]]:
    """What sorts files as `models_in` has them: in each folder its files before its folders, both by their names."""
    *folders, name = Path(os.path.abspath(file)).parts
    return [*((True, folder) for folder in folders), (False, name)]
