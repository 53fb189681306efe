"""Running the command line inside the test's own process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from viewer import cli
from viewer.base.resources import resource_folder

SCENES = resource_folder("assets") / "scenes"


@dataclass(frozen=True)
class Outcome:
    status: int
    out: str
    err: str

    @property
    def error(self) -> str:
        """The one line that is on stderr."""
        lines = self.err.splitlines()
        assert len(lines) == 1 and self.err.endswith("\n"), self.err
        assert lines[0].startswith("pbr-viewer: ") and "Traceback" not in lines[0]
        return lines[0].removeprefix("pbr-viewer: ")


Run = Callable[..., Outcome]


def names(folder: Path) -> list[str]:
    """What lies in a folder."""
    return sorted(path.name for path in folder.iterdir())


def runner(capsys: pytest.CaptureFixture[str]) -> Run:
    """`run("render", model, ...)` as `pbr-viewer render model ...` would."""

    def run(*arguments: object) -> Outcome:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            cli.main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Outcome(ended.value.code or 0, captured.out, captured.err)

    return run
