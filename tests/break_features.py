"""Proves the tests of single features: plants errors in a copy of the project, one at a time, and lists which fail.

    python tests/break_features.py [NAME...]

Of the tests that each error names (planted_errors.py) the first that fails is listed. Exits with status 1 where none
does. Takes minutes: no part of the test run.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mutations import try_all
from planted_errors import PLANTED_ERRORS, PlantedError

PROJECT = Path(__file__).resolve().parents[1]
_NEEDED = ("viewer", "shaders", "tests", "assets", "pyproject.toml", "README.md")


def first_that_fails(project: Path, error: PlantedError) -> list[str]:
    pytest = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
    run = subprocess.run([*pytest, *error.tests], cwd=project, env=os.environ | {"PYTHONPATH": str(project)},
                         capture_output=True, text=True)
    if run.returncode == 0:
        return []
    failed = [line.split()[1] for line in run.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return failed or [f"pytest ends with status {run.returncode}"]


def main(names: list[str]) -> int:
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder).resolve()
        for name in _NEEDED:
            copy = shutil.copytree if (PROJECT / name).is_dir() else shutil.copy
            copy(PROJECT / name, project / name)

        @contextmanager
        def planted(error: PlantedError) -> Iterator[None]:
            file = project / error.file
            whole = file.read_bytes()
            error.plant(project)
            try:
                yield
            finally:
                file.write_bytes(whole)

        return try_all(PLANTED_ERRORS, names, lambda error: first_that_fails(project, error), planted)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
