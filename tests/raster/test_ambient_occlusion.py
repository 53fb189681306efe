"""What the picture itself shows to be hidden: against form factors worked out on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, seen_plane, sphere

SIZE = (64, 64)
BLACK = replace(WHITE, base_color=(0, 0, 0, 1), double_sided=True)


def corner(scale: float = 1.0):
    """A white floor before a black wall of height 1 along X, by its middle as good as endless."""
    return scene((plate(0, half=2.0), moved((0, 0, 0), scale) @ facing_floor()),
                 (plate(1), moved((0, 0.5 * scale, 0), scale) @ moved((0, 0, 0), (2.0, 0.5, 1.0))),
                 materials=[WHITE, BLACK], environment=constant())


def view(scale: float = 1.0):
    return orthographic(0.0, 0.7, height=3.0 * scale, distance=5.0 * scale)


def test_a_wall_hides_what_its_form_factor_says(radiance):
    x, _, z = np.moveaxis(seen_plane(view(), SIZE, (0, 1, 0)), -1, 0)
    expected = (1 + np.cos(np.arctan2(1.0, z))) / 2
    found = radiance(corner(), view(), SIZE, ambient_occlusion="gtao")[..., 0]
    at = (z > 0.05) & (z < 0.6) & (np.abs(x) < 0.5)
    assert np.abs(found - expected)[at].max() < 0.06
    far = radiance(corner(), view(), SIZE, ambient_occlusion="gtao")[-2:, :, 0]
    assert np.abs(far - 1).max() < 0.02  # as far as the radius nothing counts


def test_a_ball_alone_is_as_without(radiance):
    ball = scene(sphere(segments=128), environment=constant())
    picture = radiance(ball, orthographic(0.3, 0.2, height=1.4), SIZE, ambient_occlusion="gtao")[..., 0]
    assert np.abs(picture - 1).max() < 0.02


@pytest.mark.parametrize("azimuth", [0.0, 0.4])
def test_a_plane_that_is_seen_at_a_slant_hides_nothing_of_itself(radiance, azimuth):
    floor = scene((plate(0, half=2.0), facing_floor()), environment=constant())
    picture = radiance(floor, orthographic(azimuth, 0.3, height=1.0), SIZE, ambient_occlusion="gtao")[..., 0]
    assert np.abs(picture - 1).max() < 1e-3


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_scale_does_not_matter(radiance, scale):
    unit = radiance(corner(), view(), SIZE, ambient_occlusion="gtao")
    assert np.abs(radiance(corner(scale), view(scale), SIZE, ambient_occlusion="gtao") - unit).max() < 2e-3


def test_shadows_of_the_environment_take_its_place(radiance):
    pictures = [radiance(corner(), view(), SIZE, environment_shadows="16", ambient_occlusion=kind)
                for kind in ("off", "gtao")]
    assert np.array_equal(*pictures)


def test_wide_pixels_hide_as_much_as_the_square_ones_that_they_cover(radiance):
    camera = orthographic(0.9, 0.7, height=3.0, distance=5.0)
    square = radiance(corner(), camera, SIZE, ambient_occlusion="gtao")[..., 0]
    wide = radiance(corner(), replace(camera, pixel_aspect=4.0), (16, 64), ambient_occlusion="gtao")[..., 0]
    covered = square.reshape(64, 16, 4)
    same = np.ptp(covered, axis=2) < 0.1  # no edge
    assert same.mean() > 0.7 and np.abs(wide - covered.mean(axis=2))[same].mean() < 0.01
