"""KHR_materials_variants and several scenes: what is chosen is shown, and a choice costs only the materials."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest
from gltf_builder import GltfBuilder

import viewer
from viewer.errors import InputError, UsageError
from viewer.image.image import Image
from viewer.interact.state import ViewState
from viewer.scene.gltf.variants import VARIANTS

COLORS = {"red": [1, 0, 0, 1], "green": [0, 1, 0, 1], "blue": [0, 0, 1, 1]}


def varied(*mappings: dict, names=("Day", "Night"), own: int = 0, **material) -> GltfBuilder:
    """A triangle of material `own` with these mappings, and one that is red in all variants."""
    builder = GltfBuilder(extensionsUsed=[VARIANTS], extensionsRequired=[VARIANTS])
    builder.json["extensions"] = {VARIANTS: {"variants": [{"name": name} for name in names]}}
    for name, color in COLORS.items():
        extra = material.get(name, {})
        builder.add("materials", {"name": name, "pbrMetallicRoughness": {"baseColorFactor": color}, **extra})
    extensions = {VARIANTS: {"mappings": list(mappings)}}
    builder.node(mesh=builder.triangle(material=own, extensions=extensions), name="varied")
    builder.node(mesh=builder.triangle(material=0), name="same")
    return builder


BOTH = {"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}


def names(scene) -> list[str]:
    """The material of each instance."""
    return [scene.materials[scene.meshes[instance.mesh].material].name for instance in scene.instances]


def test_a_variant_changes_materials_alone():
    scene = varied(*BOTH).load()
    assert [variant.name for variant in scene.variants] == ["", "Day", "Night"]
    assert scene.variant == "" and names(scene) == ["red", "red"]
    for name, color in (("Day", "green"), ("Night", "blue"), ("", "red")):
        shown = scene.with_variant(name)
        assert shown.variant == name and names(shown) == [color, "red"]
        assert shown.meshes is scene.meshes and shown.instances is scene.instances
        assert shown.with_variant("Night").with_variant(name).materials is shown.materials or name == "Night"


def test_a_primitive_without_a_mapping_keeps_its_material():
    scene = varied({"material": 1, "variants": [1]}).load()
    assert names(scene.with_variant("Day")) == ["red", "red"] and names(scene.with_variant("Night"))[0] == "green"


def test_without_variants_there_is_no_choice():
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    scene = builder.load()
    assert scene.variants == () and scene.with_variant("") is scene
    with pytest.raises(UsageError, match="no variant 'Day'; the file has no variants"):
        scene.with_variant("Day")


def test_vertices_suit_every_variant():
    """Only the second variant has a texture, with the second set of coordinates; its normal map needs tangents."""
    info = {"index": 0, "texCoord": 1}
    builder = varied(*BOTH, blue={"normalTexture": info})
    builder.texture()
    primitive = builder.json["meshes"][0]["primitives"][0]["attributes"]
    primitive["TEXCOORD_0"] = primitive["TEXCOORD_1"] = builder.accessor([[0, 0], [1, 0], [0, 1]])
    mesh = builder.load().meshes[0]
    assert len(mesh.uvs) == 2 and mesh.tangents is not None


def test_a_scene_with_variants_can_be_sent_to_processes():
    scene = pickle.loads(pickle.dumps(varied(*BOTH).load()))
    assert names(scene.with_variant("Night")) == ["blue", "red"]


def test_animated_materials_are_those_of_the_variant():
    builder = varied(*BOTH)
    pointer = "/materials/2/pbrMetallicRoughness/baseColorFactor"
    sampler = {"input": builder.accessor([0, 1]), "output": builder.accessor([[0, 0, 1, 1], [1, 1, 1, 1]])}
    builder.json["animations"] = [{"samplers": [sampler], "channels": [{"sampler": 0, "target": {
        "path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}}]}]
    scene = builder.load()
    assert scene.at(1.0).materials is scene.materials, "the blue material is not shown"
    night = scene.with_variant("Night")
    slot = night.meshes[0].material
    assert night.materials[slot].base_color == (0, 0, 1, 1) and night.at(1.0).materials[slot].base_color == (1, 1, 1, 1)


@pytest.mark.parametrize("mapping, place", [
    ({"material": 7, "variants": [0]}, r"mappings\[0\]\.material: index 7"),
    ({"variants": [0]}, r"mappings\[0\]\.material: is missing"),
    ({"material": 1, "variants": [2]}, r"variants\[0\]: index 2"),
    ({"material": 1, "variants": 0}, "variants: must be")])
def test_bad_mappings_name_their_place(mapping, place):
    with pytest.raises(InputError, match=r"primitives\[0\]\.extensions\.KHR_materials_variants.*" + place):
        varied(mapping).load()


def test_names_that_are_not_unique_and_variants_mapped_twice():
    scene = varied(*BOTH, {"material": 0, "variants": [1]}, names=("Day", "Day", "")).load()
    assert [variant.name for variant in scene.variants] == ["", "Day", "Day 1", "2"]
    assert names(scene.with_variant("Day 1"))[0] == "blue" and len(scene.warnings) == 3


def test_many_variants_are_refused():
    with pytest.raises(InputError, match="5000 variants; the limit is 1024"):
        varied(names=[str(k) for k in range(5000)]).load()


def test_the_window_chooses_one():
    state = ViewState(varied(*BOTH).load(), viewer.Settings())
    state.toggle_furnace()
    state.choose_variant("Night")
    assert state.before_furnace is None and names(state.scene) == ["blue", "red"]
    state.choose_variant("")
    assert names(state.scene) == ["red", "red"]


@pytest.fixture
def model(folder):
    """Variants, and a second scene, called "Empty", with one of the two triangles."""
    builder = varied(*BOTH)
    builder.add("scenes", {"name": "One", "nodes": [1]})
    (folder / "a.glb").write_bytes(builder.glb())
    return folder / "a.glb"


def test_options(run, model):
    plain = ("render", "a.glb", "-o", "a.png", "--size", "24", "--env", "furnace", "--background", "none")
    for option, color in ((("--variant", "Night"), 2), (("--variant", "Day"), 1), (("--scene", "1"), 0)):
        outcome = run(*plain, *option)
        assert (outcome.status, outcome.err) == (0, "")
        seen = Image.open("a.png").srgb.astype(int)[12, 10]
        assert seen[3] == 255 and np.argmax(seen[:3]) == color
    scene = viewer.load(model, environment=None, scene="One", variant="Night")
    assert names(scene) == ["red"] and len(viewer.load(model, scene=0).instances) == 2


def test_info_lists_them(run, model):
    run("info", "a.glb", "--variant", "Night", "--json", "a.json")
    facts = json.loads((model.parent / "a.json").read_text())
    assert facts["variants"] == ["Day", "Night"] and facts["scenes"] == ["", "One"]
    assert facts["materials"][0].startswith("blue")


@pytest.mark.parametrize("options, words", [
    (("--variant", "Dusk"), "a.glb: variants: there is no variant 'Dusk'; there are Day, Night"),
    (("--scene", "7"), "a.glb: scenes: there is no scene 7; there are, counted from 0: 0, One"),
    (("--scene", "Two"), "a.glb: scenes: there is no scene 'Two'"),
    (("--scene", ""), "a.glb: scenes: there is no scene ''; there are, counted from 0: 0, One")])
def test_what_is_not_there_is_one_line(run, model, options, words):
    outcome = run("info", "a.glb", *options)
    assert outcome.status == 1 and words in outcome.err and outcome.err.count("\n") == 1


def test_other_formats_have_one_scene_and_no_variants(run, folder):
    (folder / "a.off").write_text("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert run("info", "a.off", "--scene", "0").status == 0
    for options, words in ((("--scene", "1"), "only glTF has several"), (("--variant", "x"), "has no variants")):
        outcome = run("info", "a.off", *options)
        assert outcome.status == 1 and words in outcome.err and outcome.err.count("\n") == 1
