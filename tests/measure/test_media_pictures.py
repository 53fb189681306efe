"""The checks of path-traced media, a few of their cases each: they pass, and notice what is wrong."""

from __future__ import annotations

import pytest
from contexts import open_or_skip

from viewer.measure.check import media_pictures
from viewer.measure.check.media_pictures import check_media_extremes, check_media_furnaces
from viewer.trace.tracer import Tracer


@pytest.fixture(scope="module")
def tracer():
    with open_or_skip() as context:
        tracer = Tracer(context, use_cache=False)
        yield tracer
        tracer.release()


def test_white_media_vanish(tracer, monkeypatch):
    monkeypatch.setattr(media_pictures, "_FURNACES", media_pictures._FURNACES[2:4])
    checks = list(check_media_furnaces(tracer))
    assert len(checks) == 8 and not [check for check in checks if check.is_defect]


def test_what_absorbs_does_not_vanish(tracer, monkeypatch):
    monkeypatch.setattr(media_pictures, "_FURNACES", [media_pictures._Case(5, 0.5)])
    assert all(check.is_defect for check in check_media_furnaces(tracer))


def test_extremes(tracer, monkeypatch):
    monkeypatch.setattr(media_pictures, "_EXTREMES", media_pictures._EXTREMES[5:7])
    checks = list(check_media_extremes(tracer))
    assert not [check for check in checks if check.is_defect]
    assert {check.check for check in checks} == {"no NaN, no Inf", "no sample lost", "same picture"}
