"""Light through glass in screen space, where it can be worked out on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.bake.half_space import fresnel
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

SIZE = (48, 48)
FRONT = orthographic(height=0.5)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0)
R = ((1.5 - 1) / (1.5 + 1)) ** 2
RED = replace(WHITE, base_color=(0, 0, 0, 1), emissive=(4.0, 1.0, 0.5))


def middle(renderer, model: Scene, camera: Camera = FRONT, **settings) -> np.ndarray:
    """RGBA at the picture's centre."""
    picture = renderer.render(model, camera, Settings.of(**{"antialias": "none"} | settings), SIZE)
    assert np.isfinite(picture.linear).all()
    return picture.linear[23:25, 23:25].mean(axis=(0, 1))


@pytest.mark.parametrize("background", ["env", "none"])
@pytest.mark.parametrize("roughness", [0.0, 0.5])
@pytest.mark.parametrize("thickness", [0.0, 0.5])
def test_clear_glass_vanishes_in_the_furnace(renderer, background, roughness, thickness):
    """At every angle; behind it the environment stands where nothing was drawn."""
    glass = replace(GLASS, thickness=thickness, perceptual_roughness=roughness)
    model = scene(sphere(), materials=[glass], environment=constant())
    picture = renderer.render(model, orthographic(height=2.2), Settings.of(background=background), SIZE).linear
    inside = picture[..., 3] == 1
    assert inside[24, 24]
    assert np.abs(picture[inside][:, :3] - 1).max() < 0.01


def test_a_wall(renderer):
    """Two faces: 2 R / (1 + R) of light comes back, and the rest is tinted."""
    wall = replace(GLASS, base_color=(0.9, 0.5, 0.1, 1))
    found = middle(renderer, scene(plate(), materials=[wall], environment=constant()))
    back = 2 * R / (1 + R)
    assert found[:3] == pytest.approx(back + (1 - back) * np.array([0.9, 0.5, 0.1]), abs=2e-3)


@pytest.mark.parametrize("curve", ["schlick", "exact"])
@pytest.mark.parametrize("thickness", [0.0, 0.5])
@pytest.mark.parametrize("ior", [1.0, 1.2, 1.5, 2.4])
def test_black_glass_reflects_by_fresnels_equations_at_every_angle(renderer, ior, thickness, curve):
    """Not by Schlick's curve, which opaque surfaces may have. Glass with the index of air reflects nothing."""
    black = replace(GLASS, base_color=(0, 0, 0, 1), ior=ior, thickness=thickness)
    model = scene((plate(), facing_floor()), materials=[black], environment=constant())
    for mu in (0.2, 0.3, 0.5, 0.8):
        found = middle(renderer, model, orthographic(elevation=np.arcsin(mu), height=0.2), fresnel=curve)
        R = fresnel(np.array([mu]), ior)[0]
        assert found[:3] == pytest.approx(R if thickness else 2 * R / (1 + R), abs=0.01)


def test_a_wall_that_transmits_half_reflects_half_by_schlicks_curve(renderer):
    """The other half of it is opaque, and has one face."""
    black = replace(GLASS, base_color=(0, 0, 0, 1), transmission=0.5)
    model = scene((plate(), facing_floor()), materials=[black], environment=constant())
    found = middle(renderer, model, orthographic(elevation=np.arcsin(0.3), height=0.2))
    glass = fresnel(np.array([0.3]), 1.5)[0]
    opaque = R + (1 - R) * 0.7**5
    assert found[:3] == pytest.approx((2 * glass / (1 + glass) + opaque) / 2, abs=0.01)


def test_rough_walls_reflect_as_facets_of_both_faces(renderer):
    """As the mean of 2 R / (1 + R) over the facets that are seen, from the path tracer."""
    black = replace(GLASS, base_color=(0, 0, 0, 1), perceptual_roughness=0.4)
    model = scene((plate(), facing_floor()), materials=[black], environment=constant())
    camera = orthographic(elevation=np.radians(17), height=0.2)
    wanted = Tracer(renderer.context).render(model, camera, Settings.of(mode="path", spp=256), (16, 16)).linear
    assert middle(renderer, model, camera)[:3] == pytest.approx(wanted[..., :3].mean(axis=(0, 1)), abs=0.02)


@pytest.mark.parametrize("thickness", [0.0, 0.5])
def test_rough_glass_reflects_a_lamp_away_from_the_mirror(renderer, thickness):
    """By the facets that it meets, which are seen at another angle than the surface. An environment changes nothing."""
    black = replace(GLASS, base_color=(0, 0, 0, 1), perceptual_roughness=0.3, thickness=thickness)
    sun, camera = Light("directional", intensity=10.0, direction=(0, -1, 0)), orthographic(elevation=0.3, height=0.02)
    model = scene((plate(), facing_floor()), materials=[black], lights=(sun,))
    settings = Settings.of(mode="path", spp=64)
    wanted = Tracer(renderer.context).render(model, camera, settings, (16, 16)).linear[..., :3].mean()
    dark, lit = (middle(renderer, model.relit(environment=constant(), lights=lights), camera)[:3]
                 for lights in ((), (sun,)))
    for found in (middle(renderer, model, camera)[:3], lit - dark):
        assert found == pytest.approx(wanted, rel=0.3)


@pytest.mark.parametrize("largest", [{"ior": 1e9, "dispersion": 1e9}, {"iridescence": 1.0, "iridescence_ior": 1e9}])
@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_the_largest_indices_stay_finite(radiance, largest, roughness):
    body = replace(GLASS, thickness=0.5, perceptual_roughness=roughness, **largest)
    model = scene(sphere(segments=16), materials=[body], environment=constant())
    assert np.isfinite(radiance(model, FRONT, (8, 8))).all()


@pytest.mark.parametrize("scale", [0.01, 1.0, 30.0])
def test_a_body_absorbs_by_its_thickness_in_the_world(renderer, scale):
    """A mesh that is scaled is as much thicker; the distance at which light is attenuated is not."""
    body = replace(GLASS, thickness=0.5, attenuation_distance=0.25, attenuation_color=(0.8, 0.3, 0.01))
    camera = replace(FRONT, height=0.5 * scale)
    model = scene((plate(), moved((0, 0, 0), scale)), materials=[body], environment=constant())
    kept = np.array([0.8, 0.3, 0.01]) ** (2 * scale)
    assert middle(renderer, model, camera)[:3] == pytest.approx(R + (1 - R) * kept, abs=2e-3)


@pytest.mark.parametrize("samples", ["none", "msaa-4"])
def test_opaque_surfaces_and_other_walls_are_seen_through_a_wall(renderer, samples):
    """In whichever order the file has them."""
    model = scene((plate(0), moved((0, 0, -1))), (plate(1), moved((0, 0, 0))), (plate(1), moved((0, 0, -0.5))),
                  materials=[RED, GLASS])
    kept = (1 - 2 * R / (1 + R)) ** 2
    found = middle(renderer, model, antialias=samples)
    assert found == pytest.approx([4 * kept, kept, 0.5 * kept, 1], abs=5e-3)


@pytest.mark.parametrize("double_sided, walls", [(True, 2), (False, 1)])
def test_both_walls_of_a_hollow_ball_tint_what_is_behind(renderer, double_sided, walls):
    wall = replace(GLASS, base_color=(0.9, 0.5, 0.2, 1), double_sided=double_sided)
    model = scene((plate(0), moved((0, 0, -2))), (sphere(1), np.eye(4)), materials=[RED, wall])
    kept = ((1 - 2 * R / (1 + R)) * np.array(wall.base_color[:3])) ** walls
    assert middle(renderer, model)[:3] == pytest.approx(kept * RED.emissive, rel=0.01)


def test_a_solid_is_seen_through_another(renderer):
    solid = replace(GLASS, thickness=0.1, attenuation_distance=0.1, attenuation_color=(0.8, 0.5, 0.3))
    model = scene((plate(0), moved((0, 0, -1))), (plate(1), moved((0, 0, 0))), (plate(1), moved((0, 0, -0.5))),
                  materials=[RED, solid])
    kept = ((1 - R) * np.array(solid.attenuation_color)) ** 2
    assert middle(renderer, model)[:3] == pytest.approx(kept * RED.emissive, rel=0.01)


def test_rough_glass_spreads_what_is_behind_it_and_keeps_its_light(renderer):
    """A strip a quarter as wide as the picture, through a pane: its light is all there, over more pixels."""
    strip = (plate(0, half=1.0), moved((0, 0, -0.5), (0.0625, 2, 1)))

    def row(roughness: float) -> np.ndarray:
        pane = (plate(1, half=4.0), np.eye(4))
        model = scene(strip, pane, materials=[RED, replace(GLASS, perceptual_roughness=roughness)])
        return renderer.render(model, FRONT, Settings.of(antialias="none"), SIZE).linear[24, :, 0]

    clear, rough = row(0.0), row(0.4)
    assert (clear > 1.8).sum() == pytest.approx(12, abs=1) and (rough > 0.2).sum() > 18
    assert rough.sum() == pytest.approx(clear.sum(), rel=0.1)


def sky() -> Environment:
    """1 above the horizon, 0 below."""
    up = texel_directions(64, 128)[..., 1:2] > 0
    return Environment("sky", np.repeat(up, 3, axis=2).astype(np.float32))


@pytest.mark.parametrize(("thickness", "seen_above"), [(2.0, 0.0), (0.02, 1.0)])
def test_a_ball_turns_the_world_over_and_a_bubble_does_not(renderer, thickness, seen_above):
    """Half a radius above the middle of a solid ball, and of a shell; seen from a little below the horizon."""
    black = replace(GLASS, thickness=thickness, specular=0.0)
    model = scene(sphere(), materials=[black], environment=sky())
    picture = renderer.render(model, orthographic(elevation=-0.1, height=2.0), Settings.of(), SIZE).linear[..., 0]
    assert picture[12, 24] == pytest.approx(seen_above, abs=0.05)
    assert picture[36, 24] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("thickness", [0.3, 0.6, 1.0])
def test_facets_of_a_round_body_do_not_show(renderer, thickness):
    """Each triangle has a curvature of its own, on which the guess of the far side depends, and is smooth all the
    same: a coarse ball looks like a fine one but for its outline. Light caught inside some triangles made them stand
    out."""
    body = replace(GLASS, thickness=thickness)
    camera, settings = orthographic(0.3, 0.3, height=1.6), Settings.of(antialias="none", background="none")
    coarse, fine = (renderer.render(scene(sphere(segments=segments), materials=[body], environment=lopsided()),
                                    camera, settings, (96, 96)).linear for segments in (20, 96))
    assert np.quantile(np.abs(coarse - fine), 0.99) < 0.05


@pytest.mark.parametrize("elevation", [-0.4, 0.4])
def test_what_a_flat_body_lets_through_goes_on_as_before(renderer, elevation):
    slab = replace(GLASS, thickness=0.5, specular=0.0)
    model = scene(plate(half=9.0), materials=[slab], environment=sky())
    camera = orthographic(elevation=elevation, height=0.5)
    assert middle(renderer, model, camera)[0] == pytest.approx(float(elevation < 0), abs=0.02)


def test_a_wall_shows_a_body_behind_it(renderer):
    body = replace(GLASS, thickness=1.0, emissive=(4.0, 1.0, 0.5))
    model = scene((plate(0), moved((0, 0, -1))), plate(1), materials=[body, GLASS])
    back = 2 * R / (1 + R)
    assert middle(renderer, model)[:3] == pytest.approx(np.array([4, 1, 0.5]) * (1 - back), abs=5e-3)


@pytest.mark.parametrize("glass", [
    replace(GLASS, perceptual_roughness=0.4, double_sided=True),
    replace(GLASS, perceptual_roughness=0.5, thickness=0.1, base_color=(0.8, 0.4, 0.2, 1))], ids=["wall", "slab"])
@pytest.mark.parametrize("angle", [0.1, 0.6])
def test_a_lamp_is_seen_through_rough_glass(renderer, context, glass, angle):
    """Blurred, as in mode path. A slab of it does not keep the sun from itself."""
    sun = Light("directional", intensity=3.0, direction=(np.sin(angle), -0.1, np.cos(angle)))
    back = plate(), moved((0, 0, -0.1)) @ np.diag([-1.0, 1.0, -1.0, 1.0])
    sides = [plate(), back] if glass.thickness > 0 else [plate()]
    model, camera = scene(*sides, materials=[glass], lights=(sun,)), Camera.look_at((0, 0, 4), (0, 0, 0), fov_y=0.2)
    found = middle(renderer, model, camera, background="none")[:3]
    paths = Tracer(context).render(model, camera, Settings.of(mode="path", spp=512, background="none"), (8, 8)).linear
    assert found == pytest.approx(paths[..., :3].mean(axis=(0, 1)), rel=0.1)


def test_half_of_each(renderer):
    """transmission 0.5 lies between a surface that scatters and one that transmits."""
    found = [middle(renderer, scene(plate(), materials=[replace(GLASS, transmission=t, thickness=1.0,
             base_color=(0.5, 0.5, 0.5, 1))], lights=(Light.from_angles(0.3, 0.4, 3.0),), environment=constant(0.5)))
             for t in (0.0, 0.5, 1.0)]
    assert found[1] == pytest.approx((found[0] + found[2]) / 2, rel=2e-3)


def test_without_light_glass_is_black_and_whole(renderer):
    assert middle(renderer, scene(plate(), materials=[GLASS])) == pytest.approx([0, 0, 0, 1])


def test_the_size_of_the_picture_may_change(renderer):
    model = scene(plate(), materials=[GLASS], environment=constant())
    for size in ((48, 48), (33, 17), (1, 1), (300, 2)):
        picture = renderer.render(model, FRONT, Settings.of(), size).linear
        assert picture.shape == (size[1], size[0], 4) and np.abs(picture - 1).max() < 0.01
