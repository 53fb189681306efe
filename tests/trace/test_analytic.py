"""Scenes whose radiance is known analytically."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere

from viewer.measure.compare.relmse import reduced
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene

FRONT = orthographic(0.4, 0.3, height=2.2)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
FURNACE = {
    "diffuse": (WHITE, {}),
    "plastic": (Material(metallic=0.0, perceptual_roughness=0.3), {}),
    "rough plastic": (Material(metallic=0.0, perceptual_roughness=1.0), {}),
    "mirror": (Material(perceptual_roughness=0.0), {}),
    "metal 0.3": (Material(perceptual_roughness=0.3), {}),
    "metal 1": (Material(perceptual_roughness=1.0), {}),
    "half metal": (Material(metallic=0.5, perceptual_roughness=0.6), {}),
    "beckmann": (Material(perceptual_roughness=0.6), {"ndf": "beckmann"}),
    "glass": (GLASS, {"fresnel": "exact"}),
    "diamond": (replace(GLASS, ior=2.4), {"fresnel": "exact"}),
    "thin glass": (replace(GLASS, thickness=0.0), {"fresnel": "exact"}),
}


@pytest.mark.parametrize("name", FURNACE)
def test_white_vanishes_in_the_furnace(tracer, name):
    """A white furnace: in uniform light of radiance 1, a surface that absorbs nothing has radiance 1."""
    material, settings = FURNACE[name]
    model = scene(sphere(segments=96), materials=[material], environment=constant())
    pixels = picture(tracer, model, FRONT, (32, 32), spp=64, **settings)[..., :3]
    assert pixels.mean() == pytest.approx(1, abs=0.003)
    assert np.abs(reduced(pixels, 4) - 1).max() < 0.05


@pytest.mark.parametrize("change, lobe", [
    ({}, "charlie"), ({"thickness": 0.0, "transmission": 0.5}, "charlie"), ({"clearcoat": 1.0}, "zeltner")])
def test_glass_below_fibres_vanishes_but_for_the_fit_of_their_albedo(tracer, change, lobe):
    """Charlie's is up to 0.005 too large, lest light be won."""
    material = replace(GLASS, sheen_color=(1.0, 1.0, 1.0), sheen_roughness=0.4, **change)
    model = scene(sphere(segments=96), materials=[material], environment=constant())
    pixels = picture(tracer, model, FRONT, (32, 32), spp=64, sheen=lobe)[..., :3]
    assert 0.995 < pixels.mean() < 1.002
    assert np.abs(reduced(pixels, 4) - 1).max() < 0.05


def box(half: float = 1.0, **material) -> Scene:
    """A closed room seen from inside. Its walls face inwards."""
    low, high = -half, half
    walls = []
    for axis in range(3):
        for side in (low, high):
            u, v = np.meshgrid([low, high], [low, high])
            corners = np.stack([u.ravel(), v.ravel()], -1)
            points = np.insert(corners, axis, side, axis=1)
            order = np.array([0, 1, 3, 0, 3, 2])
            outward = np.cross(points[1] - points[0], points[3] - points[0])
            inward = np.zeros(3)
            inward[axis] = -np.sign(side)
            walls.append(Mesh("wall", points.astype(np.float32), 0,
                              indices=(order if outward @ inward > 0 else order[::-1]).astype(np.uint32),
                              normals=np.tile(inward, (4, 1)).astype(np.float32)))
    return scene(*walls, materials=[replace(WHITE, **material)])


@pytest.mark.parametrize("albedo, bounces", [  # the last: paths carry so much that roulette bounds their probability
    (0.2, 1), (0.5, 1), (0.8, 1), (0.2, 64), (0.5, 64), (0.8, 64), (0.95, 8)])
def test_a_closed_glowing_box(tracer, albedo, bounces):
    """Walls of radiance E and albedo rho: E (1 + rho + ... + rho^bounces), which tends to E / (1 - rho)."""
    room = box(base_color=(albedo,) * 3 + (1.0,), emissive=(0.5, 1.0, 2.0))
    inside = Camera.look_at((0.3, -0.2, 0.4), (1, 0.5, -1), fov_y=np.radians(80))
    pixels = picture(tracer, room, inside, (24, 24), spp=64, bounces=bounces)[..., :3]
    expected = (1 - albedo ** (bounces + 1)) / (1 - albedo) * np.array([0.5, 1.0, 2.0])
    assert pixels.mean(axis=(0, 1)) == pytest.approx(expected, rel=0.005)


def test_a_directional_light_on_a_plane(tracer):
    """rho / pi E cos(theta), without noise, because the light has no size and the paths end after it."""
    grey = replace(WHITE, base_color=(0.8, 0.5, 0.2, 1))
    sun = Light.from_angles(0.0, np.radians(40), 3.0)
    model = scene((plate(), facing_floor()), materials=[grey], lights=(sun,))
    pixels = picture(tracer, model, orthographic(0.0, 1.0, height=0.5), (8, 8), spp=4)
    expected = np.array([0.8, 0.5, 0.2]) / np.pi * 3.0 * np.sin(np.radians(40))
    assert np.abs(pixels[..., :3] / expected - 1).max() < 1e-4


def test_a_point_light_falls_with_the_square(tracer):
    model = scene((plate(half=3.0), facing_floor()), lights=(Light("point", intensity=2.0, position=(0, 1.5, 0)),))
    above = Camera.look_at((0, 8, 0), (0, 0, 0), up=(0, 0, -1))
    above = replace(above, height=4.0)
    pixels = picture(tracer, model, above, (33, 33), spp=64)[..., 0]
    axis = (np.arange(33) - 16) * 4 / 33
    square = axis[:, None] ** 2 + axis**2 + 1.5**2
    expected = 2.0 / np.pi * 1.5 / square**1.5
    assert np.abs(pixels / expected - 1).max() < 0.01


def panel(radiance: float, half: float, height: float, **camera: float) -> tuple[Scene, Camera]:
    """A white floor under an emissive square that faces it, with the camera on the middle of the floor."""
    glow = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(radiance,) * 3)
    down = np.eye(4)
    down[:3, :3] = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)
    down[1, 3] = height
    model = scene((plate(0, half=4.0), facing_floor()), (plate(1, half=half), down), materials=[WHITE, glow])
    return model, Camera.look_at((0, 0.3, 0.6), (0, 0, 0), fov_y=np.radians(1.0))


@pytest.mark.parametrize("sampling, half, height", [
    *((sampling, *size) for sampling in ("mis", "lights", "bsdf") for size in ((0.5, 1.0), (2.0, 0.7))),
    ("mis", 0.01, 1.0), ("lights", 0.01, 1.0)])
def test_a_glowing_square(tracer, sampling, half, height):
    """Irradiance below the middle of a square (Howell's C-11, four quarters): each way of sampling finds the same."""
    model, camera = panel(10.0, half, height)
    a = half / height
    form = 4 / (2 * np.pi) * 2 * a / np.sqrt(1 + a * a) * np.arctan(a / np.sqrt(1 + a * a))
    pixels = picture(tracer, model, camera, (16, 16), spp=128, sampling=sampling)[..., :3]
    assert pixels.mean() == pytest.approx(10.0 * form, rel=0.012)


@pytest.mark.parametrize("depth", [0.25, 2.0])
def test_absorption_by_distance(tracer, depth):
    """A slab of index 1 does not reflect or refract. Its transmittance is colour^(thickness / distance)."""
    tinted = replace(GLASS, ior=1.0, attenuation_color=(0.9, 0.5, 0.1), attenuation_distance=0.5)
    front = plate(0, half=3.0)
    back = np.diag([-1.0, 1.0, -1.0, 1.0])
    back[2, 3] = -depth
    model = scene(front, (plate(0, half=3.0), back), materials=[tinted], environment=constant())
    pixels = picture(tracer, model, orthographic(0.0, 0.0, height=1.0), (8, 8), spp=8, fresnel="exact")
    assert pixels[..., :3].mean(axis=(0, 1)) == pytest.approx(np.array([0.9, 0.5, 0.1]) ** (depth / 0.5), rel=1e-3)


def test_a_blended_pane_lets_through_what_it_does_not_cover(tracer):
    """A black surface of coverage 0.25 in front of light of radiance 1."""
    pane = Material(base_color=(0, 0, 0, 0.25), metallic=0.0, specular=0.0, perceptual_roughness=1.0,
                    alpha_mode="blend")
    model = scene((plate(half=3.0), moved((0, 0, 0))), materials=[pane], environment=constant())
    pixels = picture(tracer, model, orthographic(0.0, 0.0, height=1.0), (16, 16), spp=64)
    assert pixels[..., :3].mean() == pytest.approx(0.75, abs=0.005)
