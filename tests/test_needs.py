"""The rule by which tests are skipped, and its words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from needs import NEEDS, Need, in_words, needs, require


@pytest.fixture
def absent(monkeypatch):
    monkeypatch.setitem(NEEDS, "absent", Need("pictures of cats", "there is no cat", "find one", lambda: False))


def test_what_is_missing_skips_and_is_said(absent):
    mark = needs("absent")
    assert mark.args == (True,) and mark.kwargs["reason"] == "pictures of cats: there is no cat (find one)"
    with pytest.raises(pytest.skip.Exception, match="there is no cat"):
        require("absent")


def test_what_is_here_skips_nothing(monkeypatch):
    monkeypatch.setitem(NEEDS, "present", Need("pictures", "nothing", is_here=lambda: True))
    require("present")
    assert needs("present").args == (False,)


def test_the_same_reason_is_told_once_and_the_commonest_first():
    assert in_words(["a: b", "c: d (e)", "c: d (e)"]) == ["not tested: 2 tests of c: d (e)",
                                                          "not tested: 1 test of a: b"]


def test_no_test_skips_in_another_way():
    ways = re.compile(r"pytest\.skip\(|mark\.skip|skipif|importorskip|SkipTest")
    folder = Path(__file__).parent
    found = [str(file.relative_to(folder)) for file in sorted(folder.rglob("*.py")) if ways.search(file.read_text())]
    assert found == ["needs.py", "test_needs.py"]
