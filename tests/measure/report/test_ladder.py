from __future__ import annotations

import shlex
from dataclasses import replace

import numpy as np
import pytest
import shapes

from viewer.cli import cli
from viewer.jobs.assemble import make_environment, make_light, make_quality, make_settings
from viewer.measure.report import ladder as module
from viewer.measure.report.command import command_line
from viewer.measure.report.ladder import PLAIN, Method, ladder, settings_of
from viewer.quality import POINTS
from viewer.scene.curves import Curves
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.volume import Volume
from viewer.settings import Settings, setting_choices

DEFAULT = Settings()
BALL = shapes.sphere(segments=8)


def sunny() -> Environment:
    radiance = np.full((256, 512, 3), 0.1, np.float32)
    radiance[80, 160] = 1e5
    return Environment("sunny", radiance)


def methods_of(scene, settings=DEFAULT) -> tuple[list[Method], dict[str, str]]:
    steps = ladder(scene, settings, use_cache=False)
    return [*steps.raster, *steps.traced], {out.method: out.reason for out in steps.left_out}


def test_every_method_has_a_name_of_its_own_and_differs_in_fact():
    methods, _ = methods_of(shapes.scene(BALL, environment=sunny()))
    assert len({method.slug for method in methods}) == len({method.label for method in methods}) == len(methods)
    assert all("/" not in method.slug and " " not in method.slug for method in methods)
    assert len({(method.settings(Settings()), method.lights) for method in methods}) == len(methods)
    assert PLAIN in methods


def test_without_an_environment_there_is_no_image_based_light():
    lamp = Light("point", position=(2, 2, 2), intensity=30.0)
    methods, left_out = methods_of(shapes.scene(BALL, lights=(lamp,)))
    assert {method.name for method in methods} >= {"phong", "lights", "path"} and "ibl" not in {m.name for m in methods}
    assert left_out["image-based light"] == "the scene has no environment"
    methods, left_out = methods_of(shapes.scene(BALL))
    assert "lights" not in {method.name for method in methods}
    assert left_out["lights only"] == "the scene has no lights and no environment"


def test_shadows_are_a_knob_where_something_casts_them():
    methods, left_out = methods_of(shapes.scene(BALL, environment=shapes.constant()))
    assert not any(method.changes.get("shadows") for method in methods)
    assert left_out["image-based light, shadows off"] == "no light casts a shadow"
    methods, _ = methods_of(shapes.scene(BALL, environment=sunny()))
    assert any(method.changes.get("shadows") == "off" for method in methods)


def test_the_environments_shadows_are_cast_by_more_and_more_lights():
    methods, _ = methods_of(shapes.scene(BALL, environment=sunny()))
    counts = [int(method.changes["environment_shadows"]) for method in methods
              if method.name == "environment-shadows"]
    assert counts == sorted(counts) and len(set(counts)) >= 3


def test_effects_are_measured_where_they_change_the_picture():
    def effects(material: Material) -> set[str]:
        scene = shapes.scene(BALL, materials=(material,), environment=shapes.constant())
        return {name for name, _ in module._effects(scene, (), DEFAULT, [])}

    assert effects(Material(perceptual_roughness=0.1)) == {"reflections"}
    glass = Material(metallic=0.0, perceptual_roughness=0.1, transmission=1.0, thickness=1.0)
    assert "refraction" in effects(glass)
    assert effects(Material(unlit=True)) == set()


def test_indirect_light_is_measured_where_there_can_be_some():
    two = (BALL, (BALL, shapes.moved((3, 0, 0))))
    changes = [method.changes for method in methods_of(shapes.scene(*two, environment=shapes.constant()))[0]
               if method.name == "indirect"]
    assert [change["environment_shadows"] for change in changes] == ["off", "16", "16", "64"]
    methods, _ = methods_of(shapes.scene(BALL, environment=shapes.constant()))
    assert "indirect" not in {method.name for method in methods}


def test_no_method_is_there_under_two_names():
    two = shapes.scene(BALL, (BALL, shapes.moved((3, 0, 0))), environment=shapes.constant(),
                       materials=(Material(perceptual_roughness=1.0),))  # nothing to mirror: what is left is baked
    methods, _ = methods_of(two)
    assert {"indirect", "together"} <= {method.name for method in methods}
    changes = [(method.changes.get("mode"), frozenset(method.changes.items()), method.lights) for method in methods]
    assert len(set(changes)) == len(changes)


def test_fog_is_measured_in_several_steps_where_there_is_some():
    model = shapes.scene(BALL, lights=(Light("point"),))
    methods, left_out = methods_of(model)
    assert left_out["fog and volumes"] == "there are none" and "media" not in {method.name for method in methods}
    steps = ladder(model, Settings.of(fog=0.5), use_cache=False)
    media = [method for method in steps.raster if method.name == "media"]
    assert len(media) == 8 and "fog and volumes" not in {out.method for out in steps.left_out}
    assert all(method.settings(Settings.of(fog=0.5)).fog == 0.5 for method in media)
    assert media[0].changes["media_scattering"] == "single"


def test_methods_of_surfaces_are_left_out_where_there_are_none_and_come_after_media():
    cube = Volume.in_box(np.ones((1, 1, 1), np.float32), [[-1, -1, -1], [1, 1, 1]])
    model = replace(shapes.scene(BALL, environment=shapes.constant()), volumes=(cube,))
    names = [method.name for method in methods_of(model)[0] if method.mode == "pbr"]
    assert names[2:12] == ["ibl", *["media"] * 8, "ibl"] and "ambient-occlusion" in names
    alone, left_out = methods_of(replace(model, instances=()))
    assert [method.name for method in alone if method.mode == "pbr"] == [*["lights"] * 2, "ibl", *["media"] * 8]
    assert left_out["other methods of surfaces"] == "there are none"


def test_curves_have_methods_of_their_own_and_none_that_only_surfaces_have():
    hair = Curves("hair", np.eye(3), np.ones(3), [0, 3], [False])
    model = replace(shapes.scene(BALL, environment=sunny()), curves=(hair,))
    steps, _ = methods_of(replace(model, instances=()))
    methods = [method for method in steps if method.mode == "pbr"]
    changes = [method.changes for method in methods if method.name == "ibl"]
    assert [change["hair_scattering"] for change in changes if "hair_scattering" in change] == ["single"]
    assert {change["antialias"] for change in changes} == {*setting_choices()["antialias"]} - {"auto"}
    assert [change["shadows"] for change in changes if "shadows" in change] == ["off"]
    assert not {"ambient-occlusion", "environment-shadows"} & {method.name for method in methods}
    assert not any(knob in change for change in changes for knob in module.KNOBS)
    both = [method.changes for method in methods_of(model)[0]]
    assert any("hair_scattering" in change for change in both) and any("fresnel" in change for change in both)
    bare, left_out = methods_of(shapes.scene(BALL, environment=sunny()))
    assert not any("hair_scattering" in method.changes for method in bare)
    assert left_out["methods of curves"] == "there are none"


def test_photons_are_a_method_where_the_reference_has_them():
    glass = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
    lamp = Light("point", position=(2, 2, 2), intensity=30.0)
    scene = shapes.scene(BALL, materials=(glass,), lights=(lamp,))
    given = ["m.glb", "-o", "out", "--set", "caustics=photons", "--set", "photons=7"]
    options = cli.commands["report"].make_context("report", given).params
    wanted = make_settings(options)
    methods, _ = methods_of(scene, wanted)
    photons = [method for method in methods if method.name == "caustics"]
    assert [method.settings(wanted).photons for method in photons] == [4, 16, 64]
    for method in methods:
        has = method in photons or method.is_traced
        assert method.settings(wanted).caustics == ("photons" if has else "off")
        assert method in photons or method.settings(wanted).photons == Settings().photons
        words = command_line("m.glb", options, method)
        assert ("caustics=photons" in words) == has and "photons=7" not in words
    for other, settings, why in ((scene, DEFAULT, "not set"), (replace(scene, lights=()), wanted, "there is no point"),
                                 (scene, replace(wanted, shadows="off"), "shadows off")):
        methods, left_out = methods_of(other, settings)
        assert not any(method.name == "caustics" for method in methods)
        assert why in left_out["caustics by photons"]


def test_a_denoiser_that_is_not_installed_is_left_out(monkeypatch):
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    methods, left_out = methods_of(shapes.scene(BALL))
    assert "path+oidn" not in {method.name for method in methods} and "pip install" in left_out["path traced, OIDN"]


def test_lights_only_stand_for_the_environments_suns():
    methods, _ = methods_of(shapes.scene(BALL, environment=sunny()))
    lit = next(method for method in methods if method.name == "lights")
    [sun] = lit.lights
    towards = -np.array(sun.direction)
    expected = shapes.texel_directions(256, 512)[80, 160]
    assert np.degrees(np.arccos(towards @ expected)) < 1.5 and sun.intensity > 1
    assert lit.scene(shapes.scene(BALL, environment=sunny())).environment is None


@pytest.mark.parametrize("is_hollow", [False, True])
def test_every_quality_is_a_method_with_what_of_it_the_scene_has(is_hollow):
    model = shapes.scene(*(BALL, (BALL, shapes.moved((3, 0, 0))))[:1 + is_hollow], environment=sunny())
    named = {method.quality: method for method in methods_of(model)[0] if method.quality}
    assert named.keys() == POINTS.keys() and named["draft"] == PLAIN
    assert named["standard"].changes == POINTS["standard"]
    left_out = {"reflections", "refraction"} if is_hollow else {"reflections", "refraction", "indirect"}
    assert named["high"].changes == {name: value for name, value in POINTS["high"].items() if name not in left_out}
    assert not any(method.quality for method in methods_of(replace(model, environment=None))[0])


ARGUMENTS = ["--size", "64x32", "--env", "furnace", "--env-rotation", "30", "--env-intensity", "2", "--exposure", "-1",
             "--tonemap", "agx", "--background", "none", "--light", "10,-20,3", "--set", "ndf=beckmann", "--set",
             "antialias=none", "--set", "bounces=3", "--orbit", "-30,5", "--fov", "20", "--ortho", "--up", "-z",
             "--with", "b.ply", "--scene", "1", "--material", "gold,1"]


@pytest.mark.parametrize("arguments", [[], ARGUMENTS])
def test_the_command_line_of_a_method_asks_for_just_that(arguments):
    options = cli.commands["report"].make_context("report", ["m x.glb", "-o", "out", *arguments]).params
    base = make_settings(options)
    environment = make_environment(options)
    scene = shapes.scene(BALL, lights=tuple(map(make_light, options["lights"])), environment=environment)
    for method in methods_of(scene, base)[0]:
        words = shlex.split(command_line("m x.glb", options, method))
        assert words[:3] == ["pbr-viewer", "render", "m x.glb"]
        asked = cli.commands["render"].make_context("render", words[2:]).params
        settings = make_settings(asked)
        settings = make_quality(asked, settings, scene, (64, 64)).applied(settings)
        nothing = [name for name in POINTS.get(method.quality, {}) if name not in method.changes]  # is there to trace
        settings = replace(settings, **{name: getattr(Settings(), name) for name in nothing})
        settings.check_used()
        assert settings == method.settings(base)
        assert (settings.bounces == 3) == bool(arguments and method.is_traced)
        assert settings.ndf == ("ggx" if settings.mode == "phong" else base.ndf)
        same = ("size", "orbit", "view", "ortho", "fov", "eye", "camera", "up", "with_files", "variant", "scene",
                "material")
        assert {name: asked[name] for name in same} == {name: options[name] for name in same}
        lights = tuple(map(make_light, asked["lights"]))
        assert method.scene(scene).lights == lights
        shown = make_environment(asked)
        if method.lights is None:
            assert (shown.rotation, shown.intensity) == (environment.rotation, environment.intensity)
        else:
            assert shown is None


def test_settings_are_told_as_far_as_they_are_not_the_defaults():
    base = Settings(exposure=1.0)
    assert settings_of(PLAIN, base) == {"mode": "pbr", "exposure": 1.0, **PLAIN.changes}
    method = Method("path", "path traced", {"mode": "path", "spp": 4})
    assert settings_of(method, Settings(background=(0, 0, 1))) == {"mode": "path", "background": [0, 0, 1], "spp": 4}
