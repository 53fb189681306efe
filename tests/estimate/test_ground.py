"""The shadow on the ground: light that a model hides, in both renderers, against what can be worked out."""

from __future__ import annotations

from dataclasses import replace
from math import atan, pi, sqrt

import numpy as np
import pytest
from shapes import constant, facing_floor, lopsided, moved, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.ground import ground_height
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene

SIZE = (24, 18)
BLACK = Material(base_color=(0, 0, 0, 1), metallic=0.0, perceptual_roughness=1.0, specular=0.0, double_sided=True)
SUN = Light("directional", intensity=3.0, direction=(0, -1, 0))


def hovering(scale: float = 1.0, offset=(0.0, 0.0, 0.0), material: Material = BLACK, **around) -> Scene:
    """A plate of half a unit to each side, one unit above the ground, on which a dot stands far beside it."""
    place = moved(offset, scale)
    return scene((plate(0, 0.5), place @ facing_floor(y=1.0)), (plate(0, 1e-4), place @ moved((4, 0, 0))),
                 materials=(material,), **around)


def shadow(shown: Scene, mode: str, camera: Camera, **settings) -> np.ndarray:
    """Alpha where the model is not, NaN where it may be."""
    more = {"spp": 16} if mode == "path" else {"antialias": "none"}
    image = viewer.render(shown, SIZE, camera, mode=mode, ground="shadow", background="none", aov=["instance"],
                          **more | settings)
    assert np.isfinite(image.linear).all() and image.linear.min() >= 0
    model = image.layers["instance"] > 0
    for axis, way in ((0, 1), (0, -1), (1, 1), (1, -1)):
        model |= np.roll(model, way, axis)
    assert (image.linear[~model][:, :3] == 0).all()  # black, with alpha
    return np.where(model, np.nan, image.linear[..., 3])


def seen(shown: Scene, camera: Camera) -> np.ndarray:
    """The points of the ground at the pixels' centres, in units of the plate, (H, W, 2)."""
    frame = Frame(shown, camera, SIZE)
    x, y = ((2 * np.arange(count) + 1) / count - 1 for count in SIZE)
    d = np.stack(np.broadcast_arrays(x[None, :], -y[:, None], 1.0), axis=-1) @ frame.ray.T
    way = (ground_height(shown) - camera.eye[1]) / d[..., 1]
    return (camera.eye + way[..., None] * d)[..., [0, 2]]


def from_above(scale: float = 1.0, offset=(0.0, 0.0, 0.0)) -> Camera:
    eye, target = np.array(offset) + scale * np.array([[0.3, 2.2, 4.0], [0.0, 0.0, 0.0]])
    return Camera.look_at(eye, target)


@pytest.mark.parametrize("mode", ["pbr", "phong", "path"])
@pytest.mark.parametrize(("scale", "offset"), [(1.0, (0, 0, 0)), (1e-6, (1e-3, 0, 2e-3))])
def test_a_sun_overhead_leaves_the_outline_of_a_plate(mode, scale, offset):
    shown, camera = hovering(scale, offset, lights=(SUN,)), from_above(scale, offset)
    alpha = shadow(shown, mode, camera)
    at = np.abs(seen(shown, camera) - np.array(offset)[[0, 2]]).max(axis=-1) / scale
    known = np.isfinite(alpha) & (np.abs(at - 0.5) > 0.02)
    assert (known & (at < 0.5)).sum() > 5 and (known & (at > 0.5)).sum() > 100
    np.testing.assert_allclose(alpha[known], at[known] < 0.5, atol=1e-5)


@pytest.mark.parametrize(("mode", "bound", "scale", "offset"), [
    ("pbr", 0.06, 1.0, (0, 0, 0)), ("pbr", 0.06, 1e6, (1e9, 0, 2e9)), ("path", 0.06, 1.0, (0, 0, 0))])
def test_a_sky_is_hidden_as_much_as_the_form_factor_of_a_plate(mode, bound, scale, offset):
    """That of a rectangle from the corner of which a point lies one unit away (Howell, C-11), four of which meet above
    the point."""
    shown, camera = hovering(scale, offset, environment=constant()), from_above(scale, offset)
    alpha = shadow(shown, mode, camera, **({"spp": 128} if mode == "path" else {}))
    at = (seen(shown, camera) - np.array(offset)[[0, 2]]) / scale

    def corner(a: float, b: float) -> float:
        return (a / sqrt(1 + a * a) * atan(b / sqrt(1 + a * a)) + b / sqrt(1 + b * b) * atan(a / sqrt(1 + b * b))
                ) / (2 * pi)

    def factor(x: float, z: float) -> float:
        return sum(corner(0.5 + sx * x, 0.5 + sz * z)
                   for sx in (-1, 1) for sz in (-1, 1))

    expected = np.array([factor(x, z) for x, z in at.reshape(-1, 2)]).reshape(alpha.shape)
    known = np.isfinite(alpha)
    assert expected[known].max() > 0.2
    assert np.abs(alpha - expected)[known].max() < bound and np.abs(alpha - expected)[known].mean() < 0.015


def test_both_renderers_agree_on_a_ball_under_a_lopsided_sky():
    white = Material(metallic=0.0, perceptual_roughness=1.0, specular=0.0, base_color=(0.5, 0.5, 0.5, 1))
    shown = scene(sphere(segments=32), materials=(white,), environment=lopsided(),
                  lights=(Light("directional", intensity=2.0, direction=(-0.5, -1, -0.3)),))
    camera = Camera.look_at((0.5, 2.5, 6.0), (0, -0.5, 0))
    raster, traced = shadow(shown, "pbr", camera), shadow(shown, "path", camera, spp=1024)
    known = np.isfinite(raster) & np.isfinite(traced)
    apart = np.abs(raster - traced)[known]
    assert min(raster[known].max(), traced[known].max()) > 0.45
    assert apart.mean() < 0.01 and np.quantile(apart, 0.98) < 0.06 and apart.max() < 0.15


def test_what_shines_casts_a_shadow_too_and_lights_nothing():
    lamp = replace(BLACK, emissive=(50.0, 50.0, 50.0))
    for mode in ("pbr", "path"):
        dark, bright = (shadow(hovering(material=material, lights=(SUN,)), mode, from_above())
                        for material in (BLACK, lamp))
        np.testing.assert_allclose(bright, dark, atol=1e-6)


def test_the_shadow_darkens_what_is_behind():
    shown, camera = hovering(lights=(SUN,), environment=constant(0.5)), from_above()
    for mode in ("pbr", "path"):
        more = {"spp": 16} if mode == "path" else {"antialias": "none"}
        alone = viewer.render(shown, SIZE, camera, mode=mode, ground="shadow", background="none", **more).linear
        for background, behind in (("env", 0.5), ((0.2, 0.4, 0.1), (0.2, 0.4, 0.1))):
            image = viewer.render(shown, SIZE, camera, mode=mode, ground="shadow", background=background, **more)
            is_ground = (alone[..., :3] == 0).all(axis=-1) & (alone[..., 3] < 1)
            expected = (1 - alone[..., 3:]) * np.array(behind)
            np.testing.assert_allclose(image.linear[is_ground][:, :3], np.broadcast_to(
                expected, image.linear[..., :3].shape)[is_ground], atol=2e-3)
            assert (image.linear[..., 3] == 1).all()


def test_without_it_nothing_is_planned_and_from_below_nothing_is_seen():
    shown = hovering(lights=(SUN,))
    plain = viewer.render(shown, SIZE, from_above())
    assert "ground" not in plain.stats["plan"]["passes"]
    assert "the shadow on the ground: not requested" in plain.stats["plan"]["left_out"]
    below = Camera.look_at((0.3, -2.0, 4.0), (0, 0, 0))
    for mode in ("pbr", "path"):
        alpha = shadow(shown, mode, below, **({"spp": 4} if mode == "path" else {}))
        assert not alpha[np.isfinite(alpha)].any()


def test_budgets_and_told_errors_do_not_know_it():
    for more, words in (({"time_budget": 1.0}, "time budget"), ({"tell_error": 1.0}, "tell_error does not know")):
        with pytest.raises(UsageError, match=words):
            viewer.render(hovering(), SIZE, ground="shadow", **more)
