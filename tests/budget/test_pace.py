"""What is foreseen from what was measured."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from shapes import plate, scene

from viewer.budget.candidates import candidates_for
from viewer.budget.pace import ALIKE, GUESSED, LOOKUP, LOOKUPS, MAP, RESOLVE, SAMPLE, SURE, Pace, work
from viewer.scene.environment_files import load_environment
from viewer.scene.light import Light
from viewer.settings import Settings

PLAIN, FINE = Settings(antialias="none"), Settings(antialias="ssaa-4")
SHADOWED = replace(FINE, environment_shadows="16")
SIZE = (8, 8)


@pytest.fixture(scope="module")
def square():
    return scene(plate())


@pytest.fixture
def pace(square) -> Pace:
    made = Pace()
    made.of(square, SIZE, False)
    return made


def test_nothing_is_foreseen_before_a_first_frame(pace, square):
    assert pace.frame(PLAIN) == math.inf and pace.paths(square, False, 4) == math.inf


def test_a_frame_takes_what_it_took(pace):
    pace.drawn(PLAIN, 0.1, 0.0)
    assert pace.frame(PLAIN) == pytest.approx(0.1)


def test_another_frame_follows_from_the_points_it_shades_and_the_maps_it_looks_up(pace):
    pace.first, pace.textures, pace.small = 2.0, 0.5, 0.01
    pace.drawn(PLAIN, 0.1, 0.0)
    assert work(PLAIN) == 1 and work(FINE) == 3 and work(SHADOWED) == pytest.approx(3 + LOOKUPS + 16 * LOOKUP)
    assert pace.frame(FINE) == pytest.approx(GUESSED * (0.3 + 1.5 * RESOLVE))
    assert pace.frame(SHADOWED) == pytest.approx(GUESSED * (0.1 * work(SHADOWED) + 16 * MAP * 0.01 + 1.5))


def test_maps_are_drawn_again_if_others_are_held(pace):
    pace.first, pace.small = 0.0, 0.01
    pace.drawn(PLAIN, 0.1, 0.0)
    pace.drawn(SHADOWED, 2.6, 1.6)
    more = replace(FINE, environment_shadows="64")
    assert pace.frame(SHADOWED) == pytest.approx(1.0)
    pace.drawn(more, 7.4, 6.4)
    assert pace.frame(SHADOWED) == pytest.approx(ALIKE * work(SHADOWED) / work(more) + SURE * 1.6)


def test_maps_that_are_held_do_not_tell_what_others_take(pace):
    """A second frame only sees that they are there, in some microseconds."""
    pace.drawn(PLAIN, 0.1, 0.0)
    pace.drawn(SHADOWED, 2.6, 1.6)
    more = replace(FINE, environment_shadows="64")
    before = pace.frame(more)
    assert before > 64 * 0.1
    pace.drawn(SHADOWED, 1.0, 2e-6)
    assert pace.frame(more) == pytest.approx(before, rel=1e-3)


def test_with_the_maps_that_are_held_fewer_points_are_known(pace):
    """Nothing is to be drawn or compiled for them; of other maps, and of more points, there may be."""
    fine, coarse = (Settings(antialias=antialias, environment_shadows="64") for antialias in ("ssaa-9", "none"))
    pace.first = 0.5
    pace.drawn(PLAIN, 0.1, 0.0)
    assert not pace.knows(coarse) and pace.knows(PLAIN)
    pace.drawn(fine, 4.0, 3.0)
    assert pace.knows(coarse) and pace.frame(coarse) == pytest.approx(work(coarse) / work(fine))
    assert not pace.knows(SHADOWED) and not pace.knows(replace(fine, antialias="ssaa-16"))
    pace.frames[PLAIN] = 0.9  # of many triangles
    assert pace.frame(coarse) == 0.9


def test_of_another_scene_or_size_nothing_is_known(pace, square):
    for scene_of, size, is_held in ((square, SIZE, False), (square, (9, 8), True), (replace(square), SIZE, True)):
        pace.of(square, SIZE, True)
        pace.drawn(PLAIN, 0.1, 0.0)
        pace.of(square, SIZE, True)
        assert pace.frames
        pace.of(scene_of, size, is_held)
        assert not pace.frames


def test_paths_are_prepared_once(pace, square):
    pace.first = 1.0
    pace.drawn(PLAIN, 0.1, 0.0)
    assert pace.paths(square, False, 4) > 1.0 + 4 * SAMPLE * 0.1
    pace.sample = 0.2
    assert pace.paths(square, True, 4) == pytest.approx(0.8) and pace.paths(square, False, 4) > 0.8


def test_what_is_set_stays(square):
    lit = replace(square, environment=load_environment("furnace"))
    titles = [title for title, _ in candidates_for(lit, Settings())]
    assert titles[0] == "image-based light, no antialiasing" and titles[-1] == \
        "shadows of the environment, 64 lights, SSAA 9" and len(titles) == 6
    fixed = candidates_for(lit, Settings(antialias="msaa-2"))
    assert {changed.antialias for _, changed in fixed} == {"msaa-2"}
    assert [changed.environment_shadows for _, changed in fixed] == ["off", "16", "64"]
    fixed = candidates_for(lit, Settings(environment_shadows="256"))
    assert [changed.antialias for _, changed in fixed] == ["none", "ssaa-4", "ssaa-9"]
    assert {changed.environment_shadows for _, changed in fixed} == {"256"}


def test_without_an_environment_only_antialiasing_changes(square):
    lamp = replace(square, lights=(Light.from_angles(0.6, 0.9, 3.0),))
    assert candidates_for(lamp, Settings()) == [
        ("raster, no antialiasing", PLAIN), ("raster, SSAA 4", FINE),
        ("raster, SSAA 9", Settings(antialias="ssaa-9"))]
