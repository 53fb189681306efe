"""Yarns in the raster: their fibres are those of mode path, and the levels of detail agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.plan.planner import plan_scene
from viewer.raster import yarns
from viewer.raster.yarns import FIBRES, PLIES, TUBES, YarnBuffers, optical_depths
from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.environment_presets import make_preset
from viewer.scene.frame import Frame
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.yarn.fibres import yarn_fibres
from viewer.scene.yarn.kind import YARNS
from viewer.settings import Settings

SUN = Light("directional", intensity=3.0, direction=(-0.5, -0.6, -0.6))
FRONT = replace(Camera.look_at((0, 0, 10), (0, 0, 0)), height=2.4)
PLAIN = {"background": "none", "hair_scattering": "single"}


def wave(count: int = 3, apart: float = 0.7, radius: float = 0.3) -> Curves:
    """Yarns along +X beside each other."""
    x = np.linspace(-1.6, 1.6, 9)
    points = np.stack([np.stack([x, k * apart + 0.1 * np.sin(3 * x), 0.1 * np.cos(2 * x)], axis=1)
                       for k in np.arange(count) - (count - 1) / 2])
    return Curves("yarns", points.reshape(-1, 3), np.full(9 * count, radius), 9 * np.arange(count + 1),
                  np.zeros(count, bool), "catmull-rom")


def lit(curves: Curves) -> Scene:
    return Scene("yarns", curves=(curves,), environment=make_preset("sky"), lights=(SUN,))


@pytest.mark.parametrize("name", ["cotton", "silk"])
def test_the_fibres_are_those_of_mode_path(radiance, name):
    """As curves they cover the same pixels, also those of closed yarns."""
    ring = Curves("ring", [[-0.7, -0.6, 0], [0.7, -0.6, 0], [0.7, 0.6, 0], [-0.7, 0.6, 0]], np.full(4, 0.3), [0, 4],
                  [True], "catmull-rom")
    for curves in (wave(), ring):
        fibres = yarn_fibres(curves, replace(YARNS[name], hairs=0.0))
        expected = radiance(lit(fibres), FRONT, (96, 96), **PLAIN, antialias="none")[..., 3]
        found = radiance(lit(curves), FRONT, (96, 96), **PLAIN, antialias="none", yarn=name)[..., 3]
        assert 0.3 < expected.mean() < 0.9 and np.abs(found - expected).mean() < 0.03


@pytest.mark.parametrize("name", ["cotton", "wool"])
@pytest.mark.parametrize("light", ["sun", "sky"])
def test_levels_of_detail_agree(radiance, monkeypatch, name, light):
    """The mean radiance, and what they cover, within 8 % of each other."""
    model = lit(wave(5, 0.45, 0.2))
    model = replace(model, lights=(SUN,) if light == "sun" else (), environment=model.environment if light == "sky"
                    else None)
    found = []
    for plies, fibres in ((1e9, 1e9), (0, 1e9), (0, 0)):
        monkeypatch.setattr(yarns, "PLY_PIXELS", plies)
        monkeypatch.setattr(yarns, "FIBRE_PIXELS", fibres)
        found.append(radiance(model, FRONT, (32, 32), yarn=name, background="none",
                              antialias="ssaa-4").mean(axis=(0, 1)))
    for level in found[:2]:
        np.testing.assert_allclose(level, found[2], rtol=0.08)
    assert found[2][:3].min() > 0.01


def test_a_yarn_is_shown_by_its_width_and_left_out_where_it_is_not_seen(context):
    curves = wave(1)
    buffers = YarnBuffers(context.gl, curves, None, YARNS["cotton"])
    silk = YarnBuffers(context.gl, curves, None, YARNS["silk"])

    def levels(of: YarnBuffers, camera: Camera, size: int) -> set[int]:
        frame = Frame(lit(curves), camera, (size, size))
        return set(of.levels(frame.view_projection @ frame.model(np.eye(4)), (size, size)).tolist())

    for size, level in ((16, TUBES), (48, PLIES), (128, FIBRES)):  # 0.6 of 2.4 units
        assert levels(buffers, FRONT, size) == {level}
    assert levels(silk, FRONT, 48) == {TUBES}  # of one ply
    aside = replace(Camera.look_at((50, 0, 10), (50, 0, 0)), height=2.4)
    behind = Camera.look_at((0, 0, 10), (0, 0, 20))
    assert levels(buffers, aside, 128) == levels(buffers, behind, 128) == {-1}
    near = Camera.look_at((0, 0, 1.2), (0, 0, 0))
    assert levels(buffers, near, 128) == {FIBRES}
    buffers.release()
    silk.release()


def test_the_tube_covers_as_much_as_plies_do():
    for kind in YARNS.values():
        yarn, tube, ply = optical_depths(kind)
        assert tube == pytest.approx(yarn) if kind.plies == 1 else 0.5 * yarn < tube < yarn < ply


@pytest.mark.parametrize("radii", [(0.0, 0.0, 0.0), (0.3, 0.0, 0.3)])
def test_yarns_that_are_hardly_any_are_drawn_without_a_hole_in_the_picture(radiance, radii):
    """Without thickness, and with a cusp."""
    curves = Curves("cusp", [[-1, 0, 0], [1, 0, 0], [-1, 0, 0]], radii, [0, 3], [False])
    pixels = radiance(lit(curves), FRONT, (24, 24), yarn="silk", background="none")
    assert np.isfinite(pixels).all() and (pixels[..., 3].sum() > 20) == (max(radii) > 0.1)


def test_plans_name_yarns_and_only_their_programs_have_them():
    model = lit(wave())

    def plan(**settings):
        return plan_scene(model, Settings.of(**settings), model.lights, samples=1, half_target=False,
                          orthographic=False)

    found = plan(yarn="cotton")
    assert {p.fragment for p in found.curves.programs} == {"raster/yarn.frag", "raster/curve_depth.frag"}
    assert any("yarns, as tubes, from 8 pixels on as plies and from 20 as fibres" in line for line in found.used)
    assert {p.fragment for p in plan().curves.programs} == {"raster/curve.frag", "raster/curve_depth.frag"}
    assert all(dict(p.switches)["YARN"] == 0 for p in plan().curves.programs)
