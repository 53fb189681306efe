"""`--quality`: named points between options and settings, for the command line and Python alike."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from command_line import SCENES
from shapes import WHITE, constant, facing_floor, moved, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.image.image import Image
from viewer.jobs.info import describe_scene
from viewer.quality import DRAFT, POINTS, QUALITIES, Quality
from viewer.settings import Settings

MODEL = SCENES / "spheres.glb"
SMALL = ("--size", "32x24")
ROOM = scene((plate(half=2.0), facing_floor()), (sphere(segments=12), moved((0, 0.5, 0), 0.5)), environment=constant(),
             materials=[replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))])


def test_points_are_settings_that_exist_and_mode_pbr_uses():
    for name, point in POINTS.items():
        settings = Quality(name).applied(Settings())
        assert {key: getattr(settings, key) for key in point} == point
        Settings.of(**point)
        settings.check_used()
    assert Quality("draft").applied(Settings()) == Settings() == DRAFT.applied(Settings())
    assert len({Quality(name).applied(Settings()) for name in QUALITIES}) == len(QUALITIES)


def test_what_is_given_wins_and_other_modes_have_no_quality():
    given = Settings(environment_shadows="off", ndf="beckmann")
    assert Quality("standard", lights=16).applied(Settings()) == \
        replace(Settings(), **POINTS["standard"] | {"environment_shadows": "16"})
    assert [str(Quality("standard", lights=lights)) for lights in (16, 64)] == ["standard with 16 lights", "standard"]
    standard = Quality("standard", frozenset({"environment_shadows", "ndf"}), lights=16)
    assert standard.applied(given) == replace(given, **POINTS["standard"] | {"environment_shadows": "off"})
    occluded = Quality("standard").applied(Settings(ambient_occlusion="gtao"))
    assert (occluded.ambient_occlusion, occluded.environment_shadows) == ("gtao", "off")
    assert Quality("standard").applied(given).environment_shadows == POINTS["standard"]["environment_shadows"]
    for mode in ("phong", "path"):
        other = Settings(mode=mode)
        assert standard.applied(other) == other and standard.facts(other) == {}


def options_of(changes) -> list[str]:
    return [word for name, value in changes.items() for word in ("--set", f"{name.replace('_', '-')}={value}")]


def test_the_command_line_draws_the_point_and_what_is_set_wins(run, folder):
    def picture(*options: str) -> np.ndarray:
        outcome = run("render", MODEL, "-o", "a.exr", "--background", "none", *SMALL, *options, "--stats", "s.json")
        assert (outcome.status, outcome.err) == (0, "")
        return Image.open(folder / "a.exr").linear

    point = POINTS["standard"]
    plain, edges = picture("--quality", "draft"), picture("--set", f"antialias={point['antialias']}")
    standard = picture("--quality", "standard")
    assert json.loads((folder / "s.json").read_text())["plan"]["quality"] == "standard"
    assert np.array_equal(standard, picture("--quality", "draft", *options_of(point)))
    assert not np.array_equal(standard, plain) and not np.array_equal(standard, edges)
    assert np.array_equal(picture("--quality", "standard", "--set", " environment_shadows =off"), edges)


@pytest.mark.parametrize("options, error", [
    (("--mode", "phong"), "quality has no effect in mode phong, only in mode pbr"),
    (("--mode", "path", "--spp", "1"), "quality has no effect in mode path, only in mode pbr"),
    (("--time-budget", "1"), "quality has no effect together with a time budget or an error: these choose the method"),
    (("--error", "0.1"), "quality has no effect together with a time budget or an error: these choose the method"),
])
def test_where_there_is_no_quality_it_is_refused(run, folder, options, error):
    outcome = run("render", MODEL, "-o", "a.png", *SMALL, "--quality", "high", *options)
    assert (outcome.status, outcome.error) == (2, error) and not (folder / "a.png").exists()


def test_info_plans_the_quality_and_says_so(run, folder):
    outcome = run("info", MODEL, "--quality", "standard", "--json", "-")
    plan = json.loads(outcome.out)["plan"]
    assert plan["quality"] == "standard" and "visibility" in plan["passes"]
    assert "visibility" not in describe_scene(ROOM, Settings())["plan"]["passes"]
    assert "quality" not in describe_scene(ROOM, Settings(mode="phong"))["plan"]
    assert run("info", MODEL, "--quality", "high", "--mode", "path").error == \
        "quality has no effect in mode path, only in mode pbr"


def test_python_has_the_same_points():
    point = POINTS["standard"]
    image = viewer.render(ROOM, (24, 16), quality="standard")
    assert image.stats["plan"]["quality"] == "standard"
    assert np.array_equal(image.linear, viewer.render(ROOM, (24, 16), quality="draft", **point).linear)
    off = viewer.render(ROOM, (24, 16), quality="standard", environment_shadows="off")
    edges = viewer.render(ROOM, (24, 16), antialias=point["antialias"], quality="draft")
    assert np.array_equal(off.linear, edges.linear)
    assert not np.array_equal(off.linear, image.linear)
    with pytest.raises(UsageError, match="quality='best': quality must be one of auto, draft, standard, high"):
        viewer.render(ROOM, (24, 16), quality="best")
    with pytest.raises(UsageError, match="quality has no effect in mode phong"):
        viewer.render(ROOM, (24, 16), quality="high", mode="phong")


def test_auto_takes_what_the_rule_foresees_and_says_so(run, folder, monkeypatch):
    for lights, point in ((0, "draft"), (16, "standard"), (64, "standard")):
        monkeypatch.setattr("viewer.plan.first_picture.FirstPicture.lights", lights)
        image = viewer.render(ROOM, (24, 16), quality="auto")
        by_hand = {"environment_shadows": str(lights)} if lights else {}
        assert np.array_equal(image.linear, viewer.render(ROOM, (24, 16), quality=point, **by_hand).linear)
        plan = image.stats["plan"]
        assert plan["quality"] == point and "a draft's time" in plan["quality_reason"]
        assert ("visibility" in plan["passes"]) == (point == "standard")
        assert ("with 16 of 64 lights" in plan["quality_reason"]) == (lights < 64)
        outcome = run("render", MODEL, "-o", "a.png", *SMALL, "--quality", "auto", "--stats", "s.json", "-v")
        assert outcome.status == 0 and f"quality {point}; quality_reason standard" in outcome.err
        assert json.loads((folder / "s.json").read_text())["plan"]["quality"] == point
        facts = json.loads(run("info", MODEL, "--quality", "auto", "--json", "-").out)["plan"]
        assert facts["quality"] == point and "estimated" in facts["quality_reason"]


def test_auto_is_a_draft_where_somebody_chooses_by_hand_and_where_no_light_is_shown():
    def auto(**settings) -> Quality:
        return Quality.of("auto", settings, Settings.of(**settings), ROOM, (32, 24))

    assert auto().name == "standard" and auto(exposure=1.0).name == "standard"
    for settings in ({"environment_shadows": "16"}, {"antialias": "none"}, {"ambient_occlusion": "gtao"}):
        quality = auto(**settings)
        assert quality.name == "draft" and quality.reason == f"{next(iter(settings))} chosen by hand"
        assert quality.applied(Settings.of(**settings)) == Settings.of(**settings)
    assert auto(refraction="traced").name == "standard"  # ROOM has no solid glass: the picture is the same
    assert auto(show="normal").reason == "no light is shown"
    assert not auto(mode="path").facts(Settings(mode="path"))


def test_auto_is_the_default_outside_of_pytest(monkeypatch):
    """In it, the plugin has set the variable that names another."""
    assert viewer.render(ROOM, (24, 16)).stats["plan"]["quality"] == "draft"
    monkeypatch.delenv("PBR_VIEWER_QUALITY")
    auto = viewer.render(ROOM, (24, 16)).stats["plan"]
    assert auto["quality"] == "standard" and auto["quality_reason"]
    monkeypatch.setenv("PBR_VIEWER_QUALITY", "best")
    with pytest.raises(UsageError, match="PBR_VIEWER_QUALITY='best': quality must be one of auto, draft"):
        viewer.render(ROOM, (24, 16))


def test_the_frames_of_a_film_have_one_quality(run, folder, monkeypatch):
    """It is found once."""
    asked = []
    monkeypatch.setattr("viewer.plan.first_picture.FirstPicture.lights",
                        property(lambda first: asked.append(first) or 16))
    options = ("--turntable", "3", "--quality", "auto", "--stats", "s.json")
    assert run("render", MODEL, "-o", "a.webp", *SMALL, *options).status == 0
    assert len({id(first) for first in asked}) == 1
    assert json.loads((folder / "s.json").read_text())["plan"]["quality"] == "standard"
