"""`viewer.show` in a notebook: without a kernel, by the messages of the widget; and in a real JupyterLab."""

from __future__ import annotations

import asyncio
import base64
import io
import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from browser import Browser, find_browser
from command_line import SCENES
from needs import needs, require
from PIL import Image as Pillow
from waiting import PATIENCE_S, wait_until

import viewer
from viewer.gpu.context import open_context
from viewer.settings import Settings
from viewer.web import cell
from viewer.web.view import RemoteView

MODEL = SCENES / "spheres.glb"
SIZE = (64, 48)
ROOT = Path(__file__).resolve().parents[2]
PLACE = {"x": 32, "y": 24, "width": 64, "height": 48}


@pytest.fixture(scope="module")
def scene():
    return viewer.load(MODEL)


@pytest.fixture
def make(scene, monkeypatch):
    """`make()` is a widget of its own view; what it sends to its places stands in its list `sent`."""
    require("notebook")
    from viewer.web import notebook

    made = []
    monkeypatch.setattr(notebook, "_awake", [])

    def make_one():
        settings = Settings(antialias="none", background=(0.2, 0.2, 0.2))
        widget = notebook.NotebookView(RemoteView(open_context, scene, settings, most=SIZE))
        sent: list[tuple[dict[str, Any], list[bytes] | None]] = []
        monkeypatch.setattr(widget, "send", lambda content, buffers=None: sent.append((content, buffers)))
        made.append(widget)
        return SimpleNamespace(widget=widget, sent=sent, view=widget._audience.view)

    yield make_one
    for widget in made:
        widget.sleep()


def tell(made: Any, place: str, **message: Any) -> None:
    made.widget._handle_custom_msg({"view": place, "message": message}, [])


async def until(condition: Callable[[], object], *shown: tuple[Any, str]) -> None:
    """Let these places show what they are sent until the condition holds."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end
        for made, place in shown:
            tell(made, place, kind="shown")
        await asyncio.sleep(0.01)


def pixels(encoded: bytes) -> np.ndarray:
    return np.asarray(Pillow.open(io.BytesIO(encoded)).convert("RGB")).astype(int)


def test_each_place_is_sent_pictures_and_steers_and_what_is_held_is_freed_when_all_have_gone(make, monkeypatch):
    made = make()
    before, azimuth = pixels(made.view.encoded(lossless=True)), made.view.orbit.azimuth

    def pictures(place: str) -> list[bytes]:
        return [buffers[0] for content, buffers in made.sent if content["view"] == place and buffers]

    async def look() -> None:
        for place in ("a", "b"):
            tell(made, place, kind="hello")
            tell(made, place, kind="size", width=64, height=48)
        await until(lambda: pictures("a") and pictures("b"))
        tell(made, "b", kind="press", is_left=True, shift=False, **PLACE)
        tell(made, "b", kind="move", **(PLACE | {"x": 44}))
        tell(made, "b", kind="release", is_left=True, shift=False, **(PLACE | {"x": 44}))
        await until(lambda: len(pictures("a")) > 2 and pictures("a")[-1][:4] == b"\x89PNG", (made, "a"))
        for wrong in ({}, {"view": 1, "message": {}}, {"view": "a", "message": "x"}):
            made.widget._handle_custom_msg(wrong, [])
        tell(made, "a", kind="key", key=5)
        tell(made, "a", kind="bye")
        assert made.view.is_awake
        tell(made, "b", kind="bye")
        await until(lambda: not made.view.is_awake)
        tell(made, "c", kind="size", width=64, height=48)  # looked at again
        await until(lambda: pictures("c"))
        assert pictures("c")[-1] in pictures("a")[1:]
        monkeypatch.setattr(made.view, "step", fail)
        tell(made, "c", kind="shown")
        await until(lambda: not made.view.is_awake)
        assert made.sent[-1][0]["words"] == {"message": "a.glb: images[0]: is broken", "isError": True}

    def fail() -> None:
        raise viewer.InputError("a.glb", "images[0]", "is broken")

    asyncio.run(look())
    assert made.view.orbit.azimuth == pytest.approx(azimuth - np.pi / 4)
    assert np.abs(pixels(pictures("a")[-1]) - before).mean() > 10


def test_views_that_nobody_has_looked_at_for_long_free_what_they_hold(make, monkeypatch):
    monkeypatch.setattr("viewer.web.notebook.MOST_AWAKE", 1)
    first = make()

    async def look() -> None:
        tell(first, "a", kind="size", width=64, height=48)
        await until(lambda: first.sent)
        second = make()
        await until(lambda: not first.view.is_awake)  # at the end of what it was doing
        assert second.view.is_awake
        make()
        assert not second.view.is_awake

    asyncio.run(look())


@pytest.fixture
def in_kernel(monkeypatch):
    kernel = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: kernel))


def test_show_gives_a_widget_with_a_still_for_where_widgets_are_not(scene, monkeypatch):
    require("notebook")
    from viewer.web import notebook

    monkeypatch.setattr(cell, "in_notebook", lambda: True)
    monkeypatch.setattr(notebook, "_awake", [])
    widget = viewer.show(scene, SIZE, background="#336699", mode="phong")
    assert isinstance(widget, notebook.NotebookView)
    data, _ = widget._repr_mimebundle_()
    widget.sleep()
    assert data["application/vnd.jupyter.widget-view+json"]["model_id"] == widget.model_id
    still = pixels(base64.b64decode(data["image/jpeg"]))
    right, other = (viewer.render(scene, SIZE, background="#336699", mode=mode).srgb[..., :3].astype(int)
                    for mode in ("phong", "pbr"))
    assert np.abs(still - right).mean() < 6 < np.abs(still - other).mean()
    assert "panel" not in json.dumps(widget.config["help"]).lower() and "8" in widget.config["keys"]
    with pytest.raises(viewer.UsageError, match="oidn takes too long"):
        viewer.show(scene, SIZE, denoise="oidn")


def test_without_its_package_show_gives_a_picture_and_says_once_what_turns(scene, in_kernel, monkeypatch, capsys):
    monkeypatch.setattr(cell, "find_spec", lambda name: None)
    cell._say_what_turns.cache_clear()
    for _ in range(2):
        assert viewer.show(scene, SIZE, background="none").size == SIZE
    line = "This picture stands still. pip install 'pbr-viewer[notebook]' makes it one that turns.\n"
    assert capsys.readouterr().err == line


@needs("notebook", "jupyterlab", "chromium")
def test_in_jupyterlab_a_drag_turns_the_model(tmp_path):
    source = (f"import viewer\nview = viewer.show(viewer.load({str(MODEL)!r}), size=(320, 200), background='#336699')\n"
              "view")
    cells = [{"cell_type": "code", "execution_count": None, "id": "a", "metadata": {}, "outputs": [], "source": source}]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    (tmp_path / "view.ipynb").write_text(json.dumps(
        {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"http://127.0.0.1:{free.getsockname()[1]}"
    paths = {name: str(tmp_path / name.lower()) for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")}
    search = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={address.rpartition(':')[2]}",
         "--ServerApp.port_retries=0", "--IdentityProvider.token=secret", f"--ServerApp.root_dir={tmp_path}",
         "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate", "--LabApp.news_url="],
        env=os.environ | paths | {"PYTHONPATH": search}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def answers() -> bool:
        with suppress(OSError), urllib.request.urlopen(f"{address}/api?token=secret"):
            return True
        return False

    try:
        wait_until(answers, lambda: time.sleep(0.2))
        with Browser(find_browser(), 900, 700) as page:
            page.open(f"{address}/doc/tree/view.ipynb?token=secret")
            page.wait("document.querySelector('.jp-CodeCell .cm-content') !== null")
            page.wait("document.querySelector('.jp-Notebook-ExecutionIndicator')?.dataset.status === 'idle'")
            wait_until(lambda: page.value("document.querySelector('.jp-InputPrompt').textContent") != "[ ]:",
                       lambda: (page.click(".jp-CodeCell .cm-content"), page.run_cell(), time.sleep(1)))
            page.wait("document.querySelector('.pbr-viewer canvas')?.width > 0")

            def picture() -> np.ndarray:
                link = page.value("document.querySelector('.pbr-viewer canvas').toDataURL()")
                return pixels(base64.b64decode(link.partition(",")[2]))

            before = picture()
            assert before.shape == (200, 320, 3)
            left, top, width, height = page.place(".pbr-viewer")
            x, y = left + width / 2, top + height / 2
            page.drag((x, y), (x + 20, y), (x + 50, y))
            wait_until(lambda: np.abs(picture() - before).mean() > 2, lambda: time.sleep(0.2))
            page.strike("3")  # which would make a heading of the cell if it reached JupyterLab
            page.wait("!document.querySelector('.pbr-viewer .line').hidden")
            assert page.value("document.querySelector('.jp-MarkdownCell') === null")
            assert page.value("document.querySelectorAll('.jp-OutputArea-output img').length") == 0
    finally:
        server.terminate()
        server.wait()
