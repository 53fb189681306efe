"""The page of `pbr-viewer check`: what it holds, and how it looks in a browser."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, find_browser
from needs import needs
from PIL import Image as Pillow

from viewer.measure.check.checks import Check
from viewer.measure.check.page import write_page


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("check")
    write_page(folder, [Check("a", "<b>", 0.5, 1.0)], with_plots=True)
    return folder / "index.html"


def test_it_has_plots(page):
    text = page.read_text()
    assert text.count("<svg") >= 15 and text.count("data:image/png") >= 8 and "&lt;b&gt;" in text
    assert "nan" not in text and len(text) < 2_000_000


def test_furnaces_are_grey_so_that_nobody_takes_them_for_missing_pictures(page):
    """Radiance 1 is half of white, 188 in sRGB; what single scattering loses is darker."""
    codes = re.findall("data:image/png;base64,([^\"]+)", page.read_text())
    pictures = [np.asarray(Pillow.open(io.BytesIO(base64.b64decode(code))).convert("L")) for code in codes]
    assert all(abs(int(picture[0, 0]) - 188) <= 1 for picture in pictures)
    assert sorted(picture.min() >= 187 for picture in pictures) == [False] * 4 + [True] * 4


@needs("chromium")
@pytest.mark.parametrize("width, per_row", [(1280, {3, 4}), (360, {1})])
def test_figures_fill_the_width_of_a_wide_and_of_a_narrow_screen(page, width, per_row):
    with Browser(find_browser(), width, 800) as browser:
        browser.open(page)
        plots = browser.value("[...document.querySelectorAll('.plots')].map(plots => [...plots.children].map("
                              "child => { const b = child.getBoundingClientRect(); return [b.top, b.left, b.right] }))")
        left, right = browser.value("(b => [b.left, b.right])(document.querySelector('h2').getBoundingClientRect())")
        assert browser.value("document.documentElement.scrollWidth") <= width
    assert len(plots) == 4
    for figures in plots:
        rows: dict[float, list] = {}
        for top, *sides in figures:
            rows.setdefault(round(top), []).append(sides)
        assert {len(row) for row in rows.values()} <= per_row
        for row in rows.values():
            assert abs(row[0][0] - left) < 2 and abs(row[-1][1] - right) < 2
