"""Settings: what they refuse, and in which words."""

from __future__ import annotations

from dataclasses import fields

import pytest

from viewer.errors import UsageError
from viewer.settings import Settings, parse_background, setting_choices, setting_meanings


def test_every_setting_has_a_default_among_its_choices_and_a_meaning():
    for name, choices in setting_choices().items():
        assert getattr(Settings(), name) in choices and len(choices) > 1 and setting_meanings()[name]
    assert set(setting_choices()) == {f.name for f in fields(Settings)} - {"mode", "background", "exposure", "tonemap"}


def test_each_choice_of_each_setting_is_taken():
    for name, choices in setting_choices().items():
        for choice in choices:
            assert getattr(Settings().with_option(f"{name}={choice}"), name) == choice
            assert Settings.of(**{name: choice}) == Settings().with_option(f"{name.replace('_', '-')}={choice}")


@pytest.mark.parametrize("assignment, words", [
    ("ndf", "--set ndf: ndf is one of ggx, beckmann, blinn-phong"),
    ("ndf=GGX", "ndf is one of"),
    ("mode=phong", "no setting 'mode'; there are ndf, "),
    ("=", "no setting ''"),
])
def test_a_wrong_assignment_says_what_there_is(assignment, words):
    with pytest.raises(UsageError, match=words):
        Settings().with_option(assignment)


@pytest.mark.parametrize("values, words", [
    ({"mood": "dark"}, "no setting 'mood'; there are mode, background"),
    ({"mode": "path"}, "mode='path': mode is one of pbr, phong"),
    ({"tonemap": None}, "tonemap is one of neutral, agx, aces, none"),
    ({"exposure": "bright"}, "exposure='bright': it is a number from -64 to 64"),
    ({"exposure": float("nan")}, "a number from -64 to 64"),
    ({"exposure": 65}, "a number from -64 to 64"),
    ({"background": "red"}, "background='red': it is env, none, #rrggbb or three linear numbers"),
    ({"background": (0, 1)}, "three linear numbers"),
    ({"background": (0, 1, 2)}, "background=2: it is a number from 0 to 1"),
])
def test_wrong_values_are_refused_in_words(values, words):
    with pytest.raises(UsageError, match=words):
        Settings.of(**values)


def test_a_colour_is_decoded_from_srgb():
    expected = (((51 / 255 + 0.055) / 1.055) ** 2.4, ((102 / 255 + 0.055) / 1.055) ** 2.4, 1.0)
    assert Settings.of(background="#3366ff").background == pytest.approx(expected, rel=1e-12)
    assert parse_background("3366FF") == parse_background("#3366ff")
    assert parse_background([0, 0.5, 1]) == (0.0, 0.5, 1.0) and parse_background("env") == "env"


def test_samples_by_device():
    devices = [(is_software, is_still) for is_software in (True, False) for is_still in (True, False)]
    assert [Settings().samples(*device) for device in devices] == [4, 1, 4, 4]
    assert Settings(antialias="msaa-8").samples(True, False) == 8
    assert Settings(antialias="none").samples(False, True) == 1
