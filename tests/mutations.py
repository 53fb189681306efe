"""Mutation testing: an error is planted in a copy of the shaders or of the project, for tests to notice."""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import viewer.gpu.source
from viewer.base.resources import resource_folder
from viewer.errors import ShaderError


@dataclass(frozen=True)
class Mutation:
    """`old`, which `file` holds exactly once, becomes `new`."""

    name: str
    file: str
    old: str
    new: str

    def check(self, folder: Path) -> None:
        """Raises LookupError where the file in `folder` does not hold `old` exactly once."""
        count = (folder / self.file).read_text(encoding="utf-8").count(self.old)
        if count != 1:
            raise LookupError(f"{self.name}: {folder.name}/{self.file} holds {self.old!r} {count} times, not once")

    def plant(self, folder: Path) -> None:
        """Change the file in `folder`. Raises LookupError as `check` does."""
        self.check(folder)
        path = folder / self.file
        path.write_text(path.read_text(encoding="utf-8").replace(self.old, self.new), encoding="utf-8")


AnyMutation = TypeVar("AnyMutation", bound=Mutation)


@contextmanager
def planted(mutation: Mutation) -> Iterator[None]:
    """Programs that are assembled in this block come from shaders with the mutation. Raises LookupError."""
    real = viewer.gpu.source.resource_folder
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve() / "shaders"
        shutil.copytree(resource_folder("shaders"), copy)
        mutation.plant(copy)
        viewer.gpu.source.resource_folder = lambda name: copy if name == "shaders" else real(name)
        try:
            yield
        finally:
            viewer.gpu.source.resource_folder = real


def try_all(mutations: Sequence[AnyMutation], names: Sequence[str],
            noticed_by: Callable[[AnyMutation], Sequence[str]],
            plant: Callable[[AnyMutation], AbstractContextManager[None]] = planted) -> int:
    """Plant each mutation whose name contains one of `names` (all of them where that is empty), and print by what each
    is noticed. Returns an exit status: 1 where one goes unnoticed or does not compile."""
    status = 0
    print("| mutation | noticed by |\n|---|---|")
    for mutation in mutations:
        if names and not any(name in mutation.name for name in names):
            continue
        try:
            with plant(mutation):
                found = noticed_by(mutation)
        except ShaderError as error:
            print(f"{mutation.name}: {error}", file=sys.stderr)
            return 1
        print(f"| {mutation.name} | {_listed(found)} |", flush=True)
        status = status if found else 1
    return status


def _listed(names: Sequence[str], most: int = 8) -> str:
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + rest or "NONE"
