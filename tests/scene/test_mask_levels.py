"""Mip levels of alpha masks: the share of a texel that stands, and only its colours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of

from viewer.scene.mask_levels import MaskMap, mask_map, standing_share
from viewer.scene.material import Material, Sampler, Texture


@pytest.mark.parametrize("cutoff", [0.25, 0.5, 0.75, 0.9])
def test_share_of_a_line_of_one_texel(cutoff):
    """Alpha falls from 1 in the middle of the line to 0 in the middle of the texels beside it."""
    alpha = np.zeros((5, 7), np.uint8)
    alpha[:, 3] = 255
    found = standing_share(alpha, cutoff) / 255
    assert np.array_equal(found, np.broadcast_to(found[2], (5, 7))) and found[0, 0] == 0
    assert found[2].sum() == pytest.approx(2 * (1 - cutoff), abs=0.26)


def test_only_texels_beside_the_cutoff_are_shared_out():
    alpha = np.full((8, 8), 40, np.uint8)
    alpha[:, 4:] = 250
    found = standing_share(alpha, 0.5)
    assert (found[:, :3] == 0).all() and (found[:, 5:] == 255).all()
    assert np.array_equal(standing_share(alpha, 0.5, interpolates=False), np.where(alpha > 127, 255, 0))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float16])
def test_levels_keep_the_share_and_its_colours(dtype):
    """A quarter stands, in white; all else is red, with an alpha below the cutoff, and not seen."""
    full = 1 if dtype == np.float16 else np.iinfo(dtype).max
    pixels = np.zeros((16, 16, 4), dtype)
    pixels[..., 0], pixels[..., 3] = full, full * 0.4
    pixels[:8, :8] = full
    levels = MaskMap(0.5, interpolates=False).levels(pixels, srgb=False)
    assert np.array_equal(levels[0], pixels)
    assert np.allclose(levels[-1] / full, [[[1, 1, 1, 0.25]]], atol=0.01)
    assert (levels[1][:4, :4] == full).all() and (levels[1][4:, :, 3] == 0).all()


def test_which_materials_have_such_levels():
    texture = Texture(image_of(np.full((4, 4, 4), 9, np.uint8)))
    mask = Material(alpha_mode="mask", alpha_cutoff=0.3, base_color=(1, 1, 1, 0.5), base_color_texture=texture)
    assert mask_map("base_color", mask) == MaskMap(0.6, True)
    assert mask_map("emissive", mask) is None
    unmipped = replace(texture, sampler=Sampler(mip_filter=None))
    for other in (replace(mask, alpha_mode="blend"), replace(mask, alpha_cutoff=0.0), replace(mask, alpha_cutoff=0.6),
                  replace(mask, base_color_texture=None), replace(mask, base_color_texture=unmipped)):
        assert mask_map("base_color", other) is None
