"""What tests need of the machine beyond the package: the one rule by which they are skipped, and the words for it.

`@needs("xvfb")` skips a test, `require("xvfb")` the test or fixture that calls it. What was skipped, and for want of
what, stands in the last lines of the run (conftest.py).
"""

from __future__ import annotations

import os
import platform
import shutil
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import NoReturn

import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared"
"""Test models, and scenes that other renderers have solved, beside the checkout; they are not part of it."""
CORPUS = SHARED / "corpus"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
IS_LINUX = sys.platform.startswith("linux")


@dataclass(frozen=True)
class Need:
    """Words for what is tested with it, for what is missing, and for what to do about it."""

    tested: str
    missing: str
    fix: str = ""
    is_here: Callable[[], bool] | None = None
    """None where only trying it tells, as with OpenGL."""

    def reason(self) -> str:
        return f"{self.tested}: {self.missing}" + (f" ({self.fix})" if self.fix else "")


def _has_package(name: str) -> Callable[[], bool]:
    return lambda: find_spec(name) is not None


def _has_mitsuba() -> bool:
    from benchmarks import mitsuba_scene

    return mitsuba_scene.is_installed()


def _has_truth() -> bool:
    from benchmarks import truth_cases

    return bool(truth_cases.names())


NEEDS = {
    "opengl": Need("drawing", "no OpenGL 3.3 context opens", "`pbr-viewer doctor` tells why"),
    "egl": Need("drawing by EGL", "there is no EGL driver", "install libegl1 and libgl1-mesa-dri"),
    "osmesa": Need("drawing by OSMesa", "there is no OSMesa", "install libosmesa6; newer releases of Debian have none"),
    "window": Need("drawing in a window", "the display has no OpenGL 3.3", "install libgl1 and libgl1-mesa-dri"),
    "display": Need("windows", "there is no display, nor Xvfb to make one", "install xvfb",
                    lambda: not IS_LINUX or bool(shutil.which("Xvfb") or os.environ.get("DISPLAY"))),
    "xvfb": Need("windows that mouse and keyboard drive", "there is no Xvfb", "install xvfb",
                 lambda: shutil.which("Xvfb") is not None),
    "xdotool": Need("windows that mouse and keyboard drive", "there is no xdotool", "install xdotool",
                    lambda: shutil.which("xdotool") is not None),
    "chromium": Need("reports in a browser", "there is no Chromium", "install chromium",
                     lambda: any(map(shutil.which, BROWSERS))),
    "glslang": Need("programs under a second compiler", "there is no glslangValidator", "install glslang-tools",
                    lambda: shutil.which("glslangValidator") is not None),
    "llvmpipe": Need("drivers against one another", "EGL's driver is not Mesa's llvmpipe"),
    "softpipe": Need("drawing by softpipe", "this Mesa has none"),
    "zink": Need("drawing by Vulkan", "zink or lavapipe is missing", "install mesa-vulkan-drivers"),
    "embree": Need("rays traced by Embree", "embreex is not installed", "it is not built for every machine",
                   _has_package("embreex")),
    "formats": Need("3MF and COLLADA", "the packages for them are not installed", "pip install 'pbr-viewer[formats]'",
                    lambda: all(map(find_spec, ("collada", "lxml", "networkx")))),
    "cad": Need("STEP", "cascadio is not installed", "pip install 'pbr-viewer[cad]'", _has_package("cascadio")),
    "docs": Need("the site of the documentation", "MkDocs is not installed", "pip install 'pbr-viewer[docs]'",
                 lambda: all(map(find_spec, ("material", "mkdocs", "mkdocstrings")))),
    "batch": Need("pictures by a Dask cluster", "distributed is not installed", "pip install 'pbr-viewer[batch]'",
                  _has_package("distributed")),
    "film": Need("films in MP4", "PyAV is not installed", "pip install 'pbr-viewer[film]'", _has_package("av")),
    "oidn": Need("Intel's denoiser", "pyoidn is not installed", "pip install 'pbr-viewer[oidn]'",
                 _has_package("pyoidn")),
    "usd": Need("USD", "usd-core is not installed", "pip install 'pbr-viewer[usd]'", _has_package("pxr")),
    "notebook": Need("views in notebooks", "anywidget is not installed", "pip install 'pbr-viewer[notebook]'",
                     _has_package("anywidget")),
    "jupyterlab": Need("notebooks in JupyterLab", "it is not installed", "pip install jupyterlab",
                       _has_package("jupyterlab")),
    "serve": Need("the server for browsers", "websockets is not installed", "pip install 'pbr-viewer[serve]'",
                  _has_package("websockets")),
    "vdb": Need("OpenVDB files that Blosc compresses", "numcodecs is not installed", "pip install 'pbr-viewer[vdb]'",
                _has_package("numcodecs")),
    "mitsuba": Need("pictures against Mitsuba's", "Mitsuba, or the LLVM 19 or newer that it needs, is not installed",
                    "pip install 'pbr-viewer[truth]'", _has_mitsuba),
    "corpus": Need("models and environments of others", f"there is no {CORPUS}", "it is not part of the checkout",
                   lambda: (CORPUS / "INDEX.json").is_file()),
    "truth": Need("scenes that other renderers solved", f"there is no folder of them in {SHARED}",
                  "it is not part of the checkout", _has_truth),
    "linux": Need("what only Linux has", f"this is {platform.system()}", is_here=lambda: IS_LINUX),
    "posix": Need("signals, forks and terminals", f"this is {platform.system()}", is_here=lambda: os.name == "posix"),
    "glibc": Need("memory that the GNU C library keeps", "this system has another", is_here=lambda:
                  platform.libc_ver()[0] == "glibc"),
}


def needs(*names: str) -> pytest.MarkDecorator:
    """Skips the test, class or file that it marks where one of these is missing."""
    missing = next((NEEDS[name] for name in names if not _is_here(name)), None)
    return pytest.mark.skipif(missing is not None, reason=missing.reason() if missing else "")


def require(*names: str) -> None:
    """Skips the test, or those of the fixture, that calls it where one of these is missing."""
    for name in names:
        if not _is_here(name):
            skip(name)


def skip(name: str) -> NoReturn:
    """Skips the test that found this to be missing."""
    pytest.skip(NEEDS[name].reason())


def _is_here(name: str) -> bool:
    is_here = NEEDS[name].is_here
    assert is_here is not None, f"only trying it tells whether {name} is here"
    return is_here()


def in_words(reasons: Iterable[str]) -> list[str]:
    """A line for every reason for which tests were skipped, the commonest first."""
    counts: dict[str, int] = {}
    for reason in reasons:
        counts[reason] = counts.get(reason, 0) + 1
    return [f"not tested: {count} {'test' if count == 1 else 'tests'} of {reason}"
            for reason, count in sorted(counts.items(), key=lambda item: -item[1])]
