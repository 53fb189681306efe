"""What a plan leaves out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planning import BOX, ENVIRONMENT, MAP, PLAIN, SUN, code, plan, scene

from benchmarks.shader_code import lines_left
from viewer.errors import UsageError
from viewer.plan.planner import MAX_LIGHTS
from viewer.plan.shadow_layers import MAX_SHADOW_LAYERS
from viewer.plan.sharing import MIN_PROGRAMS_TO_SHARE
from viewer.plan.warnings import picture_warnings
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.scene import Instance, Scene
from viewer.scene.texture_image import TextureImage
from viewer.settings import Settings


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


def test_deferring_what_has_too_many_objects_is_told():
    few = scene()
    many = replace(few, instances=few.instances * 65)
    told = [[line for line in plan(model, antialias="deferred-4").left_out if "deferred-4" in line]
            for model in (few, many)]
    assert told == [[], ["shading after all triangles are drawn (deferred-4): there are more than 64 objects or "
                         "4194303 triangles, so each triangle is shaded, as by msaa-4"]]


def test_lights_are_ordered_bounded_and_dark_ones_dropped():
    spot, point = Light("spot", intensity=1.0), Light("point", intensity=2.0)
    found = plan(scene(lights=(spot, point, SUN, Light("point", intensity=0.0), Light("point", (0, 0, 0), 3.0))))
    assert found.lights == (SUN, point, spot)
    assert found.shadow_layers == (0, 1, 7) and found.shadow_layer_count == 8
    assert plan(scene(lights=(spot, point)), shadows="off").shadow_layers == (-1, -1)
    many = plan(scene(lights=tuple(Light("point", intensity=1.0 + k) for k in range(200))))
    assert len(many.lights) == MAX_LIGHTS and min(light.intensity for light in many.lights) == 200 - MAX_LIGHTS + 1
    assert many.shadow_layer_count <= MAX_SHADOW_LAYERS


def test_shadow_maps_go_to_the_lights_that_are_brightest_at_the_scene():
    """A far lamp of more candela gives less light than a near one, and a bright one out of range gives none; a sun has
    its tile before all lamps."""
    near = [Light("point", intensity=1.0 + k, position=(0, 3, 0)) for k in range(11)]
    found = plan(scene(lights=(Light("point", intensity=50.0, position=(0, 300, 0)), *near, SUN)))
    with_map = {light.intensity for light, layer in zip(found.lights, found.shadow_layers, strict=True) if layer >= 0}
    assert with_map == {SUN.intensity} | {light.intensity for light in near[1:]}
    assert [layer for layer in found.shadow_layers if layer >= 0] == [0, *range(1, 61, 6)]
    beyond = [Light("point", intensity=1e3, position=(0, 20, 0), range=1.0)] * 64
    reached = plan(scene(lights=(*beyond, *near[1:])))
    lit = {light.intensity for light, layer in zip(reached.lights, reached.shadow_layers, strict=True) if layer >= 0}
    assert lit == {light.intensity for light in near[1:]}
    assert "shadow maps of 2 lights: there is room for 64 tiles" in found.left_out


def test_background():
    model = scene(environment=ENVIRONMENT)
    assert plan(model).background
    assert not plan(model, background="none").background
    assert not plan(replace(model, environment=None)).background


def test_without_fog_there_is_no_pass_and_no_code_of_it():
    model = scene(lights=(SUN,), environment=ENVIRONMENT)
    found, foggy = plan(model), plan(model, fog=0.5)
    assert found.media is None and not any(found.programs[0][name] for name in ("MEDIA", "FOG", "FOG_HEIGHT"))
    assert "media" not in code(found) and "haze" not in code(found)
    assert "media" not in found.to_json()["passes"] and "fog: there is none" in found.left_out
    assert "media" in foggy.to_json()["passes"] and "seen_in_media" in code(foggy)
    assert "fog, by ray marching; multiple scattering by a diffusion equation" in foggy.used
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
    assert "all shading of surfaces: the scene has none" in told
    assert not any(words in told for words in ("unlit", "shadows of the environment", "traced reflections"))
    unlit = plan(replace(scene(Material(unlit=True)), volumes=(BOX,)))
    assert "all lighting of surfaces: every surface is unlit" in unlit.left_out
    dim = plan(Scene("smoke", volumes=(BOX,), lights=(Light("point"),) * (MAX_LIGHTS + 7)))
    assert f"the 7 faintest of {MAX_LIGHTS + 7} lights: a program can have no more" in dim.left_out


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
    shown, shadows = picture_warnings(crowd, Settings())
    assert f"only the {MAX_LIGHTS} brightest of {MAX_LIGHTS + 7} lights are shown" in shown
    assert shadows == f"only the 10 brightest of {MAX_LIGHTS} lights cast shadows; in mode path all do"
    assert [shown] == picture_warnings(crowd, Settings(shadows="off"))
    assert not picture_warnings(crowd, Settings(mode="path")) and not picture_warnings(scene(lights=(SUN,)), Settings())
    assert "will be black" in picture_warnings(scene(), Settings())[0]


def test_what_is_saved_is_counted():
    image = TextureImage("none", b"", 512, 512, "PNG", has_alpha=False)
    material = Material(emissive_texture=Texture(image), base_color_texture=MAP)
    found = plan(scene(material, tangents=False))
    assert found.saved["texture_mb"] == pytest.approx(512 * 512 * 3 * 4 / 3 / 1e6 + 4.193, abs=0.01)
    assert found.saved["buffer_mb"] == pytest.approx(3 * (16 + 16 + 8) / 1e6, abs=1e-3)
    assert plan(scene(material), plan="everything").saved == {}
