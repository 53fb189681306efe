"""Curves that are thick beside their segments: the union of cones with spheres at their ends, as the path tracer has
it, worked out here by the spheres along each segment."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shapes import plate, scene

from viewer.raster.curve_buffers import blunt_radius
from viewer.scene.camera import Camera
from viewer.scene.curve_segments import segments
from viewer.scene.curves import Curves
from viewer.scene.environment_presets import make_preset
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene

FURNACE = make_preset("furnace")
SIZE = (64, 64)
HEIGHT = 4.0
BENT = [(-1.2, -0.8, 0, 0.3), (-0.2, 0.9, 0.2, 0.2), (0.0, -0.7, 0.0, 0.3), (0.3, -0.6, 0.3, 0.35),
        (0.4, -0.6, 0.2, 0.1), (1.2, 0.8, -0.3, 0.25)]
"""A zigzag with a hairpin, a segment shorter than its radius and a quick taper: x, y, z, radius."""
GROWING = [(-1, 0, 0, 0.1), (-0.6, 0, 0, 0.5), (0.6, 0.1, 0, 0.8), (0.7, 0.1, 0, 0.9), (0.7, 0.1, 0, 0.9)]


def curves(points) -> Curves:
    points = np.array(points, np.float32)
    return Curves("thick", points[:, :3], points[:, 3], [0, len(points)], [False])


def view(tilt: float) -> Camera:
    """From the front, orthographic, turned about y."""
    eye = 10 * np.array([math.sin(tilt), 0, math.cos(tilt)])
    return replace(Camera.look_at(eye, (0, 0, 0)), height=HEIGHT)


def front(points, tilt: float) -> np.ndarray:
    """The depth towards the eye of the nearest sphere about each pixel's centre; -inf where there is none."""
    c, s = math.cos(tilt), math.sin(tilt)
    columns = (np.arange(64) + 0.5) / 64 * HEIGHT - HEIGHT / 2
    x, y = np.meshgrid(columns, -columns)
    nearest = np.full((64, 64), -np.inf)
    for a, b in zip(np.array(points)[:-1], np.array(points)[1:], strict=True):
        for t in np.linspace(0, 1, 200):
            px, py, pz, r = a + t * (b - a)
            inside = r**2 - (x - (c * px - s * pz))**2 - (y - py)**2
            deep = s * px + c * pz + np.sqrt(np.maximum(inside, 0))
            nearest = np.maximum(nearest, np.where(inside > 0, deep, -np.inf))
    return nearest


@pytest.mark.parametrize("points", [BENT, GROWING])
@pytest.mark.parametrize("tilt", [0.0, 1.1])
def test_they_cover_what_their_spheres_cover(radiance, points, tilt):
    model = Scene("thick", curves=(curves(points),), environment=FURNACE)
    for mode in ("pbr", "phong"):
        pixels = radiance(model, view(tilt), SIZE, mode=mode, background="none", antialias="none")
        wrong = (pixels[..., 3] > 0.5) != np.isfinite(front(points, tilt))
        assert wrong.sum() <= 3  # of pixels that an edge passes through
        assert np.isfinite(pixels).all()


@pytest.mark.parametrize("points", [BENT, GROWING])
def test_they_lie_as_deep_as_their_spheres(radiance, points):
    wall = replace(scene(plate(half=3.0), materials=(Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0),)),
                   environment=FURNACE)
    for z in (0.15, 0.3):
        shifted = [(x, y, depth - z, r) for x, y, depth, r in points]
        pixels = radiance(replace(wall, curves=(curves(shifted),)), view(0.0), SIZE, antialias="none",
                          mode="phong", hair_color=(1, 1, 1))
        wrong = (pixels[..., 0] > 0.5) != (front(points, 0.0) > z)
        assert wrong.sum() <= 5


def test_a_camera_among_them_sees_them(radiance):
    """Near the eye a sphere covers more of the screen than its radius over its distance says."""
    a, b = np.array([(0, 0, 0, 1), (0.1, 0.3, -0.2, 0.9)])
    ball = Scene("ball", curves=(curves([a, b]),), environment=FURNACE)
    eye = Camera.look_at((0, 0, 1.5), (0, 0, 0), fov_y=math.radians(120))
    covered = radiance(ball, eye, SIZE, background="none", antialias="none")[..., 3] > 0.5
    x, y = np.meshgrid((np.arange(64) + 0.5) / 32 - 1, 1 - (np.arange(64) + 0.5) / 32)
    d = np.stack([x, y, np.full_like(x, -1 / math.tan(math.radians(60)))], axis=-1)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    expected = np.zeros_like(covered)
    for t in np.linspace(0, 1, 50):
        x, y, z, radius = a + t * (b - a)
        expected |= np.linalg.norm(np.cross(d, (x, y, z - 1.5)), axis=-1) < radius
    assert (covered != expected).sum() <= 4 and expected.sum() > 800
    inside = Camera.look_at((0, 0, 0.4), (0, 0, 0))
    assert np.isfinite(radiance(ball, inside, SIZE, background="none")).all()


def test_they_cast_the_shadow_of_their_spheres(radiance):
    sun = Light("directional", intensity=math.pi, direction=(0, 0, -1))
    wall = replace(scene(plate(half=3.0), materials=(Material(metallic=0.0, specular=0.0),)), lights=(sun,))
    lifted = [(x, y, z + 2.5, r) for x, y, z, r in BENT]
    below = replace(Camera.look_at((0, 0, 1.5), (0, 0, 0)), height=HEIGHT)  # the curves are behind it
    dark = radiance(replace(wall, curves=(curves(lifted),)), below, SIZE, antialias="none")[..., 0] < 0.5
    assert (dark != np.isfinite(front(BENT, 0.0))).sum() < 40 and dark.sum() > 500


def test_strips_show_what_is_not_blunt(radiance):
    t = np.linspace(0, 3, 20)
    smooth = np.stack([t, np.sin(t), 0 * t, np.full(20, 0.05)], axis=1)
    assert blunt_radius(segments(curves(smooth))) == 0
    assert blunt_radius(segments(curves(BENT))) == pytest.approx(0.35)
    assert blunt_radius(segments(curves([(0, 0, 0, 0.1), (1, 0, 0, 0.1), (0.5, 0.1, 0, 0.1)]))) == pytest.approx(0.1)
    assert blunt_radius(segments(curves([(0, 0, 0, 0.1), (1, 0, 0, 0.1), (2, 0.1, 0, 0.1)]))) == 0
