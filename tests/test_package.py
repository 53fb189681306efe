"""What `import viewer` offers."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import viewer


@pytest.mark.parametrize("name", viewer.__all__)
def test_every_promised_name_is_there(name):
    assert getattr(viewer, name).__name__ == name


def test_a_wrong_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'lode'"):
        viewer.lode  # noqa: B018


HEAVY = {"DracoPy", "OpenImageIO", "PIL", "asyncio", "click", "dataclasses", "flip_evaluator", "glfw", "imgui_bundle",
         "inspect", "moderngl", "numpy", "platformdirs", "pyrr", "rich", "trimesh"}
OF_PICTURES = HEAVY - {"PIL", "click", "dataclasses", "inspect", "moderngl", "numpy", "platformdirs"}


def imported_by(code: str, home: Path) -> set[str]:
    """The modules in a process that runs `code` and may end by `SystemExit`."""
    code = f"import sys\ntry:\n    {code}\nexcept SystemExit: pass\nprint(*sys.modules, sep=chr(10), file=sys.stderr)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=home)
    return set(shown.stderr.splitlines())


def test_importing_it_imports_nothing_heavy(tmp_path):
    found = imported_by("import viewer", tmp_path)
    assert "viewer" in found and HEAVY & found == set()


def test_the_list_of_commands_imports_click_and_no_command(tmp_path):
    found = imported_by("from viewer import cli; cli.main(['--help'])", tmp_path)
    assert (HEAVY - {"click", "inspect"}) & found == set()  # click imports inspect
    assert {name for name in found if name.startswith("viewer.")} == {
        "viewer.base", "viewer.base.heap", "viewer.base.messages", "viewer.base.signals", "viewer.cli",
        "viewer.commands", "viewer.commands.lazy", "viewer.commands.output", "viewer.errors"}


def test_the_help_of_a_command_imports_what_its_options_need(tmp_path):
    found = imported_by("from viewer import cli; cli.main(['render', '--help'])", tmp_path)
    assert (HEAVY - {"click", "inspect", "dataclasses"}) & found == set()
    assert {name for name in found if name.startswith("viewer.commands.")} == {
        "viewer.commands.lazy", "viewer.commands.output", "viewer.commands.pictures"}


def test_a_plain_picture_imports_nothing_that_other_pictures_need(tmp_path):
    model = Path(__file__).parents[1] / "assets" / "scenes" / "spheres.glb"
    found = imported_by(f"from viewer import cli; cli.main(['render', {str(model)!r}, '-o', 'a.png', '--size', '8'])",
                        tmp_path)
    assert (tmp_path / "a.png").exists() and "viewer.raster.renderer" in found
    others = {"PIL.ImageDraw", "importlib.metadata", "multiprocessing", "numpy.random", "numpy.testing", "ssl",
              "urllib.request", "viewer.batch.contact", "viewer.batch.keys", "viewer.batch.processes",
              "viewer.image.sheet", "xml.sax"}
    assert (OF_PICTURES | others) & found == set()
    assert [name for name in found if name.startswith("viewer.trace")] == []


def test_the_end_is_that_of_python():
    """Threads are waited for, then functions that are registered for it are called, what was printed is written, and
    the status is that of main."""
    code = """
import atexit, threading, time
from viewer.__main__ import main
atexit.register(print, "the last", end="")
threading.Thread(target=lambda: time.sleep(0.5) or print("a thread,", end=" ")).start()
main()
"""
    for words, status in (("--help", 0), ("--halp", 2)):
        done = subprocess.run([sys.executable, "-c", code, words], capture_output=True, text=True)
        assert (done.returncode, done.stdout[-18:]) == (status, "a thread, the last")


def test_no_library_tells_of_leaks_at_the_end():
    """Modules made by nanobind, such as OpenImageIO, do where Python does not free their types."""
    code = "import sys, OpenImageIO\nfrom viewer.__main__ import main\nsys.argv[1:] = ['--help']\nmain()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == "" and "Commands" in done.stdout
