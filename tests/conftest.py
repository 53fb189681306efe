"""Fixtures that any test may need."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

# As in viewer/__main__.py: numpy reads this once, so it stands before all that imports numpy. BLAS threads that wait
# for each other take the cores from the tests beside them.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# LLVM's compiling is most of what small pictures take Mesa's software rasteriser. Without LLVM's passes of optimisation
# the files that compile most take half to three quarters of the time, and those that draw most take no more. No bit
# of a picture differs: drivers/test_drivers.py.
os.environ.setdefault("GALLIVM_PERF", "nopt")

from command_line import Run, runner
from contexts import open_or_skip
from needs import in_words, require, skip

from viewer.gpu.context import Context

if TYPE_CHECKING:
    from viewer.raster.renderer import Renderer
    from viewer.trace.tracer import Tracer

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    # A shell has what it starts in the background ignore Ctrl-C; its tests, and the programs they start, hear it.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say in the last lines of the run what was not tested and for want of what."""
    skipped = terminalreporter.stats.get("skipped", [])
    if not skipped and not any(terminalreporter.stats.get(outcome) for outcome in ("passed", "failed", "error")):
        return  # nothing was run
    lines = in_words(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)

    def tell() -> None:
        for line in lines or ["every selected test had what it needs"]:
            terminalreporter.write_line(line)

    config.add_cleanup(tell)  # after pytest's own last line


@pytest.fixture(scope="session", autouse=True)
def shared_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tests leave the user's cache alone. All processes of a run share one, so that each bake is made once."""
    folder = tmp_path_factory.getbasetemp()
    if os.environ.get("PYTEST_XDIST_WORKER"):
        folder = folder.parent
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PBR_VIEWER_CACHE", str(folder / "cache"))
        yield


@pytest.fixture(scope="session")
def display() -> Iterator[str]:
    """A display to open windows on: a virtual one, so that nobody's desktop is disturbed, or else the desktop's."""
    require("display")
    if not sys.platform.startswith("linux") or not shutil.which("Xvfb"):
        yield os.environ.get("DISPLAY", "")
        return
    reading, writing = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[writing],
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()  # the server writes it when it is ready, or ends
    if not number:
        skip("display")
    desktop = {name: os.environ.pop(name) for name in ("DISPLAY", "WAYLAND_DISPLAY") if name in os.environ}
    os.environ["DISPLAY"] = f":{number}"
    yield os.environ["DISPLAY"]
    del os.environ["DISPLAY"]
    os.environ.update(desktop)
    server.terminate()
    server.wait()


@pytest.fixture(scope="module")
def context() -> Iterator[Context]:
    """One for all tests of a file."""
    with open_or_skip() as opened:
        yield opened


@pytest.fixture(scope="module")
def renderer(context: Context) -> Iterator[Renderer]:
    """One for all tests of a file."""
    from viewer.raster.renderer import Renderer  # here, since tests of readers need neither renderer

    renderer = Renderer(context)
    yield renderer
    renderer.release()


@pytest.fixture(scope="module")
def tracer(context: Context) -> Iterator[Tracer]:
    """One for all tests of a file."""
    from viewer.trace.tracer import Tracer

    tracer = Tracer(context)
    yield tracer
    tracer.release()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """`run("render", model, ...)` as `pbr-viewer render model ...` would, in this process."""
    return runner(capsys)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, empty."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
