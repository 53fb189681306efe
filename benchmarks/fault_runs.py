"""Batches that faults are to disturb: their models and folders, commands with all their processes, and what is asked of
the pictures in the end."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from viewer.batch.manifest import MANIFEST
from viewer.image.image import Image

from .shot import REPOSITORY

MODELS = "alpha", "clearcoat", "emissive", "glass", "normal-map", "textures", "two-sided", "vertex-colors"
FOLDERS = "a", "b", "c"
"""Each has all the models."""
VIEWS = "front", "top"
LOOK = ("--size", "64", "--quality", "draft", "--view", ",".join(VIEWS))
PATIENCE_S = 240.0

_HOOK = '''
import os, sys, time
from multiprocessing import parent_process

def hook(event, arguments):
    if event == "open" and isinstance(arguments[0], (str, os.PathLike)) and parent_process() is not None:
        name = os.path.basename(arguments[0])
        if name == "crash.glb":
            os.abort()
        if name == "slow.glb":
            time.sleep(float(os.environ["SLOW_S"]))

sys.addaudithook(hook)
'''
"""As `sitecustomize.py` on PYTHONPATH: workers crash when they read one model, and take long to read another."""


class Disturbed(Exception):
    """What was to happen did not."""


@dataclass
class Command:
    """A process in a session of its own, so that all that it starts can be found again, with its errors in a file."""

    words: Sequence[str]
    folder: Path
    name: str
    environment: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._told = self.folder / f"{self.name}.err"
        with self._told.open("wb") as told:
            environment = os.environ | {"PYTHONPATH": str(REPOSITORY)} | self.environment
            self.process = subprocess.Popen(self.words, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=told,
                                            stdin=subprocess.DEVNULL, env=environment, start_new_session=True,
                                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))

    @property
    def told(self) -> list[str]:
        return self._told.read_text(errors="replace").splitlines()

    def interrupt(self) -> None:
        """What Ctrl-C in a terminal does: all processes get the signal."""
        os.killpg(self.process.pid, signal.SIGINT)

    def end(self) -> int:
        """Its exit status, when it and all that it has started are gone."""
        status = self.process.wait(PATIENCE_S)
        wait_until(lambda: not in_session(self.process.pid), f"the end of all processes of {self.name}")
        return status

    def kill(self) -> None:
        """All that is left of it."""
        for process in in_session(self.process.pid):
            os.kill(process, signal.SIGKILL)
        self.process.wait()


class Case:
    """The folder of one run: models in `models`, pictures in `out`, and the commands that were started. `truth` has the
    pictures of each model that were made alone, and `slow_s` is what the slow model takes."""

    def __init__(self, folder: Path, truth: dict[str, np.ndarray], slow_s: float) -> None:
        self.folder, self.out, self.slow_s = folder, folder / "out", slow_s
        self._truth = truth
        self._wanted: dict[str, np.ndarray] = {}
        self.commands: list[Command] = []
        self.hook = folder / "hook"
        self.hook.mkdir(parents=True)
        (self.hook / "sitecustomize.py").write_text(_HOOK)
        for part in FOLDERS:
            (folder / "models" / part).mkdir(parents=True)
            for name in MODELS:
                self.add(f"{part}/{name}", name)

    def add(self, place: str, name: str) -> None:
        """A model at `place`, which is a copy of the model `name`."""
        shutil.copy(REPOSITORY / f"assets/scenes/{name}.glb", self.folder / "models" / f"{place}.glb")
        self._wanted |= {f"{place}_{view}.png": self._truth[f"{name}_{view}"] for view in VIEWS}

    def run(self, words: Sequence[str], name: str, **environment: str) -> Command:
        self.commands.append(Command(words, self.folder, name, environment))
        return self.commands[-1]

    def render(self, *way: str, name: str = "render", disturbed: bool = False) -> Command:
        environment = {"PYTHONPATH": f"{self.hook}:{REPOSITORY}", "SLOW_S": str(self.slow_s)} if disturbed else {}
        return self.run([sys.executable, "-m", "viewer", "render", "models", "-o", "out/", *LOOK, *way], name,
                        **environment)

    def close(self) -> None:
        """End what still runs."""
        for command in self.commands:
            command.kill()
        if self.out.is_mount():
            subprocess.run(["umount", str(self.out)], check=True)

    @property
    def lines(self) -> list[dict[str, str]]:
        try:
            text = (self.out / MANIFEST).read_text()
        except FileNotFoundError:
            return []
        return [json.loads(line) for line in text.splitlines(keepends=True) if line.endswith("\n")]

    def wait_for(self, count: int, command: Command) -> None:
        """Until the manifest has so many lines, while the command still runs."""
        wait_until(lambda: len(self.lines) >= count or command.process.poll() is not None, f"{count} pictures")
        if command.process.poll() is not None:
            raise Disturbed(f"the command has ended before it was disturbed: {command.told}")

    @property
    def last_worker(self) -> int:
        """The number of the process that made the last picture."""
        return int(self.lines[-1]["worker"].rpartition(":")[2])

    def wanted(self) -> set[str]:
        return set(self._wanted)

    def there(self) -> set[str]:
        """All files in the folder of the pictures; a file that is half written has another name than a picture."""
        found = (path for path in self.out.rglob("*") if not path.is_dir())
        return {path.relative_to(self.out).as_posix() for path in found} - {MANIFEST}

    def wrong_pictures(self) -> list[str]:
        """What is wrong with those that have the name of a picture: such as is there is whole at any time."""
        problems = []
        for name in sorted(self.there() & self.wanted()):
            try:
                same = np.array_equal(Image.open(self.out / name).srgb, self._wanted[name])
            except Exception as error:  # whatever it is, the picture is not whole
                problems.append(f"{name}: {error}")
                continue
            if not same:
                problems.append(f"{name}: differs from the one made alone")
        return problems

    def problems(self) -> list[str]:
        """What is wrong in the end, when all pictures are to be there."""
        wanted, there, lines = self.wanted(), self.there(), self.lines
        counts = Counter(line["out"] for line in lines if line["status"] == "done")
        return [*(f"{name}: is missing" for name in sorted(wanted - there)),
                *(f"{name}: is left over" for name in sorted(there - wanted)),
                *self.wrong_pictures(),
                *(f"{name}: stands {counts[name]} times in the manifest" for name in sorted(wanted)
                  if counts[name] != 1),
                *(f"{line['out']}: a line of the manifest that does not belong there" for line in lines
                  if line["out"] not in wanted or line["status"] != "done")]


def wait_until(condition: Callable[[], object], what: str, seconds: float = PATIENCE_S) -> None:
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise Disturbed(f"{what}: not within {seconds:g} s")
        time.sleep(0.02)


def in_session(session: int) -> list[int]:
    """The numbers of the processes of a session that still run."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, its_session = path.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(its_session) == session and state not in "ZX":
            found.append(int(path.parent.name))
    return found


def made_alone(folder: Path) -> dict[str, np.ndarray]:
    """The pictures of each model by a command of its own."""
    folder.mkdir()
    for name in MODELS:
        model = REPOSITORY / f"assets/scenes/{name}.glb"
        subprocess.run([sys.executable, "-m", "viewer", "render", str(model), "-o", f"{folder}/", *LOOK, "-q"],
                       check=True, cwd=folder, env=os.environ | {"PYTHONPATH": str(REPOSITORY)})
    return {path.stem: Image.open(path).srgb for path in folder.glob("*.png")}
