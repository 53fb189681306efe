"""`pbr-viewer page`: what the page holds, and how it turns in a real browser, by mouse, finger and keys."""

from __future__ import annotations

import base64
import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, find_browser
from command_line import SCENES, names
from needs import needs
from PIL import Image as Pillow

import viewer
from viewer.image.image import Image
from viewer.jobs.makers import RasterMaker
from viewer.scene.camera import DEFAULT_FOV, Camera
from viewer.web.turning import HIGHEST, Turn, encoded, turning_page

MODEL = SCENES / "spheres.glb"
NAME = 'a "<b>\n</script><script>alert(1)</script>\udcff&amp;'
SIZE = (300, 200)
TURN = Turn.of(12, 3, 30.0, 15.0)


def grey(number: int) -> int:
    return 20 + 6 * number


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page whose pictures are of one grey each, which tells them apart."""
    pixels = (np.full((SIZE[1], SIZE[0], 3), grey(k), np.uint8) for k in range(TURN.count))
    path = tmp_path_factory.mktemp("page") / "page.html"
    pictures = [encoded(Image.from_srgb(picture), 90) for picture in pixels]
    path.write_text(turning_page(NAME, TURN, pictures, SIZE, "about <i>it</i>"), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def browser(file):
    with Browser(find_browser(), 500, 600) as browser:
        yield browser
        assert browser.problems == []  # whatever it had asked the network for would be one


@pytest.fixture
def page(browser, file) -> Browser:
    browser.open(file)
    return browser


def shown(page: Browser, folder: Path) -> tuple[int, int]:
    """Column and row of the picture, from the grey in its middle."""
    page.wait("document.querySelector('#picture').complete")
    x, y = middle(page)
    page.shot(folder / "shot.png")
    level = int(np.asarray(Pillow.open(folder / "shot.png").convert("L"))[round(y), round(x)])
    row, column = divmod(round((level - 20) / 6), TURN.columns)
    assert abs(level - grey(row * TURN.columns + column)) <= 2
    return column, row


def middle(page: Browser) -> tuple[float, float]:
    left, top, width, height = page.place("#picture")
    assert (width, height) == SIZE
    return left + width / 2, top + height / 2


def test_elevations_stay_away_from_the_poles_and_one_row_is_where_it_is_asked_for():
    assert Turn.of(36, 1, 0.0, 90.0).elevations == (90.0,)
    assert Turn.of(36, 3, 0.0, 15.0) == Turn(36, 0.0, (-10.0, 15.0, 40.0), 1)
    assert Turn.of(36, 2, 0.0, 15.0) == Turn(36, 0.0, (15.0, 40.0), 0)
    assert Turn.of(36, 3, 0.0, 80.0) == Turn(36, 0.0, (35.0, 60.0, 85.0), 2)
    for rows in (2, 7, 20):
        for elevation in (-90.0, 0.0, 90.0):
            steps = np.diff(Turn.of(1, rows, 0.0, elevation).elevations)
            assert np.allclose(steps, min(25.0, 2 * HIGHEST / (rows - 1)))
            assert max(map(abs, Turn.of(1, rows, 0.0, elevation).elevations)) <= HIGHEST + 1e-9


def test_a_hostile_name_is_text(file):
    text = file.read_text(encoding="utf-8")
    assert "<script>alert" not in text and "<b>" not in text and "<i>" not in text
    escaped = "a &quot;&lt;b&gt; &lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;\\udcff&amp;amp;"
    assert f"<title>{escaped}</title>" in text and f'alt="{escaped}, a picture by pbr-viewer"' in text
    assert text.count("</script>") == 2
    assert not re.search(r"(?:src|href)=\"(?!data:)", text) and "http://" not in text and "https://" not in text


@needs("chromium")
def test_the_mouse_turns_it_as_a_hand_would(page, tmp_path):
    assert shown(page, tmp_path) == (0, TURN.row)
    x, y = middle(page)
    page.drag((x, y), (x + 50, y), (x + 100, y))  # half a height is a quarter of a turn
    assert shown(page, tmp_path) == (12 - 3, 1)
    page.drag((x, y), (x - 100, y + 28))  # 28 of 200 are 25 degrees
    assert shown(page, tmp_path) == (0, 2)
    page.drag((x, y), (x, y + 150))
    assert shown(page, tmp_path) == (0, 2)  # there is none higher
    page.drag((x, y), (x, y - 28))
    assert shown(page, tmp_path) == (0, 1)
    page._mouse("mouseMoved", (x + 100, y), 0)
    assert shown(page, tmp_path) == (0, 1)  # nobody holds it
    assert "elevation 15°" in page.value("document.querySelector('#from').textContent")


@needs("chromium")
def test_a_finger_and_keys_turn_it_too(page, tmp_path):
    x, y = middle(page)
    page.touch((x, y), (x + 20, y), (x + 100, y))
    assert shown(page, tmp_path) == (9, 1)
    page.value("document.querySelector('#model').focus()")
    for key, place in [("ArrowRight", (10, 1)), ("ArrowUp", (10, 2)), ("ArrowUp", (10, 2)), ("ArrowDown", (10, 1)),
                       ("ArrowLeft", (9, 1)), ("Home", (0, 1)), ("ArrowLeft", (11, 1))]:
        page.press(key)
        assert shown(page, tmp_path) == place, key
    assert page.value("document.querySelector('#model').getAttribute('aria-valuetext')") == "Azimuth 0°, elevation 15°"


@needs("chromium")
def test_without_scripts_it_is_a_still(browser, file, tmp_path):
    browser.allow_scripts(False)
    browser.open(file)
    try:
        assert shown(browser, tmp_path) == (0, TURN.row)
        assert "with scripts" in browser.value("document.querySelector('noscript').innerText")
    finally:
        browser.allow_scripts(True)


def test_its_pictures_are_those_that_render_makes(run, tmp_path):
    path = tmp_path / "page.html"
    outcome = run("page", MODEL, "-o", path, "--frames", "3x2", "--size", "48x40", "--orbit", "-30,5,9",
                  "--set", "antialias=none", "--webp-quality", "100")
    assert (outcome.status, outcome.out) == (0, "")
    assert outcome.err == f"{path}: 6 pictures of 48x40, {path.stat().st_size / 1e3:.0f} kB\n"
    found = re.search(r'id="pictures">(.*?)</script>', path.read_text(encoding="utf-8"))
    assert found is not None
    grid = json.loads(found[1])
    assert grid["elevations"] == [5, 30] and grid["azimuth"] == -30
    scene = viewer.load(MODEL)
    cameras = [Camera.orbit(scene.center, 9, math.radians(-30 + 120 * column), math.radians(elevation), DEFAULT_FOV)
               for elevation in grid["elevations"] for column in range(3)]
    right = [viewer.render(scene, (48, 40), camera, antialias="none").srgb[..., :3].astype(float) for camera in cameras]
    for k, link in enumerate(grid["pictures"]):
        picture = Pillow.open(io.BytesIO(base64.b64decode(link.removeprefix("data:image/webp;base64,"))))
        pixels = np.asarray(picture.convert("RGB")).astype(float)
        distances = [np.abs(pixels - other).mean() for other in right]
        assert distances[k] < 4 and distances[k] < 0.5 * min(distances[:k] + distances[k + 1:])


@pytest.mark.parametrize("ortho", [(), ("--ortho",)])
def test_the_whole_model_is_in_every_picture(run, tmp_path, monkeypatch, ortho):
    scene, cameras = viewer.load(MODEL), []

    def make(self, scene, camera, path, progress):
        cameras.append(camera)
        return Image.from_srgb(np.zeros((40, 48, 3), np.uint8))

    monkeypatch.setattr(RasterMaker, "make", make)
    assert run("page", MODEL, "-o", tmp_path / "page.html", "--frames", "9x3", "--size", "48x40", "-q",
               *ortho).err == ""
    assert len({camera.height for camera in cameras}) == 1 and (cameras[0].height is None) == (not ortho)
    distances = {round(float(np.linalg.norm(camera.eye - scene.center)), 9) for camera in cameras}
    assert len(cameras) == 27 and (len(distances) == 1 or ortho)
    for camera in cameras:
        x, y, z = ((scene.corners.reshape(-1, 3) - camera.eye) @ camera.pose[:3, :3]).T
        half = -z * math.tan(camera.fov_y / 2) if camera.height is None else camera.height / 2
        assert (abs(y) <= half * 1.1).all() and (abs(x) <= half * 48 / 40 * 1.1).all() and (z < 0).all()


def test_it_is_written_whole_or_not_at_all(run, tmp_path, monkeypatch):
    make, count = RasterMaker.make, 0

    def fail(self, *arguments):
        nonlocal count
        count += 1
        if count == 2:
            raise viewer.InputError("spheres.glb", "images[0]", "is broken")
        return make(self, *arguments)

    monkeypatch.setattr(RasterMaker, "make", fail)
    outcome = run("page", MODEL, "-o", tmp_path / "page.html", "--frames", "3", "--size", "32")
    assert (outcome.status, outcome.error) == (1, "spheres.glb: images[0]: is broken")
    assert names(tmp_path) == []


@pytest.mark.parametrize("arguments, words", [
    (["-o", "a.png"], "-o a.png: the name of a page must end in .html"),
    (["-o", "a.html", "--frames", "0"], "'0' is not N or NxM"),
    (["-o", "a.html", "--frames", "400x3"], "--frames 400x3: a page has at most 1000 pictures"),
    (["-o", "a.html", "--size", "20000x10"], "at most 16383 pixels along a side"),
    (["-o", "a.html", "--eye", "1,2,3"], "--eye has no effect on a page"),
    (["-o", "a.html", "--camera", "0"], "--camera has no effect on a page"),
    (["-o", "a.html", "--error", "0.1"], "error has no effect in mode pbr"),
])
def test_wrong_usage_is_one_line(run, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    outcome = run("page", MODEL, *arguments)
    assert outcome.status == 2 and words in outcome.error and names(tmp_path) == []
