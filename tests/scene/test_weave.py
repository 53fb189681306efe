"""Weaves: read from JSON, refused in one line, and put on the materials of a scene."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from shapes import plate, scene, sphere

from viewer.errors import InputError, UsageError
from viewer.plan.unused import unused_settings
from viewer.ranges import WEAVE_NAMES
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.scene.weave import WEAVES, Weave, Yarn, read_weave
from viewer.scene.woven import woven
from viewer.settings import Settings

PLAIN = {"draft": ["10", "01"]}


def written(path, data) -> Weave:
    file = path / "own.json"
    text = data if isinstance(data, (str, bytes)) else json.dumps(data)
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_weave(file)


def test_a_weave_is_read(tmp_path):
    assert written(tmp_path, PLAIN) == Weave(((True, False), (False, True)))
    assert written(tmp_path, "\ufeff" + json.dumps(PLAIN)) == written(tmp_path, PLAIN)
    full = {"draft": ["110", "011"], "density": [10, 20.5],
            "warp": {"color": [0.1, 0.2, 0.3], "specular": [0.3, 0, 0], "roughness": 0.5, "thickness": 2, "through": 1,
                     "twist": -20, "bend": 0, "width": 1}}
    found = written(tmp_path, full | {"draft": ["110", "011", "101"]})
    assert found.density == (10, 20.5) and found.weft == Yarn() and found.has_gaps is False
    assert found.warp == Yarn((0.1, 0.2, 0.3), (0.3, 0.0, 0.0), 0.5, 2.0, 1.0, -20.0, 0.0, 1.0)


@pytest.mark.parametrize("name", WEAVE_NAMES)
def test_the_named_weaves_are_valid(name, tmp_path):
    """They are what a file could say, too."""
    weave = WEAVES[name]
    yarns = {kind: {field: list(value) if isinstance(value, tuple) else value for field, value in vars(yarn).items()}
             for kind, yarn in (("warp", weave.warp), ("weft", weave.weft))}
    draft = ["".join("01"[above] for above in row) for row in weave.draft]
    assert written(tmp_path, {"draft": draft, "density": list(weave.density), **yarns}) == weave
    assert set(WEAVES) == set(WEAVE_NAMES)


@pytest.mark.parametrize(("data", "problem"), [
    ("{", "line 1: not valid JSON: "),
    ("[" * 100_000, "not valid JSON: nested too deeply"),
    ("1" * 5000, "not valid JSON: a number has thousands of digits"),
    (b"\xff", "byte 0: the JSON is not valid UTF-8"),
    ([], "it must be an object"),
    ({}, "draft: it is missing"),
    ({"draft": ["10"]}, "draft: it must be a list of 2 to 16 rows"),
    ({"draft": ["10", "01"] * 9}, "draft: it must be a list of 2 to 16 rows"),
    ({"draft": ["10", 1]}, 'draft[1]: a row must be 2 to 16 of the characters "0" and "1"'),
    ({"draft": ["10", "0x"]}, 'draft[1]: a row must be 2 to 16 of the characters "0" and "1"'),
    ({"draft": ["10", "011"]}, "draft[1]: it has 3 yarns, and the first row 2"),
    ({"draft": ["10", "11"]}, "draft[1]: this weft yarn never crosses to the other side: the weave does not hold "
                              "together"),
    ({"draft": ["110", "101"]}, "draft, column 0: this warp yarn never crosses to the other side: the weave does not "
                                "hold together"),
    (PLAIN | {"colour": 1}, "there is no key 'colour'; choose from density, draft, warp, weft"),
    (PLAIN | {"weft": {"width": 1.2}}, "weft.width: a yarn is not wider than its cell, which is 1"),
    (PLAIN | {"warp": {"ply": 3}}, "warp: there is no key 'ply'; choose from bend, color, "),
    (PLAIN | {"warp": 3}, "warp: it must be an object"),
    (PLAIN | {"warp": {"roughness": 0}}, "warp.roughness: it must be a number from 0.02 to 1"),
    (PLAIN | {"warp": {"twist": True}}, "warp.twist: it must be a number from -60 to 60"),
    ('{"draft": ["10", "01"], "warp": {"bend": NaN}}', "not valid JSON: NaN is not a number"),
    (PLAIN | {"warp": {"color": [1, 2]}}, "warp.color: it must be three numbers, linear red, green and blue"),
    (PLAIN | {"warp": {"color": [1, 0, 2]}}, "warp.color[2]: it must be a number from 0 to 1"),
    (PLAIN | {"density": [1]}, "density: it must be two numbers"),
    (PLAIN | {"density": [1, 10**400]}, "density[1]: it must be a number from 1e-06 to 1e+06"),
    (PLAIN | {"weft": {"width": 10**400}}, "weft.width: a yarn is not wider than its cell"),
    (PLAIN | {"density": [1, 0]}, "density[1]: it must be a number from 1e-06 to 1e+06"),
])
def test_what_is_no_weave_is_refused_in_one_line(data, problem, tmp_path):
    with pytest.raises(InputError) as caught:
        written(tmp_path, data)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'own.json'}: {problem}") and "\n" not in message
    with pytest.raises(InputError, match="no such file"):
        read_weave(tmp_path / "none.json")
    with pytest.raises(InputError, match="is a folder, not a file"):
        read_weave(tmp_path)


def test_materials_become_woven():
    model = scene(plate(0), plate(1), materials=[Material(name="a"), Material(name="b, c")])
    assert woven(model, Settings()) is model and woven(model, Settings.of(mode="phong", weave="plain")) is model
    whole = woven(model, Settings.of(weave="twill"))
    assert [material.weave for material in whole.materials] == [WEAVES["twill"]] * 2
    assert woven(model, Settings.of(weave="twill")) is whole and woven(whole, Settings.of(weave="twill")) is whole
    part = woven(model, Settings.of(weave="plain,b, c"))
    assert part.materials[0] is model.materials[0] and part.materials[1].weave == WEAVES["plain"]
    assert part.materials[1].name == "b, c" and part.materials[1].alpha_mode == "blend"
    with pytest.raises(UsageError, match="^weave: there is no material '[^']+' in 'test'; "):
        woven(model, Settings.of(weave="plain,d"))
    with pytest.raises(UsageError, match="in 'test'; none of its materials has a name$"):
        woven(scene(plate(0)), Settings.of(weave="plain,d"))
    bare = scene(replace(plate(0), uvs=()), sphere(1), materials=[Material(name="a"), Material(name="b")])
    with pytest.raises(UsageError, match="has no texture coordinates, by which yarns are laid"):
        woven(bare, Settings.of(weave="plain"))


def test_a_scene_without_triangles_is_told_that_nothing_is_woven():
    settings = Settings(weave="denim")
    assert unused_settings(Scene("empty"), settings) == ["weave has no effect: there are no triangles"]
    assert unused_settings(scene(plate(0)), settings) == []
