"""Mip levels of a cloth's maps: they reflect what their texels do."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from shapes import plate, scene
from sheen_twins import charlie_albedos

from viewer.plan.planner import plan_scene
from viewer.raster.sampled_images import channels_read
from viewer.scene.color import srgb_to_linear
from viewer.scene.decoding import decode_levels
from viewer.scene.material import Material, Sampler, Texture, UVTransform
from viewer.scene.mip_levels import mip_levels
from viewer.scene.sheen_levels import sheen_map
from viewer.scene.texture_image import open_texture_image
from viewer.settings import Settings

FIBRES = [[[128, 10, 208, 240], [16, 32, 80, 40]], [[16, 32, 96, 51], [0, 0, 16, 0]]]
BASE = [[[10, 120, 200], [10, 20, 40]], [[12, 24, 40], [30, 12, 10]]]
"""Two by two texels of a woven pattern: thick and thin yarns, and a gap."""


def image(pixels):
    file = io.BytesIO()
    Image.fromarray(np.array(pixels, np.uint8)).save(file, "PNG")
    return open_texture_image(file.getvalue(), "image")


def cloth(fibres, base, **others) -> Material:
    sheen = Texture(image(fibres))
    maps = {"sheen_color_texture": sheen, "sheen_roughness_texture": sheen, "base_color_texture": Texture(image(base))}
    return Material(**{"sheen_color": (1.0, 1.0, 1.0), "sheen_roughness": 1.0, "metallic": 0.0} | maps | others)


@pytest.fixture(scope="module")
def woven() -> Material:
    return cloth(np.tile(FIBRES, (8, 8, 1)), np.tile(BASE, (8, 8, 1)))


def levels_of(material, name, channels):
    meaning = sheen_map(name, material)
    assert meaning is not None
    return decode_levels(getattr(material, f"{name}_texture").image, channels, meaning)


def albedo(roughness, cosine):
    """Of charlie.glsl: below CHARLIE_SMOOTHEST the lobe is that of it, with a weight."""
    found = np.interp(cosine, *charlie_albedos(round(max(float(roughness), 0.2), 6)))
    return min(found, 1.0) * min(roughness / 0.2, 1.0)


def reflected(fibres, base, cosine):
    """What the sheen of texels (N, 4) and the base (N, 3) below it reflect, their means over the texels, (2, 3)."""
    sheen = np.array([srgb_to_linear(f[:3] / 255) * albedo(f[3] / 255, cosine) for f in fibres.astype(np.float64)])
    below = srgb_to_linear(base / 255.0) * (1 - sheen.max(axis=1, keepdims=True))
    return np.array([sheen.mean(axis=0), below.mean(axis=0)])


@pytest.mark.parametrize("level", [1, 4])
def test_levels_reflect_what_their_texels_do(woven, level):
    """Red and blue of the sheen within 7 %. The base has one weight for all views, and is wrong by at most half as much
    as with plain means, which reflect 5 to 61 % of the sheen's red."""
    fibres = np.concatenate([levels_of(woven, "sheen_color", "RGB")[level][0, 0],
                             levels_of(woven, "sheen_roughness", "RGBA")[level][0, 0, 3:]])
    base = levels_of(woven, "base_color", "RGB")[level][0, 0]
    light, data = mip_levels(np.array(FIBRES, np.uint8), srgb=True), mip_levels(np.array(FIBRES, np.uint8))
    plain = np.concatenate([light[1][0, 0, :3], data[1][0, 0, 3:]])
    plain_base = mip_levels(np.array(BASE, np.uint8), srgb=True)[1][0, 0]
    for cosine, bound in zip((0.9, 0.5, 0.2), (0.06, 0.06, 0.21), strict=True):
        texels = reflected(np.reshape(FIBRES, (-1, 4)), np.reshape(BASE, (-1, 3)), cosine)
        sheen, under = reflected(fibres[None], base[None], cosine) / texels - 1
        plain_sheen, plain_under = reflected(plain[None], plain_base[None], cosine) / texels - 1
        assert np.abs(sheen[[0, 2]]).max() < 0.07 and plain_sheen[0] < -0.38, cosine
        assert np.abs(under).max() < min(bound, 0.5 * np.abs(plain_under).max()), cosine


@pytest.mark.parametrize("size", [(64, 64), (33, 47), (1, 5)])
def test_maps_of_one_colour_keep_it(size):
    material = cloth(np.full((*size, 4), [40, 90, 160, 130]), np.full((*size, 3), [200, 100, 50]), sheen_roughness=0.7)
    for name, channels in (("base_color", "RGB"), ("sheen_color", "RGB"), ("sheen_roughness", "RGBA")):
        levels = levels_of(material, name, channels)
        assert levels[-1].shape[:2] == (1, 1)
        assert all(np.abs(level.astype(int) - levels[0][0, 0]).max() <= 1 for level in levels), name


def test_where_there_is_no_sheen_roughness_is_averaged_as_it_is():
    fibres = np.zeros((8, 8, 4), np.uint8)
    fibres[:, ::2, 3] = 200
    assert all((level[..., 3] == 100).all()
               for level in levels_of(cloth(fibres, np.full((8, 8, 3), 90)), "sheen_roughness", "RGBA")[1:])


def test_all_three_maps_are_decoded_so(woven):
    plan = plan_scene(scene(plate(), materials=[woven]), Settings(), (), samples=1, half_target=False,
                      orthographic=False)
    names = "base_color", "sheen_color", "sheen_roughness"
    assert {meaning for _, meaning in channels_read(plan, {})} == {sheen_map(name, woven) for name in names}


@pytest.mark.parametrize("change, left", [
    ({"sheen_color_texture": None}, set()),
    ({"sheen_color": (0.0, 0.0, 0.0)}, set()),
    ({"sheen_roughness": 0.0}, set()),
    ({"sheen_roughness_texture": None}, {"base_color"}),
    ({"alpha_mode": "mask"}, {"sheen_color", "sheen_roughness"}),
    ({"base_color_texture": Texture(image(np.zeros((8, 8, 3))))}, {"sheen_color", "sheen_roughness"}),
    ({"base_color_texture": Texture(image(np.zeros((16, 16, 3))), transform=UVTransform(scale=(2.0, 2.0)))},
     {"sheen_color", "sheen_roughness"}),
    ({"base_color_texture": Texture(image(np.zeros((16, 16, 3))), Sampler(wrap_s="clamp"))},
     {"sheen_color", "sheen_roughness"}),
    ({"sheen_roughness_texture": Texture(image(np.zeros((16, 16, 3))))}, {"base_color"}),
])
def test_maps_that_lie_alike_are_averaged_together(woven, change, left):
    material = replace(woven, **change)
    assert {name for name in ("base_color", "sheen_color", "sheen_roughness", "normal")
            if sheen_map(name, material) is not None} == left


def test_a_factor_that_moves_makes_few_textures(woven):
    moved = {sheen_map("sheen_color", replace(woven, sheen_roughness=factor)) for factor in np.linspace(0.01, 1, 100)}
    assert len(moved) == 8
