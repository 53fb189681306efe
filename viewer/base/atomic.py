"""Files that appear whole or not at all."""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from os import PathLike
from pathlib import Path

from ..errors import OutputError


@contextmanager
def atomic_write(path: str | PathLike[str]) -> Iterator[Path]:
    """Yields a temporary path with the same extension. If the block succeeds, the temporary file replaces `path`.

    The temporary file is in the same folder, so the last step is one rename. If any exception ends the block,
    KeyboardInterrupt included, the temporary file is removed and an older file at `path` stays as it was. A symbolic
    link at `path` stays a link. A pipe or device (`/dev/stdout`) gets the whole content at the end.

    Raises OutputError where the file cannot be written, and for every OSError inside the block.
    """
    target = Path(os.path.realpath(path))
    replaceable = target.is_file() or not target.exists()
    folder = target.parent if replaceable else Path(tempfile.gettempdir())
    if target.is_dir():
        raise OutputError(f"{path}: is a folder; a file name is needed")
    if not folder.is_dir():
        raise OutputError(f"{path}: the folder {target.parent} does not exist")
    temporary = folder / f"{_prefix()}{os.getpid()}-{os.urandom(4).hex()}{Path(path).suffix}"
    try:
        # mkstemp would make a file that only its owner may read; open() follows the user's umask.
        temporary.open("xb").close()
        yield temporary
        if replaceable:
            os.replace(temporary, target)
        else:
            with temporary.open("rb") as source, open(path, "wb") as sink:
                shutil.copyfileobj(source, sink)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def _prefix() -> str:
    """What the names of this machine's temporary files begin with; the number of their process follows."""
    machine = re.sub(r"[^\w.-]", "", platform.node(), flags=re.ASCII)
    return f".pbr-viewer-{machine[:64]}-"


def remove_leftovers(folder: Path) -> None:
    """Remove the temporary files and folders that processes of this machine, which were killed, have left in `folder`.
    """
    if os.name != "posix":  # where no signal only asks whether a process is there
        return
    name = re.compile(re.escape(_prefix()) + r"(\d+)-[0-9a-f]{8}(\.\w+)?")
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = name.fullmatch(entry.name)
            if found and not _is_running(int(found[1])):
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    with suppress(OSError):
                        os.unlink(entry.path)


@contextmanager
def temporary_folder(folder: Path) -> Iterator[Path]:
    """Yields a new folder in `folder`, which the end of the block removes with all that is in it.

    If the process is killed, `remove_leftovers` removes it. Raises OutputError where it cannot be made.
    """
    made = folder / f"{_prefix()}{os.getpid()}-{os.urandom(4).hex()}"
    make_folder(made)
    try:
        yield made
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # another user's
        return True
    return True


def write_json(path: str | PathLike[str], content: object) -> None:
    """Write `content` as a JSON file, whole or not at all. Raises OutputError."""
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    with atomic_write(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@contextmanager
def made_folders(*folders: Path) -> Iterator[None]:
    """Make those of the folders that do not exist, and what they lie in; at the end of the block, remove those of them
    that are empty.

    Raises OutputError, as `make_folder` does.
    """
    with ExitStack() as stack:
        for folder in folders:
            missing = [place for place in (folder, *folder.parents) if not place.exists()]
            for place in reversed(missing):
                make_folder(place)
                stack.callback(_remove_if_empty, place)
            make_folder(folder)
        yield


def _remove_if_empty(folder: Path) -> None:
    with suppress(OSError):
        folder.rmdir()


def make_folder(folder: Path) -> None:
    """Make `folder` if it does not exist; its parent must exist. Raises OutputError."""
    try:
        folder.mkdir(exist_ok=True)
    except FileNotFoundError as error:
        raise OutputError(f"{folder}: the folder {folder.parent} does not exist") from error
    except FileExistsError as error:
        raise OutputError(f"{folder}: is a file, not a folder") from error
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {error.strerror}") from error
