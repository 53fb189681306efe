"""Alpha masks: alpha >= cutoff is opaque (glTF 2.0, 3.9.4), and only an edge between the two is smoothed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of
from shapes import orthographic, plate, scene

from viewer.scene.mask_levels import standing_share
from viewer.scene.material import Material, Sampler, Texture

MASK = Material(unlit=True, alpha_mode="mask")


@pytest.mark.parametrize("antialias", ["none", "msaa-4", "ssaa-4"])
@pytest.mark.parametrize("alpha, cutoff, expected", [
    (0.5, 0.5, 1), (1.0, 1.0, 1), (0.0, 0.0, 1), (0.25, 0.25, 1), (0.4999, 0.5, 0), (1.0, 1.0001, 0)])
def test_alpha_at_the_cutoff_is_opaque(radiance, antialias, alpha, cutoff, expected):
    material = replace(MASK, base_color=(1, 1, 1, alpha), alpha_cutoff=cutoff)
    picture = radiance(scene(plate(0), materials=[material]), orthographic(height=1.0), (8, 8), antialias=antialias,
                       background="none")
    assert (picture == expected).all()


def half_clear() -> Texture:
    """Alpha 0 in the left half, 1 in the right one."""
    texels = np.full((64, 64, 4), 255, np.uint8)
    texels[:, :32, 3] = 0
    return Texture(image_of(texels))


@pytest.mark.parametrize("antialias", ["none", "msaa-4"])
@pytest.mark.parametrize("cutoff, left", [(0.0, 1), (0.5, 0)])
def test_a_cutoff_of_0_leaves_nothing_out(radiance, antialias, cutoff, left):
    material = replace(MASK, base_color_texture=half_clear(), alpha_cutoff=cutoff)
    picture = radiance(scene(plate(0), materials=[material]), orthographic(height=1.0), (17, 17), antialias=antialias,
                       background="none")
    assert (picture[:, :8, 3] == left).all() and (picture[:, 9:, 3] == 1).all()
    assert left == 0 or (picture[..., 3] == 1).all()


def test_an_edge_is_smooth_with_several_samples_a_pixel(radiance):
    """A ramp of alpha crosses the cutoff within one: a part of its samples is kept."""
    texels = np.full((1, 256, 4), 255, np.uint8)
    texels[..., 3] = np.arange(256)
    material = replace(MASK, base_color_texture=Texture(image_of(texels)), alpha_cutoff=0.51)
    picture = radiance(scene(plate(0), materials=[material]), orthographic(height=1.0), (16, 16),
                       antialias="msaa-8", background="none")[..., 3]
    assert (picture[:, :7] == 0).all() and (picture[:, 10:] == 1).all()
    assert ((picture > 0.1) & (picture < 0.9)).any()


def fence() -> np.ndarray:
    """Wires of two texels, sixteen apart, cover a quarter; their mean alpha is below most cutoffs."""
    diagonal = np.add.outer(np.arange(256), np.arange(256)), np.subtract.outer(np.arange(256), np.arange(256))
    texels = np.full((256, 256, 4), 255, np.uint8)
    texels[..., 3] = 255 * ((diagonal[0] % 16 < 2) | (diagonal[1] % 16 < 2))
    return texels


@pytest.mark.parametrize("antialias, off, rms", [("none", 0.12, 0.5), ("msaa-4", 0.06, 0.15), ("ssaa-4", 0.1, 0.25)])
@pytest.mark.parametrize("cutoff, factor", [(0.5, 1.0), (0.375, 0.5)])
def test_a_fence_seen_small_covers_what_its_wires_do(radiance, antialias, off, rms, cutoff, factor):
    """Of 4 and 16 texels a pixel, with the alpha of a factor, too."""
    texels = fence()
    share = standing_share(texels[..., 3], cutoff / factor) / 255
    material = replace(MASK, base_color=(1, 1, 1, factor), alpha_cutoff=cutoff,
                       base_color_texture=Texture(image_of(texels)))
    for side in (64, 16):
        picture = radiance(scene(plate(0), materials=[material]), orthographic(height=2.0), (side, side),
                           antialias=antialias, background="none")
        wanted = share.reshape(side, 256 // side, side, 256 // side).mean(axis=(1, 3))
        assert picture[..., 3].mean() == pytest.approx(share.mean(), rel=off)
        assert np.sqrt(np.mean((picture[..., 3] - wanted)**2)) < rms
        assert picture[..., :3][picture[..., 3] > 0].min() > 0


def test_a_mask_without_levels_is_cut_where_it_is_looked_up(radiance):
    texture = Texture(image_of(fence()), sampler=Sampler(mag_filter="nearest", min_filter="nearest", mip_filter=None))
    picture = radiance(scene(plate(0), materials=[replace(MASK, base_color_texture=texture)]),
                       orthographic(height=2.0), (64, 64), background="none")[..., 3]
    assert np.array_equal(picture, fence()[2::4, 2::4, 3] / 255)
