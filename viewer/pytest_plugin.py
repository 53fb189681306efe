"""The pytest plugin with the fixtures `golden` (compares a picture with a stored one) and `gl` (an OpenGL context).

pytest loads this module in every project where the package is installed, so nothing slow is imported at its top.
"""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from .base.expect import expect
from .errors import UsageError, ViewerError

if TYPE_CHECKING:
    import moderngl
    import numpy as np

    from .gpu.context import Context
    from .image.image import Image


_QUALITY = "PBR_VIEWER_QUALITY"
"""As `VARIABLE` of viewer/quality.py, which imports too much."""
_RUNS_TESTS = pytest.StashKey[bool]()
"""Whether this process is in charge of a session whose tests run."""


def pytest_configure(config: pytest.Config) -> None:
    """Draw drafts where no quality is named, in this process and those that it starts: which point a picture takes else
    depends on its size and on the version of this package, and stored pictures shall stay right."""
    if _QUALITY not in os.environ:
        os.environ[_QUALITY] = "draft"
        config.add_cleanup(_forget_quality)


def _forget_quality() -> None:
    os.environ.pop(_QUALITY, None)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("pbr-viewer", "golden images and OpenGL contexts (pbr-viewer)")
    group.addoption("--golden-update", action="store_true", help="store the test's pictures as new golden images")
    group.addoption("--golden-report", metavar="DIR",
                    help="folder for the page and pictures of failures (default: golden-failures in the root folder)")
    group.addoption("--gl-backend", choices=("auto", "egl", "osmesa", "window"), default="auto",
                    help="how the `gl` fixture opens OpenGL (default: auto)")


class Golden:
    """Compares pictures with golden images, which are stored in the folder `golden` beside the test's file."""

    def __init__(self, request: pytest.FixtureRequest) -> None:
        self._node = request.node.nodeid
        self._file = request.path
        self._update = request.config.getoption("--golden-update")
        self._report = _report_folder(request.config)
        self._calls = 0

    def __call__(self, picture: Image | np.ndarray, name: str | None = None, **limits: float | None) -> None:
        """Fails the test if `picture` differs from the golden image `name`.

        `picture` is an `Image`, or an array (H, W, 3 or 4) of displayed values (uint8) or linear ones (float). `name`
        is derived from the test by default. If it ends in .exr, radiance is compared; otherwise displayed values, with
        a PNG. `limits` are fields of `viewer.measure.compare.golden.Limits`: flip, maximum, rounding. Raises UsageError
        for other arguments.
        """
        __tracebackhide__ = True
        from .measure.compare.difference import not_finite
        from .measure.compare.golden import Failure, Limits, as_image, judge

        self._calls += 1
        if isinstance(picture, str):
            raise UsageError("golden(picture, name): the picture must be the first argument, and its name the second")
        image = as_image(picture)
        path = self.path(name)
        within = Limits.of(**limits)
        if self._update and not not_finite(image.linear):
            path.parent.mkdir(parents=True, exist_ok=True)
            image.save(path)
            return
        failure: Failure | None = judge(image, path, within, self._node)
        if failure is None:
            return
        folder = self._report / _slug(f"{self._node}-{self._calls}")
        failure.write(folder)
        pytest.fail(f"{path}: {failure.problem}\nlook at {folder}; if the picture is right, update the golden image:\n"
                    f"    pytest '{self._node}' --golden-update", pytrace=False)

    def path(self, name: str | None = None) -> Path:
        """The path of the golden image `name`. Raises UsageError for an invalid name, or one outside the folder."""
        __tracebackhide__ = True
        if name is None:
            name = f"{self._file.stem}-{_slug(self._node.partition('::')[2])}"
            name += f"-{self._calls}" if self._calls > 1 else ""
        expect(name, str, "name", "the name of a golden image")
        if not name or Path(name).is_absolute() or ".." in Path(name).parts:
            raise UsageError(f"{name!r} is not a name for a golden image beside the test")
        return self._file.parent / "golden" / (name if name.endswith((".png", ".exr")) else f"{name}.png")


class GL:
    """A new OpenGL context, which is current; `ctx` is its `moderngl.Context`."""

    def __init__(self, context: Context) -> None:
        self.context = context

    @property
    def ctx(self) -> moderngl.Context:
        return self.context.gl

    def call(self, file: str | Path, function: str, /, *, defines: Mapping[str, float] | None = None,
             **arrays: Any) -> Any:
        """Calls a GLSL function on `arrays` in this context; see `viewer.call_glsl`."""
        from .gpu.call import call_glsl

        __tracebackhide__ = True
        try:
            return call_glsl(file, function, defines=defines, context=self.context, **arrays)
        except ViewerError as error:  # its one line says everything: the frames of this package would bury it
            raise error.with_traceback(None) from None

    def check(self, picture: Image | np.ndarray) -> None:
        """Fails the test if a pixel is NaN or infinite, or if an OpenGL error is pending."""
        from .measure.compare.difference import not_finite
        from .measure.compare.golden import as_image

        __tracebackhide__ = True
        problem = not_finite(as_image(picture).linear)
        if problem:
            pytest.fail(problem, pytrace=False)
        self.check_errors()

    def check_errors(self) -> None:
        """Fails the test if an OpenGL error is pending. This is also checked at the end of every test with `gl`."""
        self.context.make_current()
        error = self.ctx.error
        if error != "GL_NO_ERROR":
            pytest.fail(f"an OpenGL error is pending: {error}", pytrace=False)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[..., None]:
    """`golden(picture, name=None, flip=0.005, maximum=0.5, rounding=2)`: see `Golden`."""
    return Golden(request)


@pytest.fixture
def gl(request: pytest.FixtureRequest) -> Iterator[GL]:
    """A new OpenGL context (`--gl-backend`) for this test only. The test fails if an OpenGL error is left pending."""
    from .errors import ContextError
    from .gpu.context import open_context

    try:
        context = open_context(request.config.getoption("--gl-backend"))
    except ContextError as error:
        pytest.fail(str(error), pytrace=False)
    with context:
        yield GL(context)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    # Checked here and not in the fixture's teardown, where it would be an error of a test that has passed.
    result = yield
    fixture = getattr(item, "funcargs", {}).get("gl")
    if isinstance(fixture, GL):
        fixture.check_errors()
    return result


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> None:
    # Not when the session starts: --fixtures, --collect-only and a test file that cannot be imported run no test.
    config = session.config
    broken = session.testsfailed and not config.option.continue_on_collection_errors
    if broken or config.option.collectonly or config.option.setuponly or not _in_charge(config):
        return
    from .measure.compare.golden_report import clear_report

    clear_report(_report_folder(config))
    config.stash[_RUNS_TESTS] = True


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    folder = _report_folder(config)
    if folder.is_dir() and config.stash.get(_RUNS_TESTS, False):
        from .measure.compare.golden_report import write_report

        page = write_report(folder)
        if page is not None:
            terminalreporter.write_line(f"golden images: expected, actual and difference are in {page}")


def _report_folder(config: pytest.Config) -> Path:
    given = config.getoption("--golden-report")
    return config.invocation_params.dir / given if given else config.rootpath / "golden-failures"


def _in_charge(config: pytest.Config) -> bool:
    """Whether this process writes the report. A worker of pytest-xdist does not; it only adds its failures."""
    return not hasattr(config, "workerinput")


def _slug(name: str) -> str:
    """`name` as a file name that is valid on every system, with at most 120 characters."""
    slug = re.sub(r"[^\w.]+", "-", name).strip("-.")
    return slug if len(slug) <= 120 else f"{slug[:111]}-{zlib.crc32(slug.encode()):08x}"
