"""What `info` tells, as JSON and as text."""

from __future__ import annotations

import json

import pytest
from command_line import SCENES

from viewer.jobs.assemble import make_light
from viewer.jobs.info import describe_package, describe_scene, format_facts, format_settings, settings_table
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene
from viewer.settings import Settings, setting_choices, setting_meanings


@pytest.fixture(scope="module")
def facts():
    scene = load_scene(SCENES / "lights.glb")
    lights = (*scene.lights, make_light((0, 9, 3)))
    return describe_scene(scene.relit(environment=load_environment("furnace"), lights=lights), Settings())


def test_the_facts_are_those_of_the_scene(facts):
    scene = load_scene(SCENES / "lights.glb")
    assert facts["triangles"] == scene.triangle_count > 0
    assert facts["vertices"] == sum(len(mesh.positions) for mesh in scene.meshes)
    assert facts["bounds_m"] == scene.bounds.tolist() and facts["radius_m"] == scene.radius
    assert len(facts["materials"]) == len(scene.materials) and len(facts["lights"]) == len(scene.lights) + 1
    assert facts["lights"][-1] == "directional --light, 3 lx" and facts["environment"].startswith("furnace, ")
    assert facts["plan"]["lights"] == len(scene.lights) + 1


def test_they_are_plain_json(facts):
    assert json.loads(json.dumps(facts, allow_nan=False)) == facts
    assert json.loads(json.dumps(describe_package(), allow_nan=False))["models"].count("glb gltf") == 1


def test_the_plan_follows_the_settings():
    scene = load_scene(SCENES / "unlit.glb")
    assert "background" not in describe_scene(scene, Settings())["plan"]["passes"]
    lit = scene.relit(environment=load_environment("furnace"))
    assert "background" in describe_scene(lit, Settings())["plan"]["passes"]
    left_out = describe_scene(lit, Settings(background="none"))["plan"]["left_out"]
    assert "the environment as background: not requested" in left_out


def test_text_has_a_line_for_each_fact():
    text = format_facts({"name": "a", "size_m": 0.25, "none": [], "box": [[1.0, 2.0], [3.0, 4.0]],
                         "list": ["x", {"k": 1}, ""], "table": {"inner": 1.23456789}})
    assert text.splitlines() == ["name: a", "size m: 0.25", "none: none", "box: 1  2  3  4",
                                 "list:", "  - x", "  - k 1", "  - (unnamed)", "table:", "  inner: 1.23457"]


def test_every_setting_is_listed_with_its_choices():
    text, rows = format_settings(), {row["name"]: row for row in settings_table()}
    assert list(rows) == list(setting_meanings())
    assert rows["bounces"]["range"] == [1, 255] and rows["bounces"]["default"] == 32
    assert "--set bounces=N, a whole number from 1 to 255\n" in text
    assert "--set hair-melanin=EU,PHEO, none or two numbers from 0 to 1000\n" in text
    assert rows["hair_melanin"]["default"] is None and "default: none\n--set hair-color=R,G,B, none or" in text
    for name, choices in setting_choices().items():
        assert f"--set {name.replace('_', '-')}={'|'.join(choices)}\n" in text
