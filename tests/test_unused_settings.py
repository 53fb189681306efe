"""Settings that a scene has nothing for are told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapes

from viewer.plan.unused import unused_settings
from viewer.scene.curves import Curves
from viewer.scene.environment_presets import make_preset
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.volume import Volume
from viewer.settings import Settings

BALL = shapes.sphere(segments=8)
BARE = shapes.scene(BALL, environment=make_preset("furnace"))


def test_what_the_scene_lacks_is_named_with_the_settings_about_it():
    told = unused_settings(BARE, Settings.of(hair_tilt=3, hair_scattering="single", curve_radius=0.1, fog_g=0.5,
                                             volume_albedo=0.5, media_steps="112", sheen="zeltner", subsurface="off",
                                             refraction="traced"))
    assert told == ["hair_tilt and hair_scattering and curve_radius have no effect: there are no curves",
                    "volume_albedo has no effect: there are no volumes", "fog_g has no effect: there is no fog",
                    "media_steps has no effect: there are no fog and no volumes",
                    "sheen has no effect: no material has a sheen",
                    "subsurface has no effect: no solid scatters light inside",
                    "refraction has no effect: there is no solid glass"]
    dark = replace(BARE, environment=None)
    assert unused_settings(dark, Settings.of(environment_shadows="16", background_blur=3)) == [
        "environment_shadows has no effect: there is no environment",
        "background_blur has no effect: the background is no environment"]
    assert unused_settings(BARE, Settings.of(photons=4)) == ["photons has no effect: the setting caustics is off"]
    assert unused_settings(BARE, Settings.of(mode="path", light_radius=0.1)) == [
        "light_radius has no effect: there are no point or spot lights"]


def test_nothing_is_told_of_defaults_and_of_what_is_there():
    assert unused_settings(BARE, Settings()) == unused_settings(replace(BARE, instances=()), Settings()) == []
    cloth = Material(sheen_color=(0.5, 0.5, 0.5), sheen_roughness=0.5)
    glass = Material(metallic=0.0, transmission=1.0, thickness=1.0)
    volume = Volume.in_box(np.ones((2, 2, 2), np.float32), [[-1, -1, -1], [1, 1, 1]])
    full = replace(shapes.scene(BALL, (shapes.sphere(1, segments=8), np.eye(4)), materials=(cloth, glass),
                                environment=BARE.environment, lights=(Light("point"),)), volumes=(volume,),
                   curves=(Curves("hair", np.eye(3), np.ones(3), [0, 3], [False]),))
    assert unused_settings(full, Settings.of(
        hair_tilt=3, curve_radius=0.1, volume_g=0.5, media_steps="112", sheen="zeltner", refraction="traced",
        environment_shadows="16", light_radius=0.1, fog=1, fog_g=0.1, background_blur=2)) == []


def test_what_a_view_of_values_does_not_show_is_named_once():
    told = unused_settings(BARE, Settings.of(show="normal", exposure=1.0, tonemap="agx", grid="on", lobes="specular",
                                             fog=1.0, fog_g=0.5, antialias="none", denoise="fast", background="none"))
    assert told == ["exposure and tonemap and lobes and grid and fog and fog_g have no effect: the setting show is "
                    "normal"]
    assert unused_settings(BARE, Settings.of(show="overdraw", antialias="ssaa-4", lobes="specular", grid="on")) == [
        "grid and antialias have no effect: the setting show is overdraw"]
    assert unused_settings(BARE, Settings.of(show="wireframe", exposure=1.0, grid="on")) == []
