"""Settings: what they refuse, and in which words."""

from __future__ import annotations

from dataclasses import fields
from typing import get_args

import pytest

from viewer.errors import UsageError
from viewer.settings import (
    MAX_SPP,
    RANGES,
    Mode,
    Settings,
    ignored,
    parse_background,
    setting_choices,
    setting_meanings,
    with_dashes,
)


def test_every_setting_has_a_default_among_its_choices_and_a_meaning():
    for name, choices in setting_choices().items():
        assert getattr(Settings(), name) in choices and len(choices) > 1 and setting_meanings()[name]
    of_numbers = setting_meanings().keys() - setting_choices().keys()
    assert of_numbers == {"background_blur", "bounces", "light_radius", "clamp", "volume_density", "volume_albedo",
                          "volume_g", "volume_droplets", "volume_emission", "fog", "fog_albedo", "fog_g", "photons",
                          "fog_droplets", "fog_height", "curve_radius", "hair_melanin", "hair_color",
                          "hair_absorption", "hair_roughness", "hair_tilt", "hair_ior", "weave", "yarn_plies",
                          "yarn_fibres", "yarn_twist", "yarn_hairs"} < RANGES.keys()
    own_options = {"mode", "background", "exposure", "tonemap", "ground", "spp", "time_budget", "error", "seed",
                   "denoise"}
    assert set(setting_meanings()) == {f.name for f in fields(Settings)} - own_options


def test_each_choice_of_each_setting_is_taken():
    for name, choices in setting_choices().items():
        for choice in choices:
            assert getattr(Settings().with_option(f"{name}={choice}"), name) == choice
            assert Settings.of(**{name: choice}) == Settings().with_option(f"{name.replace('_', '-')}={choice}")


def test_settings_that_are_numbers():
    settings = Settings().with_option("bounces=8").with_option("light-radius=2.5e-1")
    assert (settings.bounces, settings.light_radius) == (8, 0.25) and isinstance(settings.bounces, int)
    assert Settings.of(bounces=8, light_radius=0.25) == settings
    assert Settings().with_option("volume-albedo=0.5,1,.25").volume_albedo == (0.5, 1.0, 0.25)
    assert Settings.of(volume_albedo=[0.5, 1, 0.25]).volume_albedo == (0.5, 1.0, 0.25)
    assert Settings().with_option("volume-albedo=0.9").volume_albedo == (0.9, 0.9, 0.9)
    assert Settings().with_option("fog-droplets=20").with_option("volume-droplets=0").fog_droplets == 20
    assert Settings().with_option("volume-emission=2").volume_emission == (2.0, 2.0, 2.0)
    assert Settings.of(volume_emission=2).volume_emission == Settings.of(volume_emission=(2, 2, 2)).volume_emission
    assert Settings().with_option("fog-albedo=0.5,1,.25").fog_albedo == (0.5, 1.0, 0.25)
    assert Settings.of(fog_albedo=[0.5, 1, 0.25]).fog_albedo == (0.5, 1.0, 0.25)
    assert Settings.of(spp=None, time_budget=2, error="0.5").error == 0.5
    assert Settings().with_option("hair-melanin=0.2,.08").hair_melanin == (0.2, 0.08)
    assert Settings.of(hair_color=(1, 0.5, 0)).with_option("hair-color=none").hair_color is None
    assert Settings.of(hair_absorption=None, hair_roughness=[0, 1]).hair_roughness == (0.0, 1.0)


def test_numbers_of_a_yarn_may_be_left_to_its_kind():
    settings = Settings.of(yarn="wool", yarn_plies=2, yarn_twist=None).with_option("yarn-hairs=0.5")
    assert (settings.yarn_plies, settings.yarn_twist, settings.yarn_hairs) == (2, None, 0.5)
    assert settings.with_option("yarn-plies=none").yarn_plies is None
    with pytest.raises(UsageError, match="^--set yarn-plies=9: yarn_plies must be none or a whole number from 1 to 8$"):
        settings.with_option("yarn-plies=9")
    with pytest.raises(UsageError, match="^yarn_twist=80: it must be none or a number from -60 to 60$"):
        Settings.of(yarn_twist=80)


def test_only_one_setting_may_say_what_colour_hair_has():
    problem = "^hair_melanin and hair_color: only one of them says what colour hair has$"
    for names in (("hair-melanin=1,0", "hair-color=1,1,1"), ("hair-color=1,1,1", "hair-melanin=1,0")):
        with pytest.raises(UsageError, match=problem):
            Settings().with_option(names[0]).with_option(names[1])
    with pytest.raises(UsageError, match="^hair_melanin and hair_color and hair_absorption: only one"):
        Settings.of(hair_melanin=(1, 0), hair_color=(1, 1, 1), hair_absorption=(0, 0, 0))


def test_a_weave_is_a_name_or_a_file_and_perhaps_a_material():
    for value in ("off", "denim", "satin,Sofa, blue", "my weave.json,Cloth"):
        assert Settings().with_option(f"weave={value}").weave == Settings.of(weave=value).weave == value
    with pytest.raises(UsageError, match="^--set weave=velvet: weave must be off, plain, twill, satin, denim or FILE"):
        Settings().with_option("weave=velvet")
    with pytest.raises(UsageError, match="^weave has no effect in mode phong, only in modes pbr and path$"):
        Settings.of(mode="phong", weave="plain").check_used()


def test_the_command_line_names_settings_with_dashes():
    assert with_dashes("hair_melanin and fog_g: spp=2.") == "hair-melanin and fog-g: spp=2."
    assert with_dashes("hair_tilt.") == "hair-tilt."
    for typed in ("--set hair_melanin=3: no", "'fog_g' is none", "a/hair_color.png", "hair_color.png", "my_fog_g",
                  "fog_gs"):
        assert with_dashes(typed) == typed


def test_what_a_mode_ignores_is_refused():
    Settings.of(mode="path", spp=3, clamp=9).check_used()
    Settings.of(mode="phong", seed=0, denoise="off").check_used()
    with pytest.raises(UsageError, match="^spp and clamp have no effect in mode pbr, only in mode path$"):
        Settings.of(spp=3, clamp=9).check_used()
    with pytest.raises(UsageError, match="^denoise has no effect in mode phong"):
        Settings.of(mode="phong", denoise="fast").check_used()
    with pytest.raises(UsageError, match="^shadows has no effect in mode path, only in modes pbr and phong$"):
        Settings.of(mode="path", shadows="off").check_used()
    with pytest.raises(UsageError, match="^ndf and fresnel have no effect in mode phong, only in modes pbr and path$"):
        Settings.of(mode="phong", ndf="beckmann", fresnel="exact").check_used()
    with pytest.raises(UsageError, match="^indirect and reflections have no effect in mode phong, only in mode pbr$"):
        Settings.of(mode="phong", indirect="baked", reflections="traced").check_used()
    with pytest.raises(UsageError, match="^phong has no effect in mode pbr, only in mode phong$"):
        Settings.of(phong="blinn-phong").check_used()
    with pytest.raises(UsageError, match="^spp and phong have no effect in mode pbr$"):
        Settings.of(phong="blinn-phong", spp=3).check_used()


def test_every_setting_is_used_by_some_mode_and_the_defaults_by_all():
    assert not ignored(*get_args(Mode))
    for mode in get_args(Mode):
        Settings(mode=mode).check_used()
        assert set(ignored(mode)) <= {f.name for f in fields(Settings)}
    assert set(ignored("pbr", "phong")) == set(ignored("pbr")) & set(ignored("phong"))


def test_the_most_samples_follow_the_rules_given():
    assert Settings().most_spp == 64 and Settings(spp=7, error=0.1).most_spp == 7
    assert Settings(error=0.1).most_spp == Settings(time_budget=1.0).most_spp == MAX_SPP


@pytest.mark.parametrize("assignment, words", [
    ("bounces=0", "--set bounces=0: bounces must be a whole number from 1 to 255"),
    ("bounces=2.5", "a whole number from 1 to 255"),
    ("bounces=", "a whole number from 1 to 255"),
    ("clamp=nan", "clamp must be a number from 0 to 1e[+]09"),
    ("volume-density=-1", "volume_density must be a number from 0 to 1e[+]18"),
    ("volume-albedo=1,1", "volume_albedo must be one number or three numbers from 0 to 1"),
    ("volume-albedo=1,1,2", "volume_albedo must be one number or three numbers from 0 to 1"),
    ("volume-g=1", "volume_g must be a number from -0.99 to 0.99"),
    ("volume-emission=1,2", "volume_emission must be one number or three numbers from 0 to"),
    ("volume-droplets=2", "volume_droplets must be 0 or a number from 5 to 50"),
    ("fog-droplets=-1", "fog_droplets must be 0 or a number from 5 to 50"),
    ("fog=-1", "fog must be a number from 0 to 1e[+]18"),
    ("fog-albedo=2", "fog_albedo must be one number or three numbers from 0 to 1"),
    ("fog-albedo=1,1,2", "fog_albedo must be one number or three numbers from 0 to 1"),
    ("fog-albedo=,,", "fog_albedo must be one number or three numbers from 0 to 1"),
    ("hair-melanin=1", "hair_melanin must be none or two numbers from 0 to 1000"),
    ("hair-roughness=1", "hair_roughness must be two numbers from 0 to 1"),
    ("hair-color=1,2,1", "hair_color must be none or one number or three numbers from 0 to 1"),
    ("hair-tilt=50", "hair_tilt must be a number from -45 to 45"),
    ("hair-ior=0.5", "hair_ior must be a number from 1 to 3"),
    ("spp=4", "no setting 'spp'"),
    ("ndf", "--set ndf: ndf must be one of ggx, beckmann, blinn-phong"),
    ("ndf=GGX", "ndf must be one of"),
    ("mode=phong", "there is no setting 'mode'; choose from ndf, "),
    ("=", "no setting ''"),
])
def test_a_wrong_assignment_says_what_there_is(assignment, words):
    with pytest.raises(UsageError, match=words):
        Settings().with_option(assignment)


@pytest.mark.parametrize("values, words", [
    ({"mood": "dark"}, "there is no setting 'mood'; choose from mode, background"),
    ({"mode": "ray"}, "mode='ray': mode must be one of pbr, phong, path"),
    ({"spp": 0}, "spp=0: it must be a whole number from 1 to 65536"),
    ({"spp": 1.5}, "a whole number"),
    ({"error": -1}, "error=-1: it must be a number from 1e-05 to 1"),
    ({"seed": None}, "seed=None: it must be a whole number from 0 to 4294967295"),
    ({"denoise": "on"}, "denoise must be one of off, fast, raster, oidn"),
    ({"tonemap": None}, "tonemap must be one of neutral, agx, aces, none"),
    ({"exposure": "bright"}, "exposure='bright': it must be a number from -64 to 64"),
    ({"exposure": float("nan")}, "a number from -64 to 64"),
    ({"exposure": 65}, "a number from -64 to 64"),
    ({"background": "red"}, "background='red': it must be env, none, #rrggbb or three linear numbers"),
    ({"background": (0, 1)}, "three linear numbers"),
    ({"background": (0, 1, 2)}, "background=2: it must be a number from 0 to 1"),
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
    assert Settings(antialias="deferred-4").samples(False, False) == 4
    assert [Settings().defers(*device) for device in devices] == [True, False, False, False]
    assert not Settings().defers(True, True, (511, 512)) and Settings(antialias="deferred-4").defers(True, True, (8, 8))
    assert Settings(antialias="deferred-4").defers(False, False) and not Settings(antialias="msaa-4").defers(True, True)


def test_rays_and_steps_in_media_by_device():
    devices = [(is_software, is_still) for is_software in (True, False) for is_still in (True, False)]
    kept, moving = ("quarter", 56), ("sixteenth", 28)
    assert [Settings().media_rays_and_steps(*device) for device in devices] == [kept, moving, kept, kept]
    assert Settings(media_rays="all").media_rays_and_steps(True, False) == ("all", 28)
    assert Settings(media_steps="224").media_rays_and_steps(True, False) == ("sixteenth", 224)
