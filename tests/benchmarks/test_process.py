"""What the benchmarks take for a run that worked."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from benchmarks.process import run

DRAW = "import sys; from PIL import Image; i = Image.new('RGB', (4, 3)); i.putpixel((0, 0), {}); i.save(sys.argv[1])"


@pytest.fixture
def attempt(tmp_path: Path):
    def attempt(program: str, **options: float) -> dict[str, object]:
        picture = tmp_path / "picture.png"
        return run([sys.executable, "-c", program, str(picture)], picture, (4, 3), tmp_path, tmp_path, **options)

    return attempt


def test_a_picture_gives_times_memory_and_what_was_said(attempt) -> None:
    result = attempt(DRAW.format((255, 0, 0)) + "; print('{\"version\": \"1\"}')")
    assert result["version"] == "1" and 0 < result["wall_s"] < 60 and 1 < result["rss_mb"] < 1000


def test_the_peak_counts_not_what_is_left_nor_who_asks(attempt) -> None:
    drawn = DRAW.format((255, 0, 0))
    ours = bytearray(300 << 20)
    assert attempt("bytearray(200 << 20); " + drawn)["rss_mb"] > attempt(drawn)["rss_mb"] + 150
    assert attempt(drawn)["rss_mb"] < len(ours) >> 20


def test_a_blank_picture_is_a_failure(attempt) -> None:
    assert attempt(DRAW.format((0, 0, 0))) == {"error": "the picture is blank"}


def test_no_picture_is_a_failure(attempt) -> None:
    assert attempt("") == {"error": "no picture"}


def test_a_status_is_a_failure_with_its_last_lines(attempt) -> None:
    assert attempt("raise SystemExit('no light')") == {"error": "status 1: no light"}


def test_what_takes_too_long_is_ended(attempt) -> None:
    assert attempt("import time; time.sleep(60)", timeout=0.3) == {"error": "over 0.3 s"}


def test_nothing_of_this_user_is_seen(attempt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", "/elsewhere")
    look = "import os; raise SystemExit(os.environ['HOME'] + str('MESA_SHADER_CACHE_DIR' in os.environ))"
    assert attempt(look) == {"error": f"status 1: {tmp_path}False"}
