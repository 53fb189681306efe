"""The settings of yarns: what they make of a scene's curves, and what they say."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from viewer.jobs.info import describe_scene
from viewer.plan.unused import unused_settings
from viewer.scene.curves import Curves
from viewer.scene.fibre import Fibre, hair_fibre
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.yarn.kind import YARNS
from viewer.scene.yarn.spun import as_yarns, dense_curves, spun
from viewer.settings import Settings

YARN = Curves("yarn", [[0, 0, 0], [0, 9, 0]], [0.5, 0.5], [0, 2], [False], colors=[[0.2, 0.4, 0.6]] * 2)
SCENE = Scene("cloth", curves=(YARN,))
WOOL = Settings.of(yarn="wool", mode="path")


def test_curves_stay_as_they_are_unless_they_are_yarns() -> None:
    assert spun(SCENE, Settings()) is SCENE
    assert spun(Scene("none"), WOOL).curves == ()


def test_the_numbers_are_those_of_the_settings() -> None:
    made, = spun(SCENE, Settings.of(yarn="cotton", yarn_plies=2, yarn_fibres=5, yarn_hairs=0, yarn_twist=0)).curves
    assert made.strand_count == 10
    middle = made.points[:made.offsets[1], ::2].mean(axis=0)
    assert np.linalg.norm(middle) > 0.1  # without twist a fibre stays on its side
    kind = YARNS["wool"]
    own = spun(SCENE, WOOL).curves[0]
    assert own.strand_count == kind.plies * kind.fibres + math.floor(9 / 0.5 * kind.hairs)
    assert own.radii[0] == pytest.approx(0.5 * kind.radius)


def test_colors_are_those_of_the_settings_the_curves_or_the_kind() -> None:
    made, = spun(SCENE, WOOL).curves
    assert made.fibre == YARNS["wool"].fibre and made.colors is not None
    np.testing.assert_allclose(made.colors, np.broadcast_to([0.2, 0.4, 0.6], made.colors.shape), rtol=1e-6)
    settings = replace(WOOL, hair_color=(0.1, 0.1, 0.1), hair_tilt=5.0)
    made, = spun(SCENE, settings).curves
    assert made.colors is None and made.fibre is not None
    assert made.fibre.sigma_a == hair_fibre(settings).sigma_a and made.fibre.tilt == math.radians(5)
    assert made.fibre.beta_m == YARNS["wool"].roughness[0]
    own = Fibre((1.0, 2.0, 3.0))
    made, = spun(Scene("own", curves=(replace(YARN, fibre=own),)), settings).curves
    assert made.fibre == own and made.colors is not None


def test_the_fibres_are_kept_for_other_scenes_of_the_same_curves() -> None:
    made, = spun(SCENE, WOOL).curves
    assert spun(SCENE.relit(lights=(Light("directional"),)), WOOL).curves[0] is made
    assert spun(SCENE, replace(WOOL, yarn_plies=3)).curves[0] is not made


def test_axes_of_yarns_have_the_fibre_and_stand_for_all_of_them() -> None:
    shown = as_yarns(SCENE, WOOL)
    yarn, = shown.curves
    assert yarn.fibre == YARNS["wool"].fibre and yarn.points is YARN.points and yarn.colors is YARN.colors
    assert as_yarns(SCENE, WOOL) is shown and as_yarns(shown, WOOL) is shown and as_yarns(SCENE, Settings()) is SCENE
    assert as_yarns(SCENE.relit(lights=()), WOOL).curves[0] is yarn
    assert as_yarns(SCENE, replace(WOOL, hair_color=(1, 0, 0))).curves[0].colors is None
    kind = YARNS["wool"]
    dense, = dense_curves(SCENE, WOOL)
    np.testing.assert_allclose(dense.radii, 0.5 * kind.radius * kind.plies * kind.fibres, rtol=1e-6)
    assert dense_curves(SCENE, Settings()) == SCENE.curves


def test_info_counts_plies_and_fibres() -> None:
    yarns, = describe_scene(SCENE.relit(lights=(Light("directional"),)), WOOL)["yarns"]
    made, = spun(SCENE, WOOL).curves
    assert {name: yarns[name] for name in ("kind", "yarns", "plies", "fibres", "hairs", "segments")} == {
        "kind": "wool", "yarns": 1, "plies": 2, "fibres": 36, "hairs": 10, "segments": int(made.spans.sum())}
    assert "yarns" not in describe_scene(SCENE, replace(WOOL, yarn="off"))


def test_settings_without_effect_are_said() -> None:
    assert unused_settings(Scene("none"), WOOL) == ["yarn has no effect: there are no curves"]
    assert unused_settings(SCENE, Settings.of(yarn_plies=2, yarn_hairs=0)) == [
        "yarn_plies and yarn_hairs have no effect: the setting yarn is off"]
    assert unused_settings(SCENE, replace(WOOL, yarn_plies=2)) == []
