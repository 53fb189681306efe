"""The page in a real browser: a person's mouse and keys, and no error of its scripts."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, find_browser
from needs import needs
from PIL import Image as Pillow
from stored_report import stored_findings

from viewer.measure.report.page import write_report

PROGRAM = find_browser()
pytestmark = needs("chromium")


@pytest.fixture(scope="module")
def page_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    write_report(folder, stored_findings())
    return folder


@pytest.fixture(scope="module")
def page(page_folder: Path):
    with Browser(PROGRAM) as browser:
        browser.open(page_folder / "index.html")
        yield browser
        assert browser.problems == []


@pytest.fixture(scope="module")
def report(page_folder: Path) -> dict:
    return json.loads((page_folder / "report.json").read_text())


def label(page: Browser) -> str:
    return page.value("document.querySelector('#label').textContent")


def rows(page: Browser, table: str) -> list[str]:
    return page.value(f"[...document.querySelectorAll('{table} tbody tr')].map(row => row.innerText)")


def test_it_shows_every_point_once_in_chart_and_table(page, report):
    count = len(report["points"])
    assert len(rows(page, "#points")) == count
    assert page.value("document.querySelectorAll('.chart.shown g.point').length") == count
    assert page.value("document.querySelectorAll('.chart.shown').length") == 1
    assert page.value("document.querySelector('h1').textContent") == "spheres.glb"
    assert report["device"] in page.value("document.querySelector('#how').textContent")


def choices(page: Browser, where: str = "#recommend") -> list[str]:
    """What is said for each time, or each quality, on one line."""
    lines = page.value(f"[...document.querySelectorAll('{where} > div')].map(line => line.innerText)")
    return [" ".join(line.split()) for line in lines]


def test_it_says_in_a_sentence_which_setting_serves_for_each_time_and_how_wrong_it_is(page, report):
    lines = choices(page)
    names = ["30 frames a second", "a picture in 0.1 s", "a picture in 1 s", "a picture in 10 s"]
    before = None
    for line, name, row in zip(lines, names, report["recommend"], strict=True):
        assert line.startswith(name)
        if row["point"] is None:
            assert "No method is fast enough" in line
        elif row["point"] == before:
            assert "No better method was measured" in line
        else:
            point = report["points"][row["point"]]
            assert line.startswith(f"{name} {point['label']} takes ") and point["command"] in line
            assert re.search(r"Its relative error is \d+(\.\d+)? %, .*; FLIP 0(\.\d+)?\. ", line)
        before = row["point"]
    told = page.value("document.querySelector('#scope').textContent")
    assert "24 x 24" in told and report["device"] in told and "1600 times as long" in told


def test_it_says_what_each_quality_costs_and_how_wrong_it_is(page, report):
    draft, *others = choices(page, "#qualities")
    point = report["points"][report["qualities"]["draft"]]
    assert draft.startswith(f"--quality draft {point['label']} takes 160 ms") and point["command"] in draft
    assert re.search(r"Its relative error is \d+(\.\d+)? %, .*; FLIP 0(\.\d+)?\. ", draft)
    assert others == [f"--quality {name} It was not measured." for name in ("standard", "high")]


def test_pictures_are_there_and_of_the_reports_size(page):
    page.wait("[...document.images].every(image => image.complete)")
    assert page.value("[...document.images].map(i => [i.naturalWidth, i.naturalHeight])") == [[24, 24]] * 3


def test_a_point_is_chosen_by_hovering_clicking_and_keys(page, report):
    points = report["points"]
    mark = ".chart.shown g.point[data-point='2'] polygon"
    page.hover(mark)
    page.wait(f"document.querySelector('#label').textContent === {json.dumps(points[2]['label'])}")
    page.click("#points tr[data-point='1'] td")
    assert label(page) == points[1]["label"]
    page.hover(mark)
    page.hover("h1")
    assert label(page) == points[1]["label"]  # kept
    assert page.value("document.querySelector('#command-line code').textContent") == points[1]["command"]
    page.value("document.querySelector('#charts').focus()")
    page.press("ArrowRight")
    assert label(page) == points[2]["label"]
    page.press("End")
    page.press("ArrowRight")
    assert label(page) == points[-1]["label"]
    page.press("Home")
    page.press("ArrowLeft")
    assert label(page) == points[0]["label"]
    assert page.value("document.querySelectorAll('.chart.shown g.point.chosen').length") == 1


CUT = "parseFloat(getComputedStyle(document.querySelector('#reference')).clipPath.split(' ').pop())"
"""Where the wipe is, in per cent, by what is drawn."""


def test_the_wipe_follows_mouse_and_keys(page):
    left, top, width, height = page.place("#wipe")
    page.drag((left + 0.3 * width, top + height / 2))
    page.wait(f"Math.abs({CUT} - 30) <= 1")
    page.drag((left + 0.3 * width, top + height / 2), (left + 0.6 * width, top + 5), (left + 0.8 * width, top + 9))
    page.wait(f"Math.abs({CUT} - 80) <= 1")
    page.value("document.querySelector('#slider').value = 80; document.querySelector('#slider').focus()")
    page.press("ArrowLeft")
    page.wait(f"{CUT} === 79 && document.querySelector('#slider').value === '79'")


def test_the_wipe_shows_the_picture_on_its_left_and_the_reference_on_its_right(page, tmp_path):
    def shown(where: str) -> np.ndarray:
        page.press(where)
        left, top, width, height = (round(number) for number in page.place("#wipe"))
        page.shot(tmp_path / "page.png")
        picture = np.asarray(Pillow.open(tmp_path / "page.png").convert("RGB"), float)
        return picture[top + 9:top + height - 9, left + 9:left + width - 9]

    page.click("#points tr[data-point='0'] td")  # the fastest: far from the reference
    page.value("document.querySelector('#slider').focus()")
    reference, picture = shown("Home"), shown("End")
    assert np.abs(reference - picture).mean() > 2


def test_another_error_changes_chart_recommendations_and_front(page, report):
    page.value("(s => { s.value = 'flip'; s.dispatchEvent(new Event('change')) })(document.querySelector('#measure'))")
    assert page.value("document.querySelector('.chart.shown').dataset.measure") == "flip"
    best = report["recommend"][0]["by"]["flip"]
    assert ("No method is fast enough" if best is None else report["points"][best]["label"]) in choices(page)[0]
    front = page.value("[...document.querySelectorAll('#points tr.front')].map(row => Number(row.dataset.point))")
    assert front == [k for k, point in enumerate(report["points"]) if point["pareto_by"]["flip"]]


def test_the_command_is_copied(page, report):
    page.click("#points tr[data-point='3'] td")
    page.click("#command-line button")
    page.wait("document.querySelector('#command-line button').textContent === 'Copied'")
    assert page.value("navigator.clipboard.readText()") == report["points"][3]["command"]


@pytest.mark.parametrize("width, dark", [(1100, True), (360, False)])
def test_dark_and_narrow(page_folder, width, dark):
    with Browser(PROGRAM, width, 800, dark) as page:
        page.open(page_folder / "index.html")
        assert page.value("document.documentElement.scrollWidth") <= width
        brightness = page.value("getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g)[0]")
        assert (int(brightness) < 60) == dark
        assert page.problems == []
