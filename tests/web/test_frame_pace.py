"""How small a moving picture gets on a slow machine."""

from __future__ import annotations

import pytest

from viewer.web.pace import FRAME_SECONDS, Pace


def settle(seconds: float, each: float) -> list[int]:
    """Widths of successive frames that take `seconds` at 800 pixels of width, of which `each` whatever their size."""
    pace, widths = Pace(), []
    for _ in range(12):
        width, height = pace.size((800, 400))
        assert abs(width - 2 * height) <= 1
        widths.append(width)
        pace.took((seconds - each) * (width / 800) ** 2 + each)
    return widths


@pytest.mark.parametrize("frames, each, width", [
    (0.1, 0, 800), (1.0, 0, 800), (1.2, 0, 800), (2.0, 0, 566), (4.0, 0, 400), (7.0, 0, 283), (1000.0, 0, 283),
    (3.0, 2.9, 283),
])
def test_it_gets_as_small_as_it_has_to_be_and_stays_so(frames, each, width):
    widths = settle(frames * FRAME_SECONDS, each * FRAME_SECONDS)
    assert widths[0] == 800 and widths[2] == width and set(widths[2:]) == {width}


def test_one_slow_frame_is_forgotten():
    pace = Pace()
    pace.took(5.0)
    assert pace.size((800, 400)) == (283, 141) and pace.size((1, 1)) == (1, 1)
    for width in (400, 566, 800, 800):
        pace.took(0.1 * FRAME_SECONDS)
        assert pace.size((800, 400))[0] == width
