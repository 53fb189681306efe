"""How small a moving picture gets on a slow machine."""

from __future__ import annotations

import pytest

from viewer.interact import pace
from viewer.interact.pace import FRAME_SECONDS, STILL_SECONDS, FrameSize, Pace


def settle(seconds: float, each: float) -> list[int]:
    """Widths of successive frames that take `seconds` at 800 pixels of width, of which `each` whatever their size."""
    learner, widths = Pace(), []
    for _ in range(12):
        width, height = learner.size((800, 400))
        assert abs(width - 2 * height) <= 1
        widths.append(width)
        learner.took((seconds - each) * (width / 800) ** 2 + each)
    return widths


@pytest.mark.parametrize("frames, each, width", [
    (0.1, 0, 800), (1.0, 0, 800), (1.2, 0, 800), (2.0, 0, 566), (4.0, 0, 400), (7.0, 0, 283), (1000.0, 0, 283),
    (3.0, 2.9, 283),
])
def test_it_gets_as_small_as_it_has_to_be_and_stays_so(frames, each, width):
    widths = settle(frames * FRAME_SECONDS, each * FRAME_SECONDS)
    assert widths[0] == 800 and widths[2] == width and set(widths[2:]) == {width}


def test_one_slow_frame_is_forgotten():
    learner = Pace()
    learner.took(5.0)
    assert learner.size((800, 400)) == (283, 141) and learner.size((1, 1)) == (1, 1)
    for width in (400, 566, 800, 800):
        learner.took(0.1 * FRAME_SECONDS)
        assert learner.size((800, 400))[0] == width


@pytest.fixture
def clock(monkeypatch) -> list[float]:
    """The time that FrameSize sees, in a list."""
    now = [100.0]
    monkeypatch.setattr(pace, "monotonic", lambda: now[0])
    return now


def test_frames_that_move_get_smaller_and_whole_when_they_rest(clock):
    frames, whole = FrameSize(), (800, 400)
    assert frames.begin(whole, moves=False) == whole
    clock[0] += 5.0  # the first frame compiles programs, and is none that moves
    frames.shown()
    assert frames.begin(whole, moves=True) == whole
    clock[0] += 4 * FRAME_SECONDS
    frames.shown()
    assert frames.begin(whole, moves=False) == whole and frames.is_whole  # no reason to draw it again
    assert frames.begin(whole, moves=True) == (400, 200) and not frames.is_whole
    clock[0] += FRAME_SECONDS
    frames.shown()
    assert frames.seconds_until_still == pytest.approx(STILL_SECONDS)  # counted from the end of a frame
    clock[0] += 0.9 * STILL_SECONDS
    assert frames.begin(whole, moves=False) == (400, 200)
    clock[0] += 0.2 * STILL_SECONDS
    assert frames.seconds_until_still < 0
    assert frames.begin(whole, moves=False) == whole and frames.is_whole
    clock[0] += 9.0  # a picture at rest takes as long as it takes
    frames.shown()
    assert frames.begin(whole, moves=True) == (400, 200)
    assert frames.begin((300, 300), moves=False) == (300, 300)  # a window that gets another size
