"""What a plan leaves out, and that every program it may ask for compiles."""

from __future__ import annotations

import random
from dataclasses import replace
from io import BytesIO
from itertools import combinations

import numpy as np
import pytest
from contexts import open_or_skip
from PIL import Image

from benchmarks.shader_code import lines_left
from viewer.errors import UsageError
from viewer.gpu.programs import Programs
from viewer.plan.planner import MAX_LIGHTS, MAX_SHADOW_LAYERS, environment_use, plan_scene
from viewer.plan.sharing import MIN_PROGRAMS_TO_SHARE
from viewer.plan.warnings import picture_warnings
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material, Sampler, Texture, UVTransform
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.schema import MAPS
from viewer.scene.texture_image import TextureImage, open_texture_image
from viewer.scene.volume import Volume
from viewer.settings import VALUES, Settings, setting_choices

ENVIRONMENT = Environment("grey", np.ones((16, 32, 3), np.float32))
SUN = Light.from_angles(0.0, 0.5, 1.0)
MAP = Texture(TextureImage("none", b"", 16, 16, "PNG"))  # never decoded: nothing is drawn here
BOX = Volume.in_box(np.ones((2, 2, 2), np.float32), [[0, 0, 0], [1, 1, 1]])
PLAIN = Material()


def scene(material: Material = PLAIN, *, topology: str = "triangles", tangents: bool = True, uvs: int = 1,
          colors: bool = False, lit: bool = True, **fields) -> Scene:
    corner = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = Mesh("mesh", corner, 0, topology, normals=np.float32([[0, 0, 1]] * 3) if lit else None,
                tangents=np.float32([[1, 0, 0, 1]] * 3) if tangents else None, uvs=(corner[:, :2],) * uvs,
                colors=np.ones((3, 4), np.float32) if colors else None)
    return Scene("test", (mesh,), (material,), (Instance(0, np.eye(4)),), **fields)


def plan(model: Scene, *, samples: int = 4, half: bool = True, orthographic: bool = False, **settings):
    return plan_scene(model, Settings.of(**settings), model.lights, samples=samples, half_target=half,
                      orthographic=orthographic)


def code(found) -> str:
    """The fragment shader as the compiler sees it: what the switches leave of it."""
    program = found.programs[0]
    return "\n".join(lines_left(program.fragment, dict(program.switches)))


def test_an_unlit_scene_has_no_light_of_any_kind():
    model = scene(Material(unlit=True), lights=(SUN,), environment=ENVIRONMENT)
    for mode in ("pbr", "phong"):
        found = plan(model, mode=mode)
        assert not (found.environment or found.ambient or found.dfg or found.lights or found.shadow_layer_count)
        assert {p.fragment for p in found.programs} == {"raster/unlit.frag"}
        assert found.background
        assert any("unlit" in line for line in found.left_out)


def test_lines_without_normals_are_not_lit():
    assert plan(scene(topology="lines", lit=False), mode="pbr").programs[0].fragment == "raster/unlit.frag"


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_code_for_what_is_not_there_is_not_compiled(mode):
    bare = code(plan(scene(), mode=mode))
    for word in ("u_prefiltered", "u_irradiance", "u_ambient", "u_lights", "u_shadow_map", "u_normal_map", "u_emissive",
                 "v_color", "u_alpha_cutoff", "u_occlusion_map", "v_uv0", "u_shininess"):
        assert word not in bare
    material = Material(normal_texture=MAP, occlusion_texture=MAP, emissive=(1, 1, 1), alpha_mode="mask")
    full = scene(material, colors=True, lights=(SUN,), environment=ENVIRONMENT)
    text = code(plan(full, mode=mode))
    for word in ("u_lights", "u_shadow_map", "u_normal_map", "u_emissive", "v_color", "u_alpha_cutoff",
                 "u_occlusion_map", "v_uv0", "u_prefiltered" if mode == "pbr" else "u_ambient"):
        assert word in text


def test_only_what_the_material_is_made_of():
    dielectric = code(plan(scene(Material(metallic=0.0), lights=(SUN,), environment=ENVIRONMENT)))
    metal = code(plan(scene(Material(metallic=1.0), lights=(SUN,), environment=ENVIRONMENT)))
    assert "v.metal =" not in dielectric and "v.dielectric =" in dielectric
    assert "v.metal =" in metal and "v.dielectric =" not in metal
    mixed = code(plan(scene(Material(metallic=0.5), lights=(SUN,), environment=ENVIRONMENT)))
    assert "v.metal =" in mixed and "v.dielectric =" in mixed


SCATTER_MAPS = {"scatter_strength", "multiscatter_color"}


@pytest.mark.parametrize(("change", "sampled"), [
    ({}, set(MAPS)),
    ({"emissive": (0.0, 0.0, 0.0)}, set(MAPS) - {"emissive"}),
    ({"occlusion_strength": 0.0}, set(MAPS) - {"occlusion"}),
    ({"normal_scale": 0.0}, set(MAPS) - {"normal"}),
    ({"specular": 0.0}, set(MAPS) - {"specular", "specular_color"}),
    ({"unlit": True}, {"base_color", "emissive"}),
    ({"thickness": 0.0}, set(MAPS) - {"thickness"}),
    ({"thickness": 0.0, "scatter_strength": 0.5},
     set(MAPS) - {"thickness", "diffuse_transmission", "diffuse_transmission_color"}),
    ({"thickness": 0.0, "scatter_strength": 0.5, "multiscatter_color": (0.0, 0.0, 0.0)},
     set(MAPS) - {"thickness", "diffuse_transmission", "diffuse_transmission_color", "multiscatter_color"}),
    ({"scatter_strength": 0.5}, set(MAPS)),
    ({"transmission": 0.0}, set(MAPS) - {"transmission"}),
    ({"ior": 0.0}, set(MAPS) - {"transmission"}),
    ({"anisotropy_strength": 0.0}, set(MAPS) - {"anisotropy"}),
    ({"diffuse_roughness": 0.0}, set(MAPS) - {"diffuse_roughness"}),
    ({"sheen_color": (0.0, 0.0, 0.0)}, {name for name in MAPS if "sheen" not in name}),
    ({"sheen_roughness": 0.0, "transmission": 0.0},
     set(MAPS) - {"sheen_color", "sheen_roughness", "transmission"}),
    ({"iridescence": 0.0}, {name for name in MAPS if "iridescence" not in name}),
    ({"iridescence_ior": 1.0}, {name for name in MAPS if "iridescence" not in name}),
    ({"iridescence_thickness_minimum": 400.0}, set(MAPS) - {"iridescence_thickness"}),
    ({"clearcoat": 0.0}, {name for name in MAPS if "clearcoat" not in name}),
    ({"clearcoat_roughness": 0.0}, set(MAPS) - {"clearcoat_roughness"}),
    ({"clearcoat_normal_scale": 0.0}, set(MAPS) - {"clearcoat_normal"}),
    ({"diffuse_transmission": 0.0}, set(MAPS) - {"diffuse_transmission", "diffuse_transmission_color"}),
    ({"diffuse_transmission": 0.0, "transmission": 0.0},
     set(MAPS) - {"diffuse_transmission", "diffuse_transmission_color", "transmission", "thickness"}),
])
def test_maps_that_change_no_pixel_are_not_sampled(change, sampled, monkeypatch):
    monkeypatch.setattr("viewer.plan.samplers.MAX_SAMPLERS", 99)
    full = Material(emissive=(1, 1, 1), transmission=1.0, thickness=1.0, anisotropy_strength=1.0, diffuse_roughness=1.0,
                    clearcoat=1.0, clearcoat_roughness=0.5, diffuse_transmission=0.5, sheen_color=(1, 1, 1),
                    sheen_roughness=0.5, iridescence=1.0,
                    **{f"{name}_texture": MAP for name in MAPS})
    material = replace(full, **change)
    found = plan(scene(material, environment=ENVIRONMENT))
    if material.transmits:
        sampled = sampled - {"sheen_color", "sheen_roughness"}
    if not material.scatters_thinly:
        sampled = sampled - SCATTER_MAPS
    assert set(found.draws[0].maps) == sampled
    idle = len(MAPS) - len(sampled)
    assert any(f"{idle} material map" in line for line in found.left_out) == bool(idle)


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_a_layer_is_code_only_where_a_surface_has_it(mode):
    names = {"sheen": "sheen_over", "clear coat": "coat_over", "iridescence": "film_over"}
    bare = plan(scene(Material(sheen_color=(0, 0, 1)), lights=(SUN,), environment=ENVIRONMENT), mode=mode)
    text = code(bare)
    for name, word in names.items():
        assert word not in text and (mode == "phong" or f"{name}: no surface has it" in bare.left_out)
    all_three = Material(clearcoat=1.0, sheen_color=(0, 0, 1), sheen_roughness=0.5, iridescence=1.0)
    layered = plan(scene(all_three, lights=(SUN,), environment=ENVIRONMENT), mode=mode)
    for name, word in names.items():
        assert (word in code(layered)) == (mode == "pbr")
        line = f"{name} of 1 surface" if mode == "pbr" else f"{name}: mode phong does not show it"
        assert line in (layered.used if mode == "pbr" else layered.left_out)


def test_a_coat_reflects_though_nothing_below_does():
    coated = Material(metallic=0.0, specular=0.0, clearcoat=1.0)
    assert plan(scene(coated, environment=ENVIRONMENT)).reflections
    assert plan(scene(coated, environment=ENVIRONMENT)).programs[0]["REFLECTS"]


def test_a_lobe_has_the_more_lookups_the_farther_it_is_stretched():
    def lookups(name="LOOKUPS", environment=ENVIRONMENT, settings={}, **fields):  # noqa: B006  it is only read
        return plan(scene(Material(**fields), environment=environment), **settings).programs[0][name]

    assert lookups(perceptual_roughness=0.06) == 1 and lookups(perceptual_roughness=0.061) == 2
    assert lookups(perceptual_roughness=0.3) == lookups(perceptual_roughness=0.3, metallic_roughness_texture=MAP) == 2
    assert lookups(perceptual_roughness=0.05, settings={"specular_aa": "on"}) == 2
    assert lookups(perceptual_roughness=0.05, metallic_roughness_texture=MAP) == 1
    assert lookups(perceptual_roughness=0.05, specular_glossiness_texture=MAP) == 2
    assert lookups(metallic=0.0, specular=0.0) == lookups(environment=None) == 0
    brushed = {"anisotropy_strength": 0.5}
    assert [lookups(perceptual_roughness=r, **brushed) for r in (0.7, 0.5, 0.3, 0.1)] == [4, 4, 8, 32]
    assert lookups(metallic_roughness_texture=MAP, **brushed) == 16
    coats = ((0.0, 0.5), (1.0, 0.0), (1.0, 0.5))
    assert [lookups("COAT_LOOKUPS", clearcoat=c, clearcoat_roughness=r) for c, r in coats] == [0, 1, 2]


def test_what_settings_or_surfaces_cannot_show_of_anisotropy_is_left_out_and_said_truly():
    brushed = Material(perceptual_roughness=0.2, anisotropy_strength=0.8, anisotropy_texture=MAP)
    beckmann = plan(scene(brushed, environment=ENVIRONMENT), ndf="beckmann")
    program = beckmann.programs[0]
    assert all(program[name] == 0 for name in ("ANISOTROPIC", "ANISOTROPY_MAP", "HAS_TANGENT"))
    assert program["LOOKUPS"] == 2
    assert "anisotropy: only the distribution ggx can be anisotropic" in beckmann.left_out
    unlit = plan(scene(replace(brushed, unlit=True), tangents=False, environment=ENVIRONMENT))
    assert not any("anisotropy" in line for line in unlit.left_out)
    traced = plan(scene(brushed, environment=ENVIRONMENT), reflections="traced")
    assert "traced reflections: no opaque surface is smooth and isotropic" in traced.left_out


def test_only_rough_diffuse_surfaces_have_code_for_it():
    rough = Material(metallic=0.5, diffuse_roughness=0.5, diffuse_roughness_texture=MAP)
    found = plan(scene(rough, environment=ENVIRONMENT))
    assert "f_eon" in code(found) and "u_diffuse_roughness_map" in code(found)
    for other in (Material(metallic=0.5, diffuse_roughness_texture=MAP), replace(rough, metallic=1.0)):
        text = code(plan(scene(other, environment=ENVIRONMENT)))
        assert "eon" not in text and "u_diffuse_roughness" not in text and "diffuse_axis" not in text
    phong = plan(scene(rough, environment=ENVIRONMENT), mode="phong")
    assert "eon" not in code(phong) and "diffuse roughness: mode phong does not show it" in phong.left_out


def test_only_dispersive_volumes_have_an_index_for_each_colour():
    prism = Material(metallic=0.0, transmission=1.0, thickness=1.0, dispersion=1.0)
    found = plan(scene(prism, environment=ENVIRONMENT), refraction="traced")
    assert "ior_of_bands" in code(found) and found.has_dispersion
    for other in (replace(prism, dispersion=0.0), replace(prism, thickness=0.0), replace(prism, transmission=0.0)):
        found = plan(scene(other, environment=ENVIRONMENT), refraction="traced")
        assert not any(word in code(found) for word in ("ior_of_bands", "BAND_CENTER", "u_dispersion"))
        assert not found.has_dispersion


def test_only_surfaces_that_let_light_through_have_code_for_it():
    leaf = Material(metallic=0.5, diffuse_transmission=0.5, diffuse_transmission_texture=MAP)
    light = {"environment": ENVIRONMENT, "lights": (SUN,)}
    found = plan(scene(leaf, **light))
    words = ("transmitted", "light_from_behind", "diffuse_transmission_color *", "below_probability")
    assert all(word in code(found) for word in words) and not found.has_thin_transmission
    for other in (replace(leaf, diffuse_transmission=0.0), replace(leaf, metallic=1.0)):
        assert not any(word in code(plan(scene(other, **light))) for word in words)
    wax = plan(scene(replace(leaf, thickness=1.0), **light))
    assert "crossed_solid" in code(wax) and not wax.has_solid_transmission
    phong = plan(scene(leaf, **light), mode="phong")
    assert "diffuse transmission: mode phong does not show it" in phong.left_out


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_only_a_map_of_specular_and_glossiness_is_converted(mode):
    old = Material(metallic=0.0, specular_glossiness_texture=MAP)
    found = plan(scene(old, environment=ENVIRONMENT), mode=mode)
    assert "apply_specular_glossiness" in code(found) and "u_specular_glossiness_map" in code(found)
    other = Material(metallic=0.0, specular_color=(2, 1, 1), perceptual_roughness=0.3)
    assert "specular_glossiness" not in code(plan(scene(other, environment=ENVIRONMENT), mode=mode))
    # A program that both share would convert the other, too.
    assert not any(draw.program["SPECULAR_GLOSSINESS"] for draw in plan(scene(other), plan="everything").draws)


def test_maps_without_coordinates_or_tangents_are_not_sampled():
    material = Material(base_color_texture=MAP, normal_texture=MAP, occlusion_texture=replace(MAP, uv_set=1))
    model = scene(material, uvs=1, tangents=False, environment=ENVIRONMENT)
    assert plan(model).draws[0].maps == ("base_color",)
    assert plan(replace(model, environment=None)).draws[0].maps == ("base_color",)


def test_lights_are_ordered_bounded_and_dark_ones_dropped():
    spot, point = Light("spot", intensity=1.0), Light("point", intensity=2.0)
    found = plan(scene(lights=(spot, point, SUN, Light("point", intensity=0.0), Light("point", (0, 0, 0), 3.0))))
    assert found.lights == (SUN, point, spot)
    assert found.shadow_layers == (0, 1, 7) and found.shadow_layer_count == 8
    assert plan(scene(lights=(spot, point)), shadows="off").shadow_layers == (-1, -1)
    many = plan(scene(lights=tuple(Light("point", intensity=1.0 + k) for k in range(200))))
    assert len(many.lights) == MAX_LIGHTS and min(light.intensity for light in many.lights) == 200 - MAX_LIGHTS + 1
    assert many.shadow_layer_count <= MAX_SHADOW_LAYERS


def test_glass_has_a_pass_and_code_of_its_own():
    opaque = plan(scene(Material(metallic=0.0, thickness=1.0), environment=ENVIRONMENT))
    assert not (opaque.has_solid_transmission or opaque.has_thin_transmission)
    assert "transmission" not in str(opaque.to_json()["passes"]) and "u_backdrop" not in code(opaque)
    assert any("transmissive" in line for line in opaque.left_out)
    assert not plan(scene(Material(metallic=1.0, transmission=1.0))).has_thin_transmission
    phong = plan(scene(Material(metallic=0.0, transmission=1.0)), mode="phong")
    assert not phong.has_thin_transmission and any("glass is opaque" in line for line in phong.left_out)
    thin, solid = (plan(scene(Material(metallic=0.0, transmission=1.0, thickness=t))) for t in (0.0, 1.0))
    for glass, name in ((thin, "thin-walled"), (solid, "solid")):
        assert (glass.has_thin_transmission, glass.has_solid_transmission) == (glass is thin, glass is solid)
        assert f"{name} transmission" in glass.to_json()["passes"]
        assert not any("transmissive" in line for line in glass.left_out)
    assert "u_absorption" in code(solid) and "u_absorption" not in code(thin) and "u_backdrop" in code(thin)


def test_background():
    model = scene(environment=ENVIRONMENT)
    assert plan(model).background
    assert not plan(model, background="none").background
    assert not plan(replace(model, environment=None)).background


MATERIALS = {
    "plain": (Material(metallic=0.0), {}),
    "metal": (Material(), {"tangents": False}),
    "every map": (Material(metallic=0.7, emissive=(1, 1, 1), alpha_mode="mask", double_sided=True,
                           **{f"{name}_texture": MAP for name in MAPS}), {"colors": True}),
    "two UV sets, transformed, mirrored": (
        Material(alpha_mode="blend", base_color_texture=replace(MAP, uv_set=1, sampler=Sampler("mirror", "clamp")),
                 normal_texture=replace(MAP, transform=UVTransform((0.1, 0.2), 0.5, (2, 2))),
                 metallic_roughness_texture=replace(MAP, sampler=Sampler("mirror", "mirror"))), {"uvs": 2}),
    "second UV set only": (
        Material(metallic=0.0, occlusion_texture=replace(MAP, uv_set=1), shininess=20.0), {"uvs": 2}),
    "thin glass": (Material(metallic=0.0, transmission=1.0, double_sided=True), {}),
    "glass": (Material(metallic=0.5, transmission=0.5, thickness=1.0, attenuation_distance=1.0), {}),
    "unlit": (Material(unlit=True, base_color_texture=MAP, emissive=(1, 0, 0), alpha_mode="mask"), {"colors": True}),
    "points": (Material(alpha_mode="blend"), {"topology": "points", "lit": False, "colors": True}),
    "lit lines": (Material(emissive=(1, 1, 1)), {"topology": "lines"}),
}
LIGHTS = {
    "none": (), "sun": (SUN,), "point": (Light("point"),), "spot": (Light("spot"),),
    "all": (SUN, SUN, Light("point"), Light("point"), Light("spot")), "most": (Light("point"),) * MAX_LIGHTS,
}
CHOICES = {
    "material": list(MATERIALS), "lights": list(LIGHTS), "environment": [None, 0.0, 1.0], "mode": ["pbr", "phong"],
    "samples": [1, 4], "half": [False, True], "orthographic": [False, True],
} | {name: list(values) for name, values in setting_choices().items() if name not in ("antialias", "show")}
"""A view has programs of its own: test_every_view_compiles."""


def pairwise(choices: dict[str, list], seed: int = 1) -> list[dict[str, object]]:
    """Few combinations in which every value of every choice meets every value of every other one."""
    rng = random.Random(seed)
    missing = {((a, i), (b, j)) for a, b in combinations(choices, 2)
               for i in range(len(choices[a])) for j in range(len(choices[b]))}
    rows = []
    while missing:
        best, most = None, -1
        wanted = dict(min(missing))
        for _ in range(30):
            row = {name: rng.randrange(len(values)) for name, values in choices.items()} | wanted
            met = sum(pair in missing for pair in combinations(row.items(), 2))
            if met > most:
                best, most = row, met
        missing -= set(combinations(best.items(), 2))
        rows.append({name: choices[name][k] for name, k in best.items()})
    return rows


@pytest.fixture(scope="module")
def programs():
    with open_or_skip() as context:
        yield Programs(context)


def test_every_pair_of_choices_compiles(programs):
    rows = pairwise(CHOICES)
    assert len(rows) < 150
    fragments = set()
    for row in rows:
        row = dict(row)
        material, fields = MATERIALS[row.pop("material")]
        rotation, lights = row.pop("environment"), LIGHTS[row.pop("lights")]
        environment = None if rotation is None else replace(ENVIRONMENT, rotation=rotation)
        model = scene(material, lights=lights, environment=environment, **fields)
        for program in plan(model, **row).programs:
            programs.get("raster/surface.vert", program.fragment, dict(program.switches))
            fragments.add(program.fragment)
    assert fragments == {"raster/pbr.frag", "raster/phong.frag", "raster/unlit.frag"}
    assert len(programs) > 40


def test_every_view_compiles(programs):
    """Each for materials in turn, so that all of them have some."""
    for k, (material, fields) in enumerate(MATERIALS.values()):
        for show in VALUES[k % 2::2]:
            for program in plan(scene(material, **fields), show=show, half=bool(k % 3)).programs:
                assert program.fragment == "raster/view.frag"
                programs.get("raster/surface.vert", program.fragment, dict(program.switches))


def test_every_microfacet_model_compiles(programs):
    """All of D x G x F, with and without compensation, for a mixture of dielectric and metal."""
    model = scene(Material(metallic=0.5), lights=(SUN,), environment=ENVIRONMENT)
    choices = setting_choices()
    for ndf in choices["ndf"]:
        for masking in choices["masking"]:
            for fresnel in choices["fresnel"]:
                for multiscatter in choices["multiscatter"]:
                    chosen = dict(ndf=ndf, masking=masking, fresnel=fresnel, multiscatter=multiscatter)
                    [program] = plan(model, **chosen).programs
                    programs.get("raster/surface.vert", program.fragment, dict(program.switches))


def test_only_what_is_woven_has_yarns():
    model = scene(lights=(SUN,), environment=ENVIRONMENT)
    found, cloth = plan(model), plan(model, weave="twill")
    assert "weave" not in code(found) and not any("woven" in line for line in found.used)
    assert "weave_at" in code(cloth) and "yarns of 1 woven surface" in cloth.used
    assert plan(model, mode="phong", weave="twill").programs == plan(model, mode="phong").programs


def test_without_fog_there_is_no_pass_and_no_code_of_it():
    model = scene(lights=(SUN,), environment=ENVIRONMENT)
    found, foggy = plan(model), plan(model, fog=0.5)
    assert found.media is None and not any(found.programs[0][name] for name in ("MEDIA", "FOG", "FOG_HEIGHT"))
    assert "media" not in code(found) and "haze" not in code(found)
    assert "media" not in found.to_json()["passes"] and "fog: there is none" in found.left_out
    assert "media" in foggy.to_json()["passes"] and "seen_in_media" in code(foggy)
    assert "fog, marched along rays; light scattered in it many times, by a diffusion equation" in foggy.used
    assert not foggy.programs[0]["FOG_HEIGHT"] and plan(model, fog=0.5, fog_height=2.0).programs[0]["FOG_HEIGHT"]
    for name, value in {"fog_albedo": (0.5, 0.5, 0.5), "fog_g": 0.5, "fog_height": 1.0, "media_steps": "224"}.items():
        assert plan(model, **{name: value}).programs == found.programs


def test_without_a_volume_there_is_no_code_of_one():
    model = scene(lights=(SUN,), environment=ENVIRONMENT)
    found, smoky = plan(model, fog=0.5), plan(replace(model, volumes=(BOX,)))
    assert found.media.depth is None and "volumes: there are none" in found.left_out
    lines = [lines_left(program.fragment, dict(program.switches)) for program in found.media.programs]
    assert not any("u_densities" in line or "u_volume_depth" in line for part in lines for line in part)
    assert smoky.media.volumes == 1 and not smoky.media.has_fog and "fog: there is none" in smoky.left_out
    assert "u_volume_depth" in code(smoky)
    alone = plan(Scene("smoke", volumes=(BOX,), lights=(SUN,), environment=ENVIRONMENT))
    assert alone.environment and alone.lights and not alone.shadow_layer_count and not alone.reflections
    told = "\n".join(alone.left_out)
    assert "all shading of surfaces: there are none" in told
    assert not any(words in told for words in ("unlit", "shadows of the environment", "traced reflections"))
    unlit = plan(replace(scene(Material(unlit=True)), volumes=(BOX,)))
    assert "all lighting of surfaces: every surface is unlit" in unlit.left_out
    dim = plan(Scene("smoke", volumes=(BOX,), lights=(Light("point"),) * (MAX_LIGHTS + 7)))
    assert f"the 7 faintest of {MAX_LIGHTS + 7} lights: a program can have no more" in dim.left_out


@pytest.mark.parametrize("volumes", [0, 2])
@pytest.mark.parametrize("mode", ["pbr", "phong"])
@pytest.mark.parametrize("model", [Material(), Material(unlit=True), Material(metallic=0.0, transmission=1.0),
                                   Material(alpha_mode="blend")], ids=["opaque", "unlit", "glass", "blend"])
def test_programs_in_media_compile(programs, mode, model, volumes):
    lights = (SUN, Light("point"), Light("spot"))
    for environment, height in ((None, 0.0), (ENVIRONMENT, 1.0)):
        shown = scene(model, lights=lights, environment=environment, volumes=(BOX,) * volumes)
        found = plan(shown, mode=mode, fog=1.0 if environment is None or not volumes else 0.0, fog_height=height)
        for program in found.programs:
            programs.get("raster/surface.vert", program.fragment, dict(program.switches))
        for program in found.media.programs:
            programs.get("display/fullscreen.vert", program.fragment, dict(program.switches))


def test_equal_materials_share_a_program():
    a = scene(Material(base_color=(1, 0, 0, 1), perceptual_roughness=0.2), environment=ENVIRONMENT)
    b = scene(Material(base_color=(0, 1, 0, 1), perceptual_roughness=0.9), environment=ENVIRONMENT)
    assert plan(a).programs == plan(b).programs


def test_instances_of_a_mesh_are_planned_once(monkeypatch):
    planned = []
    monkeypatch.setattr("viewer.plan.planner.without_constant_maps", lambda m: planned.append(m) or m)
    meshes = (scene().meshes[0], replace(scene().meshes[0], material=1))
    order = [0, 1, 0, 0, 1]
    found = plan(Scene("s", meshes=meshes, materials=(PLAIN, Material(unlit=True)),
                       instances=tuple(Instance(k, np.eye(4)) for k in order)))
    assert len(planned) == 2
    assert [(draw.instance, draw.mesh) for draw in found.draws] == list(enumerate(order))
    assert [draw.program.fragment for draw in found.draws] == [f"raster/{('pbr', 'unlit')[k]}.frag" for k in order]


def test_every_instance_counts_in_what_the_plan_tells():
    coated = replace(scene().meshes[0], material=1)
    found = plan(Scene("s", meshes=(scene().meshes[0], coated), materials=(PLAIN, Material(clearcoat=1.0)),
                       instances=tuple(Instance(k, np.eye(4)) for k in [0, 1, 0, 1, 1])))
    assert [found.count(draw) for draw in found.kinds] == [2, 3]
    assert any(line.startswith("5 draws with 2 programs") for line in found.used)
    assert any(line.endswith("of 3 surfaces") and "coat" in line for line in found.used)


def test_mode_path_is_not_the_rasters():
    with pytest.raises(UsageError, match="mode path"):
        plan(scene(Material()), mode="path")


def test_a_lambertian_surface_asks_for_no_reflections():
    matt = scene(Material(metallic=0.0, specular=0.0), environment=ENVIRONMENT, lights=(SUN,))
    found = plan(matt)
    assert found.environment and not found.reflections and not found.dfg
    assert "u_prefiltered" not in code(found) and "u_dfg, " not in code(found)
    assert any("no surface reflects; saves 4.32 MB and about" in line for line in found.left_out)
    assert environment_use(matt, Settings()) == (True, False)
    glass = Material(metallic=0.0, specular=0.0, transmission=1.0)
    for material in (Material(metallic=0.0), Material(specular=0.0), glass):
        assert plan(scene(material, environment=ENVIRONMENT)).reflections
    assert not plan(scene(environment=ENVIRONMENT), lobes="uniform-diffuse").reflections
    assert environment_use(scene(Material(unlit=True), environment=ENVIRONMENT), Settings()) == (False, False)


def test_maps_of_one_colour_are_factors():
    def texture(*texels: tuple[int, int, int, int]) -> Texture:
        data = BytesIO()
        Image.fromarray(np.uint8([texels])).save(data, "PNG")
        return Texture(open_texture_image(data.getvalue(), "texture"))

    flat, varied = texture(*[(188, 128, 255, 51)] * 4), texture((0, 0, 0, 255), (9, 9, 9, 255))
    full = Material(metallic=0.5, emissive=(2, 2, 2), **{
        f"{name}_texture": flat for name, m in MAPS.items() if not m.info.is_applied})
    [draw] = plan(scene(full, environment=ENVIRONMENT)).draws
    assert draw.maps == ("normal", "occlusion")
    assert draw.surface.base_color == pytest.approx((0.5029, 0.2159, 1.0, 0.2), abs=1e-4)
    assert (draw.surface.perceptual_roughness, draw.surface.metallic) == pytest.approx((128 / 255, 0.5))
    assert draw.surface.emissive == pytest.approx((1.0058, 0.4317, 2.0), abs=1e-4)
    assert draw.surface.specular == pytest.approx(0.2)
    found = plan(scene(Material(base_color_texture=varied, emissive_texture=flat)))
    assert found.draws[0].maps == ("base_color",) and any("1 material map of one colour" in x for x in found.left_out)
    assert plan(scene(full), plan="everything").draws[0].surface is full


def test_many_programs_are_shared():
    plain = scene().meshes[0]
    kinds = [Material(metallic=metallic, emissive=emissive, double_sided=sides, base_color_texture=color)
             for metallic in (0.0, 0.5) for emissive in ((0, 0, 0), (1, 1, 1)) for sides in (False, True)
             for color in (None, MAP)]
    meshes = tuple(replace(plain, material=k) for k in range(len(kinds)))
    many = Scene("many", meshes, tuple(kinds), tuple(Instance(k, np.eye(4)) for k in range(len(kinds))))
    found = plan(many)
    assert len(kinds) == 16 and len(found.programs) == 1 and "shared" in found.used[0]
    assert {draw.blank_maps for draw in found.draws} == {(), ("base_color",)}
    few = replace(many, instances=many.instances[:MIN_PROGRAMS_TO_SHARE - 1])
    assert len(plan(few).programs) == MIN_PROGRAMS_TO_SHARE - 1


def test_lights_that_do_not_fit_are_told():
    many = plan(scene(lights=(Light("point"),) * (MAX_LIGHTS + 7)))
    assert f"the 7 faintest of {MAX_LIGHTS + 7} lights: a program can have no more" in many.left_out
    crowd = scene(lights=(Light("point"),) * (MAX_LIGHTS + 7))
    [warning] = picture_warnings(crowd, Settings())
    assert f"only the {MAX_LIGHTS} brightest of {MAX_LIGHTS + 7} lights are shown" in warning
    assert not picture_warnings(crowd, Settings(mode="path")) and not picture_warnings(scene(lights=(SUN,)), Settings())
    assert "will be black" in picture_warnings(scene(), Settings())[0]


def test_what_is_saved_is_counted():
    image = TextureImage("none", b"", 512, 512, "PNG", has_alpha=False)
    material = Material(emissive_texture=Texture(image), base_color_texture=MAP)
    found = plan(scene(material, tangents=False))
    assert found.saved["texture_mb"] == pytest.approx(512 * 512 * 3 * 4 / 3 / 1e6 + 4.193, abs=0.01)
    assert found.saved["buffer_mb"] == pytest.approx(3 * (16 + 16 + 8) / 1e6, abs=1e-3)
    assert plan(scene(material), plan="everything").saved == {}
