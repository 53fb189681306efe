"""Shadows of a ball on a floor, against rays traced in float64."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from shapes import WHITE, facing_floor, moved, orthographic, pixel_points, plate, scene, seen_plane, sphere

from viewer.raster import shadows
from viewer.raster.shadows import draw_meshes, light_tiles
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions, texel_solid_angles
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh

SIZE = (96, 96)
TEXELS = 3.0
"""What a shadow's edge may be off by, in texels of the map: its filter reaches 1.5, the offset against acne 2."""
CAMERA = orthographic(0.6, 0.5, height=4.0, distance=10.0)
RADIUS = 0.6
CENTER = np.array([0.0, RADIUS, 0.0])  # the ball rests on the floor: a shadow that has come loose would show there

LIGHTS = {
    "directional": Light.from_angles(-0.9, 0.8, 2.0),
    "grazing": Light.from_angles(2.2, 0.15, 5.0),
    "point": Light("point", intensity=8.0, position=(1.5, 1.8, 0.4)),
    "spot": Light("spot", intensity=20.0, position=(-1.2, 2.6, 1.0), direction=(0.396, -0.859, -0.33),
                  inner_cone=0.4, outer_cone=0.6),
}


def room(light: Light | None = None, **fields):
    return scene((plate(0, half=3.0), facing_floor()), (sphere(segments=128), moved(CENTER, RADIUS)),
                 lights=(light,) if light else (), **fields)


def floor_seen() -> tuple[np.ndarray, np.ndarray]:
    """The points of the floor in the picture, (H, W, 3), and where they are not hidden by the ball."""
    points = seen_plane(CAMERA, SIZE, (0, 1, 0))
    start = pixel_points(CAMERA, SIZE)
    along = (CENTER - start) @ CAMERA.forward
    miss = np.linalg.norm(start + along[..., None] * CAMERA.forward - CENTER, axis=-1)
    return points, (miss > RADIUS * 1.05) & (np.abs(points) < 2.9).all(axis=-1)


def clearance(points: np.ndarray, light: Light) -> np.ndarray:
    """How far the ray from each point to the light passes from the ball's surface; negative in shadow."""
    if light.kind == "directional":
        to_light = np.broadcast_to(-np.array(light.direction), points.shape)
    else:
        to_light = np.array(light.position) - points
        to_light = to_light / np.linalg.norm(to_light, axis=-1, keepdims=True)
    along = np.maximum(((CENTER - points) * to_light).sum(axis=-1), 0)
    return np.linalg.norm(points + along[..., None] * to_light - CENTER, axis=-1) - RADIUS


def texel(points: np.ndarray, light: Light, model) -> np.ndarray:
    """A texel's size at each point, in the world."""
    layers = 6 if light.kind == "point" else 1
    size = min(2048, 4096 // int(np.ceil(np.sqrt(layers))))
    tile = light_tiles(light, model, size)[0]
    d = np.linalg.norm(points - np.array(light.position), axis=-1)
    return tile.texel * model.radius + tile.texel_per_distance * d


@pytest.mark.parametrize("mode", ["pbr", "phong"])
@pytest.mark.parametrize("name", LIGHTS)
def test_shadow_falls_where_rays_say(radiance, name, mode):
    light, model = LIGHTS[name], room(LIGHTS[name])
    bare = radiance(model, CAMERA, SIZE, mode=mode, shadows="off")[..., 0]
    shaded = radiance(model, CAMERA, SIZE, mode=mode)[..., 0]
    points, visible = floor_seen()
    lit = visible & (bare > 1e-3)
    gap, tolerance = clearance(points, light), TEXELS * texel(points, light, model)
    inside, outside = lit & (gap < -tolerance), lit & (gap > tolerance)
    assert inside.sum() > 100 and outside.sum() > 500
    assert inside.sum() + outside.sum() > 0.98 * lit.sum()  # the edge is a small part of the picture
    assert (shaded[inside] == 0).all()
    assert np.abs(shaded / np.maximum(bare, 1e-9) - 1)[outside].max() < 1e-5


@pytest.mark.parametrize("name", ["directional", "grazing", "point", "spot"])
def test_no_acne_where_nothing_is_in_the_way(radiance, name):
    """A ball alone: with and without shadows the lit side is the same."""
    light = LIGHTS[name]
    model = scene((sphere(segments=128), moved(CENTER, RADIUS)), lights=(light,))
    camera = orthographic(-0.5, 0.4, height=3.0)
    bare, shaded = (radiance(model, camera, SIZE, shadows=on)[..., 0] for on in ("off", "on"))
    lit = bare > 0.02 * bare.max()
    assert lit.sum() > 100
    assert (shaded[lit] / bare[lit]).min() > 0.95
    assert np.abs(shaded - bare).max() < 0.02 * bare.max()


def test_no_acne_on_a_coarse_ball(radiance):
    """Flat facets under smooth normals: the map sees the facets."""
    model = scene(sphere(segments=12), lights=(LIGHTS["directional"],))
    camera = orthographic(-0.5, 0.4, height=3.0)
    bare, shaded = (radiance(model, camera, SIZE, shadows=on)[..., 0] for on in ("off", "on"))
    lit = bare > 0.5 * bare.max()
    assert (shaded[lit] / bare[lit]).min() > 0.95


def light_under(radiance, light: Light, *cards, **material) -> np.ndarray:
    """The radiance of a white floor under cards of one material, where none is in view."""
    points = seen_plane(CAMERA, SIZE, (0, 1, 0))
    under = (np.abs(points[..., [0, 2]]) < 0.4).all(axis=-1)
    material = Material(double_sided=True, **material)
    floor = (plate(0, half=3.0), facing_floor())
    model = scene(floor, *((plate(1, half=0.5), facing_floor(y=y)) for y in cards), materials=[WHITE, material],
                  lights=(light,))
    start, forward = pixel_points(CAMERA, SIZE), CAMERA.forward
    for y in cards:
        on_card = start + ((y - start[..., 1]) / forward[1])[..., None] * forward
        under &= (np.abs(on_card[..., [0, 2]]) > 0.55).any(axis=-1)
    seen = radiance(model, CAMERA, SIZE)[under][..., 0]
    assert len(seen) > 30
    return seen


ABOVE = Light("directional", intensity=np.pi, direction=(0, -1, 0))


@pytest.mark.parametrize("mode, alpha, expected", [("opaque", 0.0, 0.0), ("mask", 0.2, 1.0), ("mask", 0.8, 0.0)])
def test_a_mask_lets_light_through_its_holes(radiance, mode, alpha, expected):
    seen = light_under(radiance, ABOVE, 1.0, base_color=(1, 1, 1, alpha), alpha_mode=mode)
    assert np.abs(seen - expected).max() < 1e-4


@pytest.mark.parametrize("light", [ABOVE, Light("point", intensity=np.pi * 16, position=(0, 4, 0))],
                         ids=lambda light: light.kind)
@pytest.mark.parametrize("alpha", [0.0, 0.2, 0.5, 0.85, 1.0])
def test_a_blended_surface_lets_through_the_share_that_it_does_not_cover(radiance, light, alpha):
    """Its shadow has 16 steps and no pattern."""
    seen = light_under(radiance, light, 1.0, base_color=(1, 1, 1, alpha), alpha_mode="blend")
    seen = seen / light_under(radiance, light, 1.0, base_color=(1, 1, 1, 0), alpha_mode="blend")
    assert seen.mean() == pytest.approx(1 - alpha, abs=0.02 + 1 / 32 * (0 < alpha < 1))
    assert seen.std() < 1e-3


def test_the_shadows_of_blended_surfaces_add_up(radiance):
    seen = light_under(radiance, ABOVE, 1.0, 2.0, 3.0, base_color=(1, 1, 1, 0.5), alpha_mode="blend")
    assert seen.mean() == pytest.approx(1 / 8, abs=1 / 16)


def test_both_walls_of_a_blended_box_cast_shadows(radiance):
    """One of them faces the light and one does not."""
    walls = plate(1, half=0.5)
    box = Mesh("box", np.concatenate([walls.positions, walls.positions * (1, 1, 0) + (0, 0, 0.3)]), 1,
               indices=np.concatenate([walls.indices, walls.indices[::-1] + 4]))
    pane = Material(base_color=(0, 0, 0, 0.5), alpha_mode="blend", double_sided=True)
    model = scene((plate(0, half=3.0), facing_floor()), (box, facing_floor(y=2.0)), materials=[WHITE, pane],
                  lights=(ABOVE,))
    camera = orthographic(0.0, np.pi / 12, height=0.2, distance=10.0)  # it looks under the box
    assert radiance(model, camera, (16, 16))[..., 0].mean() == pytest.approx(0.25, abs=0.07)


PANE = {"metallic": 0.0, "perceptual_roughness": 0.0, "transmission": 1.0}


def through_a_wall(cosine: float, ior: float) -> float:
    """1 - 2 R / (1 + R): what smooth glass transmits straight on, by Fresnel's equations."""
    inside = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s, p = (cosine - ior * inside) / (cosine + ior * inside), (ior * cosine - inside) / (ior * cosine + inside)
    r = (s * s + p * p) / 2
    return 1 - 2 * r / (1 + r)


@pytest.mark.parametrize("changes, share", [
    ({}, 1.0), ({"transmission": 0.5}, 0.5), ({"base_color": (0.9, 0.3, 0.3, 1.0)}, 0.2126 * 0.6 + 0.3),
    ({"specular": 0.0}, None), ({"base_color": (1, 1, 1, 0.5), "alpha_mode": "blend"}, None),
    ({"perceptual_roughness": 0.4}, 0.0), ({"thickness": 0.1}, 0.0), ({"clearcoat": 1.0}, 0.0)])
@pytest.mark.parametrize("slant", [0.0, 1.2])
def test_lamps_shine_through_thin_smooth_panes(radiance, changes, share, slant):
    """By its luminance, as shadow rays of mode path do, in 16 steps; rough glass, coated glass and solids are opaque.
    """
    sun = replace(ABOVE, direction=(np.sin(slant), -np.cos(slant), 0.0))
    pane = Material(double_sided=True, **PANE | changes)
    floor, card = (plate(0, half=1.0), facing_floor()), (plate(1, half=6.0), facing_floor(y=2.0))
    camera = orthographic(0.0, np.pi / 12, height=0.2, distance=5.0)  # it looks under the pane
    shaded, bare = (radiance(scene(floor, *cards, materials=[WHITE, pane], lights=(sun,)), camera, (16, 16))[..., 0]
                    for cards in ([card], []))
    passed = through_a_wall(np.cos(slant), 1.5)
    expected = 1.0 if "specular" in changes else 0.5 + 0.5 * passed if "alpha_mode" in changes else share * passed
    assert (shaded / bare).mean() == pytest.approx(expected, abs=0.02 + 1 / 32 * (expected > 0))
    assert (shaded / bare).std() < 5e-3


def sun_environment(direction, lux: float, around: float) -> Environment:
    """A disk of 0.6 degrees of `lux` in light of `around` from everywhere else."""
    height = 512
    covered = texel_directions(height, 2 * height) @ np.asarray(direction) > np.cos(np.radians(0.6))
    solid_angle = (covered * texel_solid_angles(height, 2 * height)[:, None]).sum()
    radiance = np.full((height, 2 * height, 3), around, np.float32)
    radiance[covered] += lux / solid_angle
    return Environment("sun", radiance)


@pytest.mark.parametrize("rotation", [0.0, 1.0])
def test_the_sun_of_an_environment(radiance, rotation):
    """It casts a shadow away from itself, and its light on a white plate is what the map holds."""
    azimuth, elevation, lux, around = -1.4, 0.6, 4.0, 0.3
    stands = -np.array(Light.from_angles(azimuth, elevation, lux).direction)
    turned = Light.from_angles(azimuth + rotation, elevation, lux)
    environment = sun_environment(stands, lux, around)
    environment = replace(environment, rotation=rotation)
    picture = radiance(room(environment=environment), CAMERA, SIZE)[..., :3]
    points, visible = floor_seen()
    gap = clearance(points, turned)
    inside, outside = visible & (gap < -0.02), visible & (gap > 0.02)
    assert inside.sum() > 100 and outside.sum() > 500
    sky = around  # an irradiance of pi around, over pi; what the ball hides of it is not modelled
    assert np.abs(picture[outside] / (lux * np.sin(elevation) / np.pi + sky) - 1).max() < 0.01
    assert np.abs(picture[inside] / sky - 1).max() < 0.01


def test_triangles_that_wait_to_be_drawn_are_bounded(monkeypatch):
    """Of three plates in four maps, at most five triangles wait: the driver is waited for after six."""
    monkeypatch.setattr(shadows, "_MOST_WAITING", 5)
    plates = scene(plate(), plate(), plate())
    draws = [SimpleNamespace(mesh=k, instances=()) for k in range(3)]
    tiles = light_tiles(LIGHTS["directional"], plates, 64) * 4
    calls: list[str] = []
    target = SimpleNamespace(ctx=SimpleNamespace(finish=lambda: calls.append("wait")))
    draw_meshes(target, [(0, 0, 64, 64)] * 4, plates, tiles, draws,
                lambda draw, to_center: lambda matrix, place: calls.append("draw"))
    assert calls == [*["draw"] * 3, "wait"] * 4
