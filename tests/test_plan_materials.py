"""What a plan leaves out of the code of materials."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image
from planning import ENVIRONMENT, MAP, SUN, code, plan, scene

from viewer.plan.planner import environment_use
from viewer.scene.material import Material, Texture
from viewer.scene.schema import MAPS
from viewer.scene.texture_image import open_texture_image
from viewer.settings import Settings


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
    ({"sheen_roughness": 0.0}, set(MAPS) - {"sheen_color", "sheen_roughness"}),
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
    assert lookups(perceptual_roughness=0.05, normal_texture=MAP) == 2  # rougher in smaller levels
    assert lookups("COAT_LOOKUPS", clearcoat=1.0, clearcoat_normal_texture=MAP) == 2
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


def test_only_what_is_woven_has_yarns():
    model = scene(lights=(SUN,), environment=ENVIRONMENT)
    found, cloth = plan(model), plan(model, weave="twill")
    assert "weave" not in code(found) and not any("woven" in line for line in found.used)
    assert "weave_at" in code(cloth) and "yarns of 1 woven surface" in cloth.used
    assert plan(model, mode="phong", weave="twill").programs == plan(model, mode="phong").programs


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
