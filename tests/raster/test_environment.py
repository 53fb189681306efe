"""The environment behind the scene and in its surfaces: which way round it is, and how it turns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, lopsided, orthographic, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions, texel_solid_angles
from viewer.scene.material import Material
from viewer.scene.scene import Scene

SIZE = (32, 32)
MIRROR = Material(perceptual_roughness=0.0)
COAT = Material(base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0, clearcoat=1.0, clearcoat_roughness=0.0)


def lookup(environment: Environment, d: np.ndarray) -> np.ndarray:
    """Radiance from directions (..., 3), bilinear; turned by -rotation about +Y before it is looked up."""
    c, s = np.cos(environment.rotation), np.sin(environment.rotation)
    x, z = c * d[..., 0] - s * d[..., 2], s * d[..., 0] + c * d[..., 2]
    radiance = environment.radiance
    height, width = radiance.shape[:2]
    column = (0.5 + np.arctan2(z, x) / (2 * np.pi)) * width - 0.5
    row = np.clip(np.arccos(np.clip(d[..., 1], -1, 1)) / np.pi * height - 0.5, 0, height - 1)
    j, i = np.floor(column).astype(int), np.minimum(np.floor(row).astype(int), height - 2)
    u, v = (column - j)[..., None], (row - i)[..., None]
    left, right = j % width, (j + 1) % width
    return ((1 - v) * ((1 - u) * radiance[i, left] + u * radiance[i, right])
            + v * ((1 - u) * radiance[i + 1, left] + u * radiance[i + 1, right])) * environment.intensity


def rays(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """Unit directions through the pixels' centres."""
    width, height = size
    x = (2 * (np.arange(width) + 0.5) / width - 1) * np.tan(camera.fov_y / 2) * width / height
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * np.tan(camera.fov_y / 2)
    d = camera.forward + x[None, :, None] * camera.pose[:3, 0] + y[:, None, None] * camera.pose[:3, 1]
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


@pytest.mark.parametrize("rotation", [0.0, 2.0])
@pytest.mark.parametrize("azimuth", [0.0, 1.5, 3.0, 4.6])
def test_background_is_the_map_seen_from_inside(radiance, azimuth, rotation):
    environment = replace(lopsided(128), rotation=rotation, intensity=1.5)
    for elevation in (0.0, 0.9):
        camera = Camera.orbit((0, 0, 0), 3.0, azimuth, elevation, fov_y=1.2)
        picture = radiance(Scene("empty", environment=environment), camera, SIZE)[..., :3]
        assert np.abs(picture / lookup(environment, rays(camera, SIZE)) - 1).max() < 0.02


@pytest.mark.parametrize("rotation", [0.0, 1.0])
def test_a_mirror_shows_what_lies_where_it_reflects(radiance, rotation):
    environment = replace(lopsided(512), rotation=rotation)
    camera = orthographic(0.8, 0.3, height=2.2)
    picture = radiance(scene(sphere(segments=192), materials=[MIRROR], environment=environment), camera, SIZE,
                       background="none", specular_aa="off")
    y, x = (0.5 - (np.mgrid[0:32, 0:32] + 0.5) / 32) * 2.2 * np.array([1, -1])[:, None, None]
    inside = x**2 + y**2 < 0.9
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    n = np.stack([x, y, z], axis=-1) @ camera.pose[:3, :3].T
    r = camera.forward - 2 * (n @ camera.forward)[..., None] * n
    assert np.abs(picture[..., :3] / lookup(environment, r) - 1)[inside].max() < 0.05


@pytest.mark.parametrize("material", [MIRROR, COAT], ids=["metal", "coat"])
def test_a_lamp_in_a_mirror_has_no_haze(radiance, material):
    """A lamp 1e5 times as bright as the room leaves the room as it is beside it."""
    lamp = np.array([0.3, 0.2, 1.0]) / np.linalg.norm([0.3, 0.2, 1.0])
    is_lamp = texel_directions(256, 512) @ lamp > np.cos(np.radians(8))
    room = Environment("room", np.where(is_lamp[..., None], 1e3, np.full(3, 0.01)).astype(np.float32))
    camera = Camera.look_at((0, 0, 2), (0, 0, 0), fov_y=0.9)
    picture = radiance(scene(plate(), materials=[material], environment=room), camera, SIZE, background="none")
    cosine = rays(camera, SIZE) * [1, 1, -1] @ lamp  # the plate mirrors z
    beside = (picture[..., 3] == 1) & (cosine < np.cos(np.radians(10)))
    assert picture[cosine > np.cos(np.radians(6)), :3].min() > 10
    assert beside.sum() > 500 and picture[beside, :3].max() < 0.0102


def test_a_white_plate_sees_its_hemisphere(radiance):
    """Its radiance is the irradiance over pi, by summing over the map's texels."""
    environment = lopsided(128)
    d = texel_directions(128, 256)
    weights = texel_solid_angles(128, 256)[:, None]
    for azimuth in (0.0, 1.0, 2.5, 4.0):
        camera = orthographic(azimuth)
        normal = -camera.forward
        pose = np.eye(4)
        pose[:3, :3] = camera.pose[:3, :3]
        expected = ((np.maximum(d @ normal, 0) * weights)[..., None] * environment.radiance).sum(axis=(0, 1)) / np.pi
        picture = radiance(scene((plate(), pose), environment=environment), camera, (4, 4))[..., :3]
        assert np.abs(picture / expected - 1).max() < 0.01


def test_turning_the_environment_is_turning_everything_else_back(radiance):
    materials = [Material(perceptual_roughness=0.3, base_color=(1, 0.8, 0.6, 1))]
    quarter = np.pi / 2
    for mode in ("pbr", "phong"):
        turned = scene(sphere(), materials=materials, environment=replace(lopsided(), rotation=quarter))
        straight = scene(sphere(), materials=materials, environment=lopsided())
        a = radiance(turned, orthographic(0.7, 0.2), SIZE, mode=mode)
        b = radiance(straight, orthographic(0.7 - quarter, 0.2), SIZE, mode=mode)
        other = radiance(straight, orthographic(0.7 + quarter, 0.2), SIZE, mode=mode)
        assert np.abs(a - b).max() < 0.02 * b.max()
        assert np.abs(a - other).max() > 0.2 * b.max()


def test_turning_by_a_quarter_is_rolling_the_map_to_smaller_u(radiance):
    straight = lopsided()
    rolled = Environment("rolled", np.roll(straight.radiance, -straight.radiance.shape[1] // 4, axis=1))
    for material in (WHITE, MIRROR):
        a, b = (radiance(scene(sphere(), materials=[material], environment=environment), orthographic(0.7, 0.2), SIZE)
                for environment in (replace(straight, rotation=np.pi / 2), rolled))
        assert np.abs(a - b).max() < 0.01 * b.max()


def test_intensity_scales_and_black_is_black(radiance):
    model = scene(sphere(), materials=[Material(metallic=0.5)], environment=lopsided())
    one = radiance(model, orthographic(), SIZE)
    four = radiance(replace(model, environment=replace(lopsided(), intensity=4.0)), orthographic(), SIZE)
    assert np.abs(four[..., :3] - 4 * one[..., :3]).max() < 1e-5 * four.max()
    assert radiance(replace(model, environment=constant(0.0)), orthographic(), SIZE)[..., :3].max() == 0
