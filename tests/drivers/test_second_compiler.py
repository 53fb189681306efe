"""Every program that our plans and those of the corpus ask for, under a second compiler and the limits of OpenGL 3.3.

Mesa, with which all else is tested, accepts what other drivers refuse.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from cases import CASES
from glslang import GRANTED, as_330, as_400, problems
from needs import CORPUS, needs, require
from passes import intersections, passes
from path_cases import CASES as PATH_CASES
from planned import GREY, assembled, keys, layer_keys, path_keys, raster_keys, under

import viewer
from viewer.base.resources import resource_folder
from viewer.errors import InputError
from viewer.gpu.source import assemble, display_name
from viewer.plan.planner import MAX_LIGHTS
from viewer.scene.curves import Curves
from viewer.scene.fog import fog_of
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.volume import Volume
from viewer.settings import SURFACE_LAYERS, VALUES, Settings, setting_choices
from viewer.trace.paths.surface_rays import FROM_SURFACE
from viewer.trace.scene.curves import trace_curves
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.scene_data import geometry_switches

MODES = ("pbr", "phong", "path")
_TRACED = {"reflections": "traced", "refraction": "traced", "environment_shadows": "64"}
_SHADED = ("ndf", "masking", "fresnel", "multiscatter", "lobes", "phong", "sampling", "plan", "indirect", "specular_aa")
"""The settings that change how a surface is shaded; the others change passes, or nothing that is compiled."""
_FOG = Material(metallic=0.0, transmission=1.0, thickness=1.0, ior=1.0, attenuation_distance=1.0,
                attenuation_color=(0.5, 0.4, 0.3), scatter_color=(0.5, 0.5, 0.5))
"""Makes a solid a boundary between media of one index, and its scene one with scattering."""


def _strand(colors: np.ndarray | None) -> Curves:
    return Curves("strand", np.eye(3)[:2], np.ones(2), np.array([0, 2]), np.array([False]), colors=colors)


@pytest.fixture(scope="module")
def ours() -> tuple[list[str], dict[str, int], set[str]]:
    """What is wrong with the programs of our own scenes, the most that one takes, and the files they are made of."""
    require("glslang")
    wanted = {}
    for case in CASES:
        scene, _ = case.load()
        scene = under(scene, GREY if case.environment else None, case.rotation)
        for mode in MODES:
            settings = Settings(mode="path") if mode == "path" else case.with_mode(mode)
            wanted |= dict.fromkeys(keys(scene, settings))
    programs = []
    for case in PATH_CASES:
        scene, _ = case.make()
        wanted |= dict.fromkeys(keys(scene, case.with_seed(0)))
        programs += intersections(geometry_switches(scene, trace_geometry(scene), False))
    rich = [under(case.load()[0], GREY) for case in CASES if case.name in ("glass", "alpha", "anisotropy")]
    for scene in rich:
        wanted |= dict.fromkeys(raster_keys(scene, Settings.of(**_TRACED), half=False, orthographic=True))
        lit = tuple(replace(material, emissive=(1.0, 1.0, 1.0), clearcoat=1.0) for material in scene.materials)
        wanted |= dict.fromkeys(path_keys(replace(scene, materials=lit), Settings(mode="path"), FROM_SURFACE))
    for name, mode in product(_SHADED, MODES):
        for choice in setting_choices()[name]:
            settings = Settings.of(mode=mode, **{name: choice})
            if settings.is_used:
                wanted |= dict.fromkeys(keys(rich[0], settings))
    for mode, weave, fog in product(("pbr", "path"), ("plain", "denim"), (0.0, 1.0)):  # with gaps, and without
        wanted |= dict.fromkeys(keys(rich[0], Settings.of(mode=mode, weave=weave, fog=fog)))
    [velvet] = [under(case.load()[0], GREY) for case in CASES if case.name == "sheen"]
    for mode in ("pbr", "path"):
        wanted |= dict.fromkeys(keys(velvet, Settings.of(mode=mode, sheen="zeltner")))
    path = Settings.of(mode="path", denoise="fast", clamp=1.0, light_radius=0.1, caustics="photons")
    wanted |= dict.fromkeys(keys(rich[0], path))
    for scene in rich:
        for material in range(len(scene.materials)):  # each but one keeps its maps
            filled = tuple(_FOG if k == material else m for k, m in enumerate(scene.materials))
            hazy = replace(scene, materials=filled, lights=(Light("point", intensity=1.0),))
            wanted |= dict.fromkeys(keys(hazy, path)) | dict.fromkeys(keys(hazy, Settings(mode="path")))
            programs += intersections(geometry_switches(hazy, trace_geometry(hazy), False))
    foggy = replace(rich[0], lights=(Light("spot", intensity=1.0), Light("point", intensity=1.0)))
    for mode, height in product(("pbr", "phong"), (0.0, 1.0)):
        wanted |= dict.fromkeys(keys(foggy, Settings.of(mode=mode, fog=1.0, fog_height=height)))
        smoky = replace(foggy, volumes=(Volume.in_box(np.ones((1, 1, 1)), [[0, 0, 0], [1, 1, 1]]),) * 2)
        wanted |= dict.fromkeys(keys(smoky, Settings.of(mode=mode, fog=height)))
        burning = replace(smoky, lights=(*smoky.lights, Light("point", radius=0.5)))
        wanted |= dict.fromkeys(keys(burning, Settings.of(mode=mode, fog=height, volume_emission=1.0)))
    hairy = replace(foggy, curves=tuple(Curves("c", np.eye(3), np.ones(3), [0, 3], [False], colors=colors)
                                        for colors in (None, np.eye(3))))
    for fog in (0.0, 1.0):
        wanted |= dict.fromkeys(keys(hairy, Settings.of(fog=fog)))
        wanted |= dict.fromkeys(keys(hairy, Settings.of(fog=fog, hair_scattering="single")))
        wanted |= dict.fromkeys(keys(hairy, Settings.of(fog=fog, yarn="silk")))
        wanted |= dict.fromkeys(raster_keys(hairy, Settings.of(fog=fog), half=False, orthographic=True))
    for show in VALUES:
        wanted |= dict.fromkeys(raster_keys(hairy, Settings(show=show), orthographic=show == "normal"))
    for mode in ("pbr", "phong"):
        wanted |= dict.fromkeys(keys(foggy, Settings.of(mode=mode, ground="shadow")))
    for scene, names in product((*rich, velvet), (SURFACE_LAYERS, ("normal", "instance"))):
        wanted |= dict.fromkeys(layer_keys(scene, Settings(), names, orthographic=scene is velvet))
    for yarn in ("off", "silk"):
        wanted |= dict.fromkeys(layer_keys(hairy, Settings.of(yarn=yarn), SURFACE_LAYERS, orthographic=yarn == "off"))
    lamps = tuple(Light("point", intensity=1.0, position=(0, 0, 1 + k)) for k in range(MAX_LIGHTS))
    wanted |= dict.fromkeys(keys(replace(rich[0], lights=lamps), Settings()))
    milk = Material(metallic=0.0, transmission=1.0, thickness=1.0, scatter_color=(0.5, 0.5, 0.5), ior=1.0,
                    perceptual_roughness=0.0, attenuation_color=(0.5, 0.5, 0.5), attenuation_distance=1.0)
    scattering = replace(rich[0], materials=(milk,) * len(rich[0].materials), lights=lamps[:1])
    wanted |= dict.fromkeys(keys(scattering, Settings(mode="path")))
    programs += intersections(geometry_switches(scattering, trace_geometry(scattering), False))
    smoke = Volume("smoke", np.ones((2, 2, 2), np.float32), np.eye(4))
    wanted |= dict.fromkeys(keys(replace(rich[0], lights=lamps[:1], volumes=(smoke,)), Settings(mode="path")))
    for volumes, height in product(((), (smoke,)), (0.0, 1.0)):
        lit, settings = replace(scattering, volumes=volumes), Settings.of(mode="path", fog=1.0, fog_height=height)
        wanted |= dict.fromkeys(keys(lit, settings))
        programs += intersections(geometry_switches(lit, trace_geometry(lit, fog=fog_of(lit, settings)), False))
    for colors, settings in product((None, np.ones((2, 3))), (path, Settings.of(mode="path", fog=1.0))):
        hairy = replace(rich[1], curves=(_strand(colors),))
        wanted |= dict.fromkeys(keys(hairy, settings))
        geometry = trace_geometry(hairy, fog=fog_of(hairy, settings), curves=trace_curves(hairy))
        programs += intersections(geometry_switches(hairy, geometry, False))
    clear = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
    smooth = replace(rich[0], lights=lamps[:1],
                     materials=(clear, *(replace(m, perceptual_roughness=0.0) for m in rich[0].materials[1:])))
    for more, fog in (({}, 0.0), ({"volumes": (smoke,)}, 0.0), ({"curves": (_strand(None),)}, 1.0)):
        settings = replace(path, fog=fog)
        wanted |= dict.fromkeys(keys(replace(smooth, **more), settings))  # with photons
    programs += [*assembled(wanted), *passes()]
    found, most = problems([as_330(program) for program in programs])
    newer, _ = problems([as_400(p) for p in programs if p["fragment"].files[0].name.startswith("intersect")])
    return found + newer, most, {display_name(source.files[0]) for p in programs for source in p.values()}


@needs("glslang")
def test_our_programs_compile_and_link_and_keep_the_limits(ours):
    found, most, _ = ours
    assert not found
    assert all(0 < most[name] <= granted for name, granted in GRANTED.items())


@needs("glslang")
def test_no_shader_is_left_out(ours):
    folder = resource_folder("shaders")
    files = {display_name(file) for ending in ("vert", "frag") for file in folder.rglob(f"*.{ending}")}
    assert files == ours[2]


@needs("glslang", "corpus")
def test_programs_of_the_corpus():
    wanted = {}
    for number, path in enumerate(sorted((CORPUS / "models").rglob("*.gl*"))):
        try:
            scene = under(viewer.load(path, environment=None), GREY)
        except InputError:
            continue  # a feature that is not supported
        more = ({"mode": "phong"}, _TRACED) if number % 3 == 0 else ()  # they differ little from mode pbr
        for settings in ({"mode": "pbr"}, {"mode": "path"}, *more):
            wanted |= dict.fromkeys(keys(scene, Settings.of(**settings)))
    found, _ = problems(map(as_330, assembled(wanted)))
    assert len(wanted) > 100 and not found


@needs("glslang")
@pytest.mark.parametrize(("fragment", "problem"), [
    ("out vec4 o; void main() { o = vec4(missing); }", "my.frag:1: 'missing' : undeclared identifier"),
    ("out vec4 o; void main() { o = vec4(1.0); float x = o; }", "my.frag:1: '=' :  cannot convert from"),
    ("in vec2 v_there; out vec4 o; void main() { o = v_there.xyxy; }", "my.vert + shaders/my.frag: ERROR: Linking"),
    ("uniform sampler2D u[17]; out vec4 o; void main() { o = vec4(1.0); }", "17 textures of a stage"),
    ("uniform mat4 u[65]; out vec4 o; void main() { o = vec4(1.0); }", "1040 uniform components of a stage"),
])
def test_what_is_wrong_is_found(tmp_path, monkeypatch, fragment, problem):
    monkeypatch.setattr("viewer.gpu.source.resource_folder", lambda name: tmp_path / name)
    (tmp_path / "shaders").mkdir()
    (tmp_path / "shaders/my.vert").write_text("out vec3 v_there; void main() { v_there = gl_Position.xyz; }")
    (tmp_path / "shaders/my.frag").write_text(fragment)
    found, _ = problems([{"vertex": assemble("my.vert"), "fragment": assemble("my.frag")}])
    assert len(found) == 1 and problem in found[0], found
