"""Animations in the window, by real keys: they play by the clock, stand still on request, and paths wait for that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from waiting import wait_until

from viewer.app.window import ViewerWindow
from viewer.interact.playback import Playback
from viewer.scene.animation import Animation, Target, Track
from viewer.scene.rig import Nodes, Rig
from viewer.settings import Settings

from .conftest import PLAIN
from .test_window import SAME, flip


@pytest.fixture(scope="module")
def rolling(scene):
    """The small model, of which the first ball goes to and fro in 4 s."""
    count, start = len(scene.instances), scene.transforms[:, :3, 3]
    nodes = Nodes(np.full(count, -1), np.zeros(count, int), start, np.tile([0.0, 0, 0, 1], (count, 1)),
                  np.ones((count, 3)), {}, np.ones(count, bool))
    there = start[0] + (np.ptp(scene.bounds[:, 0]), 0, 0)
    track = Track(Target("node", 0, "translation"), [0, 2, 4], [start[0], there, start[0]])
    return replace(scene, animations=(Animation("roll", (track,)),), rig=Rig(nodes, np.arange(count)))


def test_p_plays_and_pauses(open_window, rolling):
    hands = open_window(rolling)
    window: ViewerWindow = hands.window
    still = hands.screen()
    window.do("play")  # a key would wait for the window to come to rest
    wait_until(lambda: window.state.playback.time > 0.2, lambda: window.step(0.02), what="playing")
    assert window.state.playback.is_playing and window.needs_redraw
    hands.key("p")
    assert not window.state.playback.is_playing and not window.needs_redraw
    shown, moved = window.state.playback.time, hands.screen()
    assert (still != moved).any() and window.state.scene is not rolling
    hands.settle()
    assert window.state.playback.time == shown and np.array_equal(hands.screen(), moved)
    hands.key("comma")
    assert window.state.playback.time == pytest.approx(max(shown - 0.04, 0))
    hands.key("period", "period")
    assert window.state.playback.time == pytest.approx(max(shown - 0.04, 0) + 0.08)
    hands.key("shift+p")
    assert window.state.playback.animation is None
    assert np.array_equal(window.state.scene.transforms, rolling.transforms)


def test_paths_begin_again_at_another_time(open_window, rolling):
    settings = replace(PLAIN, mode="path", spp=2, denoise="off")
    hands = open_window(rolling.at(1.0), settings, playback=Playback(0, 1.0))
    window = hands.window
    hands.until(lambda: window.picture.paths.is_done)
    first = hands.screen()
    window.state.seek(1.5)
    hands.until(lambda: window.picture.paths.is_done)
    second = hands.screen()
    assert flip(first[90:], second[90:]) > 2 * SAME  # below the lines that tell the seconds
    window.state.seek(1.0)
    hands.until(lambda: window.picture.paths.is_done)
    assert flip(first[90:], hands.screen()[90:]) < SAME


def test_the_panel_has_a_section_for_what_moves(open_window, rolling, scene, monkeypatch):
    from viewer.app import setting_rows

    seen, real = [], setting_rows.row
    monkeypatch.setattr(setting_rows, "row", lambda label, *more: (seen.append(label), real(label, *more))[1])
    hands = open_window(rolling, Settings(antialias="none"), size=(1000, 500), playback=Playback(0))
    hands.settle()
    assert {"Animation", "Time", "Speed", "Exposure"} <= set(seen)
    hands.window.state.open(scene)
    seen.clear()
    hands.screen()
    assert "Animation" not in seen and "Exposure" in seen
