"""KHR_animation_pointer: what is drawn moves, what is not there is a warning that names it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.scene.gltf.pointers import _KINDS
from viewer.scene.schema import MAPS, PARAMETERS, needs_tangents

LIGHTS, TRANSFORM = "KHR_lights_punctual", "KHR_texture_transform"


def pointing(moves, **top_level):
    """A triangle of the first material; `moves` are pairs of a pointer and its values at 0 s and at 1 s."""
    builder = GltfBuilder(extensionsUsed=["KHR_animation_pointer"], **top_level)
    add_animation(builder, moves)
    return builder


def add_animation(builder, moves):
    samplers, channels = [], []
    for pointer, values in moves:
        samplers.append({"input": builder.accessor([0, 1]), "output": builder.accessor(np.float32(values))})
        channels.append({"sampler": len(samplers) - 1, "target": {
            "path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}})
    builder.add("animations", {"samplers": samplers, "channels": channels})


def with_material(moves, **material):
    builder = pointing(moves, materials=[{}, material])
    builder.node(mesh=builder.triangle(material=1))
    return builder


def test_parameters_of_a_material():
    base = "/materials/1/pbrMetallicRoughness"
    moves = [(f"{base}/baseColorFactor", [[0, 0, 0, 1], [1, 0.5, 0, 1]]), (f"{base}/roughnessFactor", [0, 3]),
             ("/materials/1/extensions/KHR_materials_ior/ior", [1.5, 2.5])]
    scene = with_material(moves, extensions={"KHR_materials_ior": {"ior": 1.4}}).load()
    assert scene.warnings == () and scene.materials[0].ior == 1.4
    moved = scene.at(0.5).materials[0]
    assert moved.base_color == pytest.approx((0.5, 0.25, 0, 1)) and moved.ior == pytest.approx(2)
    assert moved.perceptual_roughness == 1, "1.5 is beyond the range"
    pose = scene.at(0.5)
    assert pose.meshes is scene.meshes and pose.instances is scene.instances
    assert pose.at(0.5).materials is pose.materials


def test_emission_is_multiplied_by_its_strength():
    strength = "KHR_materials_emissive_strength"
    moves = [(f"/materials/1/extensions/{strength}/emissiveStrength", [0, 10])]
    scene = with_material(moves, emissiveFactor=[1, 0.5, 0], extensions={strength: {"emissiveStrength": 3}}).load()
    assert scene.materials[0].emissive == (3, 1.5, 0)
    assert scene.at(0.5).materials[0].emissive == pytest.approx((5, 2.5, 0))
    moves.append(("/materials/1/emissiveFactor", [[0, 0, 0], [0, 0, 1]]))
    scene = with_material(moves, emissiveFactor=[1, 0.5, 0], extensions={strength: {"emissiveStrength": 3}}).load()
    assert scene.at(0.5).materials[0].emissive == pytest.approx((0, 0, 2.5))


def test_an_animation_leaves_nothing_behind_for_another():
    builder = with_material([("/materials/1/pbrMetallicRoughness/metallicFactor", [0, 1])],
                            pbrMetallicRoughness={"metallicFactor": 0.25})
    add_animation(builder, [("/materials/1/alphaCutoff", [0, 1])])
    scene = builder.load()
    assert scene.at(1).materials[0].metallic == 1
    assert scene.at(1).at(1, 1).materials[0].metallic == 0.25


def test_texture_transforms():
    builder = pointing([(f"/materials/0/normalTexture/extensions/{TRANSFORM}/{name}", values) for name, values in (
        ("offset", [[0, 0], [1, 2]]), ("rotation", [0, 1]), ("scale", [[1, 1], [3, 5]]))])
    info = {"index": builder.texture(), "extensions": {TRANSFORM: {"offset": [0.5, 0]}}}
    material = builder.add("materials", {"normalTexture": info})
    attributes = {"POSITION": builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
                  "NORMAL": builder.accessor([[0, 0, 1]] * 3), "TEXCOORD_0": builder.accessor([[0, 0], [1, 0], [0, 1]])}
    builder.node(mesh=builder.mesh(attributes, material=material))
    scene = builder.load()
    still, moved = scene.materials[0].normal_texture, scene.at(0.5).materials[0].normal_texture
    assert moved.image is still.image
    assert moved.transform.offset == (0.5, 1) and moved.transform.rotation == 0.5 and moved.transform.scale == (2, 3)


@pytest.mark.parametrize("pointer, material", [
    ("normalTexture/scale", {"normalTexture": {"index": 0, "scale": 0}}),
    ("extensions/KHR_materials_clearcoat/clearcoatFactor",
     {"extensions": {"KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 0}}}}),
    ("extensions/KHR_materials_anisotropy/anisotropyStrength", {"extensions": {"KHR_materials_anisotropy": {}}}),
])
def test_a_mesh_has_tangents_for_what_is_turned_on_later(pointer, material):
    """At rest the material needs none."""
    builder = pointing([(f"/materials/0/{pointer}", [0, 1])], materials=[material])
    builder.texture()
    attributes = {"POSITION": builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
                  "NORMAL": builder.accessor([[0, 0, 1]] * 3), "TEXCOORD_0": builder.accessor([[0, 0], [1, 0], [0, 1]])}
    builder.node(mesh=builder.mesh(attributes, material=0))
    scene = builder.load()
    assert not needs_tangents(scene.materials[0]) and needs_tangents(scene.at(1).materials[0])
    assert scene.meshes[0].tangents is not None
    builder.json["animations"][0]["samplers"][0]["output"] = builder.accessor([0, 0])
    del builder.json["buffers"]
    assert builder.load().meshes[0].tangents is None


@pytest.mark.parametrize("pointer, value", [
    ("intensity", -2), ("color", [1, -1, 1]), ("range", -1), ("spot/innerConeAngle", 9), ("spot/outerConeAngle", -1),
    ("spot/outerConeAngle", 9)])
def test_a_light_stays_one_that_may_be(pointer, value):
    builder = pointing([(f"/extensions/{LIGHTS}/lights/0/{pointer}", [value, value])],
                       extensions={LIGHTS: {"lights": [{"type": "spot"}]}})
    builder.node(mesh=builder.triangle())
    builder.node(extensions={LIGHTS: {"light": 0}})
    light, = builder.load().at(0.5).lights
    assert light.intensity >= 0 and min(light.color) >= 0 and 0 <= light.inner_cone <= light.outer_cone <= 1.5708


def test_lights():
    lamp = {"type": "spot", "intensity": 4, "range": 7, "spot": {"outerConeAngle": 0.5}}
    base = f"/extensions/{LIGHTS}/lights/0"
    moves = [(f"{base}/color", [[1, 1, 1], [0, 1, 0]]), (f"{base}/intensity", [0, 9]), (f"{base}/range", [0, 3]),
             (f"{base}/spot/outerConeAngle", [0.2, 0.4]), (f"{base}/spot/innerConeAngle", [0.2, 0.8])]
    builder = pointing(moves, extensions={LIGHTS: {"lights": [lamp]}})
    for x in (1, 2):
        builder.node(translation=[x, 0, 0], extensions={LIGHTS: {"light": 0}})
    builder.node(mesh=builder.triangle())
    scene = builder.load()
    for k, light in enumerate(scene.at(1).lights):
        assert light.color == (0, 1, 0) and (light.intensity, light.range) == (9, 3)
        assert light.outer_cone == pytest.approx(0.4) and 0.39 < light.inner_cone < 0.4 and light.position[0] == k + 1
    assert scene.at(0).lights[0].range is None and scene.lights[0].range == 7


def test_cameras():
    moves = [("/cameras/0/perspective/yfov", [0.5, 1.5]), ("/cameras/1/orthographic/ymag", [1, 3])]
    builder = pointing(moves, cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}},
                                       {"type": "orthographic", "orthographic": {"ymag": 5}}])
    builder.node(camera=0)
    builder.node(camera=1)
    builder.node(mesh=builder.triangle())
    first, second = builder.load().at(0.5).cameras
    assert first.fov_y == 1 and first.near == pytest.approx(0.1) and second.height == 4


def test_nodes_and_weights():
    builder = GltfBuilder(extensionsUsed=["KHR_animation_pointer"])
    targets = [{"POSITION": builder.accessor(np.float32([[0, 0, z]] * 3))} for z in (1, 10)]
    mesh = builder.mesh({"POSITION": builder.accessor(np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))}, targets=targets)
    builder.json["meshes"][mesh]["weights"] = [0.5, 0]
    shown, own = builder.node(mesh=mesh), builder.node(mesh=mesh, weights=[1, 0])
    half = math.sqrt(0.5)
    add_animation(builder, [(f"/meshes/{mesh}/weights", [0, 0, 1, 1]), (f"/nodes/{own}/weights/1", [0, 1]),
                            (f"/nodes/{shown}/rotation", [[0, 0, 0, 1], [0, 0, half, half]])])
    pose = builder.load().at(1)
    assert pose.meshes[0].positions[:, 2].tolist() == [11] * 3 and pose.meshes[1].positions[:, 2].tolist() == [11] * 3
    np.testing.assert_allclose(pose.instances[0].transform[:2, 0], [0, 1], atol=1e-6)
    add_animation(builder, [(f"/meshes/{mesh}/weights/2", [0, 1]), (f"/nodes/{own}/weights/2", [0, 1])])
    scene = builder.load()
    assert len(scene.animations) == 1 and len(scene.warnings) == 2


def test_what_is_ignored_of_a_camera_at_rest_is_left_out_in_silence():
    perspective, orthographic = {"yfov": 1, "znear": 0.1}, {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}
    moves = [(f"/cameras/0/perspective/{key}", [1, 2]) for key in ("aspectRatio", "zfar")]
    moves += [(f"/cameras/1/orthographic/{key}", [1, 2]) for key in ("xmag", "znear", "zfar")]
    builder = pointing(moves, cameras=[{"type": "perspective", "perspective": perspective},
                                       {"type": "orthographic", "orthographic": orthographic}])
    builder.node(mesh=builder.triangle())
    builder.node(camera=0)
    builder.node(camera=1)
    scene = builder.load()
    assert scene.animations == () and scene.warnings == ()
    add_animation(builder, [("/cameras/0/orthographic/xmag", [1, 2])])
    assert len(builder.load().warnings) == 1, "a perspective has none"


@pytest.mark.parametrize("pointer", [
    "/materials/7/alphaCutoff", "/materials/1/extensions/KHR_materials_ior/ior", "/materials/1/normalTexture/scale",
    "/materials/1/name", "/nodes/99/translation", "/nodes/0/colour", "/nodes/-1/scale", "/nodes/01/scale", "nonsense",
    "/cameras/0/perspective/yfov", f"/extensions/{LIGHTS}/lights/0/color", "", "/nodes/0", "/" * 5000,
    "/nodes/0/weights", "/nodes/0/weights/0", "/meshes/0/weights", "/meshes/0/weights/3"])
def test_a_pointer_to_what_is_not_there_is_named(pointer):
    scene = with_material([(pointer, [[0, 0, 0], [1, 1, 1]])]).load()
    assert scene.animations == () and len(scene.warnings) == 1
    assert f"{pointer[:80]!r} is not in the file, or is not drawn" in scene.warnings[0]


def in_material(path, value):
    """The JSON of a material with `value` at a pointer below it; textures on the way are the file's first."""
    whole = place = {"emissiveFactor": [1, 1, 1],
                     "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}}
    *objects, key = path.split("/")
    for name in objects:
        place = place.setdefault(name, {"index": 0} if name.endswith("Texture") else {})
    place[key] = value
    return whole


def numbers(material):
    """All parameters of a material and the transforms of its maps."""
    transforms = {f"{name}_texture": texture and texture.transform for name, texture in (
        (name, source.texture(material)) for name, source in MAPS.items())}
    return {name: getattr(material, name) for name in PARAMETERS} | transforms


PATHS = {path: found for kind, _, properties in _KINDS if kind == "material" for path, found in properties.items()}


@pytest.mark.parametrize("path", PATHS)
def test_what_a_pointer_moves_is_as_in_a_file_that_has_it_at_rest(path):
    found = PATHS[path]
    info = PARAMETERS[found.name].info if found.name in PARAMETERS else None
    least = max(1.0, info.low) if info is not None and info.high > 1.0 else 0.0
    first, last = (least + np.arange(1, found.size + 1) * step for step in (0.0625, 0.125))

    def material(values):
        return in_material(path, values.tolist() if found.size > 1 else values[0])

    def load(json, moves=()):
        builder = with_material(moves, **json)
        builder.texture()
        builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = builder.accessor(np.zeros((3, 2)))
        return builder.load()

    moving = load(material(first), [(f"/materials/1/{path}", [first, last])])
    assert numbers(moving.at(1).materials[0]) == numbers(load(material(last)).materials[0])
    assert numbers(moving.at(0).materials[0]) == numbers(moving.materials[0]) != numbers(moving.at(1).materials[0])


def glossy(**more):
    """The triangle's material has the archived extension, and what readers without it show."""
    return {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 1, 1], "baseColorTexture": {
                "index": 0, "extensions": {TRANSFORM: {}}}},
            "extensions": {"KHR_materials_specular": {"specularColorFactor": [1, 0, 0]}, GLOSSY: {
                "diffuseFactor": [0.5, 0.25, 0.125, 0.75], "specularFactor": [0.25, 0.5, 0.125],
                "glossinessFactor": 0.75, **more}}}


GLOSSY = "KHR_materials_pbrSpecularGlossiness"
MAP = {"specularGlossinessTexture": {"index": 0}}


@pytest.mark.parametrize("more", [{}, MAP], ids=["factors", "map"])
@pytest.mark.parametrize("moved", [{"diffuseFactor": [1, 0.5, 0.25, 0]}, {"specularFactor": [1, 0, 0]},
                                   {"glossinessFactor": 0.25}])
def test_factors_of_specular_and_glossiness(moved, more):
    """One is moved, and the others stay: without a map all are converted together."""
    (name, value), = moved.items()
    beyond = np.multiply(value, 2)  # values beyond the range are clamped
    builder = with_material([(f"/materials/1/extensions/{GLOSSY}/{name}", [value, beyond])], **glossy(**more))
    builder.texture()
    still = with_material([], **glossy(**more, **moved))
    still.texture()
    scene = builder.load()
    assert numbers(scene.at(0).materials[0]) == numbers(still.load().materials[0])
    assert not any("pointer" in warning for warning in scene.warnings)
    clamped = with_material([], **glossy(**more, **{name: np.clip(beyond, 0, 1).tolist()}))
    clamped.texture()
    assert numbers(scene.at(1).materials[0]) == numbers(clamped.load().materials[0])


@pytest.mark.parametrize("pointer", [
    "pbrMetallicRoughness/baseColorFactor", "pbrMetallicRoughness/metallicFactor",
    f"pbrMetallicRoughness/baseColorTexture/extensions/{TRANSFORM}/offset",
    "extensions/KHR_materials_specular/specularColorFactor", f"extensions/{GLOSSY}/specular",
    f"extensions/{GLOSSY}/diffuseTexture/extensions/{TRANSFORM}/offset"])
def test_what_specular_and_glossiness_take_the_place_of_is_not_drawn(pointer):
    builder = with_material([(f"/materials/1/{pointer}", [[0, 0, 0], [1, 1, 1]])], **glossy())
    builder.texture()
    scene = builder.load()
    assert scene.animations == () and sum("pointer" in warning for warning in scene.warnings) == 1


def test_every_parameter_and_map_of_a_material_has_a_pointer():
    names = {found.name for found in PATHS.values()}
    assert set(PARAMETERS) <= names
    assert {f"{name}_texture.{part}" for name in MAPS for part in ("offset", "rotation", "scale")} <= names
