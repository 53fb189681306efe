"""No program samples more textures than OpenGL 3.3 grants, and the plan counts them as the driver does."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import pytest
from planning import BOX, ENVIRONMENT, MAP, SUN
from shapes import plate, scene

from viewer.gpu.programs import Programs
from viewer.plan.planner import plan_scene
from viewer.plan.samplers import MAX_SAMPLERS, sampler_count
from viewer.scene.material import Material
from viewer.scene.schema import MAPS
from viewer.settings import Settings

EVERY_MAP = {f"{name}_texture": MAP for name in MAPS}
COATED = {"clearcoat": 1.0, "clearcoat_roughness": 0.5}
GLASS = Material(metallic=0.5, emissive=(1, 1, 1), transmission=0.5, thickness=1.0, anisotropy_strength=0.5,
                 **COATED, **EVERY_MAP)
OPAQUE = Material(metallic=0.5, perceptual_roughness=0.3, emissive=(1, 1, 1), **EVERY_MAP)
TRACED = {"reflections": "traced", "refraction": "traced", "environment_shadows": "64"}


def planned(material: Material, volumes: int = 0, **settings: object):
    model = replace(scene(plate(), materials=(material,), lights=(SUN,), environment=ENVIRONMENT),
                    volumes=(BOX,) * volumes)
    return plan_scene(model, Settings.of(**settings), (SUN,), samples=4, half_target=False, orthographic=False)


@pytest.mark.parametrize("volumes", [0, 1])
@pytest.mark.parametrize("material", [GLASS, OPAQUE, Material()], ids=["glass", "opaque", "plain"])
@pytest.mark.parametrize("settings", [{}, TRACED, {"fog": 1.0}, {"mode": "phong"},
                                      {"mode": "phong", "fog": 1.0}, {"plan": "everything"},
                                      {"plan": "everything", **TRACED}], ids=str)
def test_no_program_samples_too_many_textures(context, material, settings, volumes):
    programs = Programs(context)
    for program in planned(material, volumes, **settings).programs:
        compiled = programs.get("raster/surface.vert", program.fragment, dict(program.switches))
        samplers = [name for name in compiled if isinstance(compiled[name], moderngl.Uniform)
                    and name.startswith("u_")
                    and compiled[name].gl_type in (0x8B5E, 0x8B5F, 0x8B62)]  # 2D, 3D, 2D shadow
        assert len(samplers) <= sampler_count(dict(program.switches)) <= MAX_SAMPLERS
    programs.release()


def test_glass_with_every_map_is_not_traced_and_says_so():
    found = planned(GLASS, refraction="traced")
    assert not found.has_traced_refraction
    assert "traced refraction of 1 surface: with their maps a program would sample more than 16 textures" \
        in found.left_out
    *_, last = MAPS
    assert f"the map {last} of 1 surface: with their maps a program would sample more than 16 textures" \
        in found.left_out
    assert last not in found.draws[0].maps and "transmission" in found.draws[0].maps
    fewer = Material(metallic=0.0, transmission=0.5, thickness=1.0, base_color_texture=MAP)
    assert planned(fewer, refraction="traced").has_traced_refraction
