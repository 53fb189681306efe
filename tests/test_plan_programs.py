"""Every program that a plan may ask for compiles."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import combinations

import pytest
from contexts import open_or_skip
from planning import BOX, ENVIRONMENT, MAP, SUN, plan, scene

from viewer.gpu.programs import Programs
from viewer.plan.planner import MAX_LIGHTS
from viewer.scene.light import Light
from viewer.scene.material import Material, Sampler, UVTransform
from viewer.scene.schema import MAPS
from viewer.settings import VALUES, setting_choices

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
