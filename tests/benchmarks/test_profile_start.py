"""Every function that profile_start times is still where it looks for it."""

from __future__ import annotations

import pytest

from benchmarks.profile_start import WATCHED
from benchmarks.spans import Spans, find


@pytest.mark.parametrize("place", WATCHED.values())
def test_what_is_timed_is_there(place: str) -> None:
    owner, name = find(place)
    assert callable(getattr(owner, name))


def test_a_place_that_is_gone_is_an_error() -> None:
    with pytest.raises(AttributeError):
        Spans().watch("nothing", "viewer.gpu.programs:no_such_function")
