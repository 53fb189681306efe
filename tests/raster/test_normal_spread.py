"""What the mip levels of normal maps lose of the normals, and get back as roughness."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of, noise
from shapes import lopsided, orthographic, plate, scene

from viewer.gpu.call import call_glsl
from viewer.scene.decoding import decode_levels
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.mip_levels import mip_levels
from viewer.scene.normal_spread import with_spread

RNG = np.random.default_rng(7)


def normal_map(slopes: np.ndarray, dtype: type = np.uint8) -> np.ndarray:
    """(H, W, 3) texels of the normals of (H, W, 2) slopes."""
    normals = np.concatenate([slopes, np.ones_like(slopes[..., :1])], axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    return np.rint((normals + 1) / 2 * np.iinfo(dtype).max).astype(dtype)


BUMPS = normal_map(RNG.normal(0, 0.2, (256, 256, 2)))


def right_spread(pixels: np.ndarray, side: int) -> np.ndarray:
    """In float64, over blocks of side x side texels."""
    xy = pixels[..., :2] / np.iinfo(pixels.dtype).max * 2 - 1
    blocks = xy.reshape(xy.shape[0] // side, side, xy.shape[1] // side, side, 2).swapaxes(1, 2).reshape(
        xy.shape[0] // side, xy.shape[1] // side, -1, 2)
    rest = blocks - blocks.mean(axis=2, keepdims=True)
    covariance = np.einsum("ijkc,ijkd->ijcd", rest, rest) / side**2
    return np.sqrt(2 * np.sqrt(np.maximum(np.linalg.det(covariance), 0)))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_the_spread_is_that_of_all_texels_that_a_level_stands_for(dtype):
    pixels = noise(64, 32, 3, dtype=dtype)
    levels = mip_levels(pixels)
    for k, (plain, level) in enumerate(zip(levels, with_spread(levels), strict=True)):
        assert level.dtype == dtype and np.array_equal(level[..., :3], plain)
        spread = 1 - level[..., 3] / np.iinfo(dtype).max
        if k == 0:
            assert not spread.any()
        elif k <= 5:
            assert np.abs(spread - np.minimum(right_spread(pixels, 2**k), 1)).max() < 0.004


@pytest.mark.parametrize("size", [(33, 47), (1, 5), (130, 1), (1, 1), (75, 128)])
def test_levels_of_odd_sizes_have_about_the_spread_of_the_whole(size):
    pixels = noise(size[1], size[0], 3)
    last = with_spread(mip_levels(pixels))[-1]
    flat = pixels[..., :2].reshape(-1, 2) / 127.5 - 1
    expected = np.sqrt(2 * np.sqrt(max(np.linalg.det(np.cov(flat.T, ddof=0)), 0))) if len(flat) > 1 else 0.0
    assert abs(1 - last[0, 0, 3] / 255 - min(expected, 1)) < 0.03


def test_what_is_flat_or_grooved_in_one_direction_does_not_spread():
    flat = np.full((64, 64, 3), (128, 140, 250), np.uint8)
    assert all((level[..., 3] == 255).all() for level in with_spread(mip_levels(flat)))
    assert right_spread(BUMPS, 256).min() > 0.25


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("azimuth", [0.0, 0.5, np.pi / 2])
@pytest.mark.parametrize("size", [(256, 256), (256, 1)])
def test_grooves_do_not_spread_by_the_rounding_of_their_texels(dtype, azimuth, size):
    """A slope along them that lies between two codes, and is rounded to either, has the variance of rounding. Its
    product with that of the grooves was an alpha of 0.043 to 0.055."""
    across = RNG.normal(0, 0.2, (size[0], 1))
    along = RNG.choice([-0.499, 0.499], size) / np.iinfo(dtype).max
    slopes = np.stack([across * np.cos(azimuth) - along * np.sin(azimuth),
                       across * np.sin(azimuth) + along * np.cos(azimuth)], axis=2)
    levels = with_spread(mip_levels(normal_map(slopes, dtype)))
    spread = max(1 - level[..., 3].min() / np.iinfo(dtype).max for level in levels)
    assert spread == 0 if azimuth != 0.5 else spread < 0.04


def test_every_image_of_normals_gets_the_channel():
    """Alpha of the file, which glTF does not read, is not taken for it, and grey is not taken for spread."""
    for count in (1, 2, 3, 4):
        levels = decode_levels(image_of(noise(8, 8, count)), "RGB", "normal")
        assert all(level.shape[2] == 4 for level in levels) and (levels[0][..., 3] == 255).all()


def test_the_lobe_is_widened_by_the_variance_about_the_mean_normal():
    """alpha^2 + 2 sqrt(det C) with the covariance C of slopes about the mean, from normals and not from the formula."""
    for tilt, scale in ((0.0, 1.0), (0.6, 1.0), (1.0, 1.0), (0.5, 2.0), (-0.7, 0.4)):
        texels = np.array([np.sin(tilt), 0.0, np.cos(tilt)]) + RNG.normal(0, 0.02, (4000, 3)) * [1, 3, 1]
        texels /= np.linalg.norm(texels, axis=1, keepdims=True)
        spread = np.sqrt(2 * np.sqrt(np.linalg.det(np.cov(texels[:, :2].T))))
        normals = texels * [scale, scale, 1]
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        mean = normals.mean(axis=0) / np.linalg.norm(normals.mean(axis=0))
        across = np.array([mean[2], 0.0, -mean[0]])
        slopes = np.stack([normals @ across, normals[:, 1]]) / (normals @ mean)
        expected = np.sqrt(0.1**2 + 2 * np.sqrt(np.linalg.det(np.cov(slopes))))
        texel = np.append((texels.mean(axis=0) + 1) / 2, 1 - spread)
        found = call_glsl("bsdf/normal_spread.glsl", "widened_alpha", alpha=0.1, texel=texel, scale=scale)
        assert found == pytest.approx(expected, rel=0.03), (tilt, scale)


def test_any_texel_gives_an_alpha_that_is_no_smaller_and_at_most_1():
    texels = np.concatenate([RNG.random((500, 4)), np.indices((2, 2, 2, 2)).reshape(4, -1).T])
    for alpha in (0.0, 0.3, 1.0):
        for scale in (0.0, 1.0, 1e6):
            found = call_glsl("bsdf/normal_spread.glsl", "widened_alpha", alpha=alpha, texel=texels, scale=scale)
            assert np.isfinite(found).all() and found.min() >= alpha * (1 - 1e-6) and found.max() <= 1


@pytest.mark.parametrize("layer", ["base", "coat"])
def test_far_away_a_bumpy_mirror_reflects_the_mean_of_what_its_texels_reflect(radiance, layer):
    """The mean over the texels in float64. Without the spread the picture is three times as bright: the lamp itself."""
    to_eye = np.array([-0.5, -0.4, 0.77]) / np.linalg.norm([0.5, 0.4, 0.77])
    camera = orthographic(np.arctan2(to_eye[0], to_eye[2]), np.arcsin(to_eye[1]), height=1.0)
    material = {"base": Material(perceptual_roughness=0.05, normal_texture=Texture(image_of(BUMPS))),
                "coat": Material(base_color=(0, 0, 0, 1), specular=0.0, metallic=0.0, clearcoat=1.0,
                                 clearcoat_normal_texture=Texture(image_of(BUMPS)))}[layer]
    found = radiance(scene(plate(), materials=[material], environment=lopsided()), camera, (8, 8))[2:-2, 2:-2, :3]
    n = BUMPS[..., :3].reshape(-1, 3) / 127.5 - 1
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    cosine = n @ to_eye
    d = 2 * cosine[:, None] * n - to_eye
    spot = np.exp(40 * (d @ (np.array([0.5, 0.4, 0.77]) / np.linalg.norm([0.5, 0.4, 0.77])) - 1))
    fresnel = 1.0 if layer == "base" else (0.04 + 0.96 * (1 - np.clip(cosine, 0, 1)) ** 5)[:, None]
    expected = (fresnel * (0.6 + 0.5 * d + 4 * spot[:, None])).mean(axis=0)
    # A coat loses the light that its facets reflect twice.
    assert np.abs(found.mean(axis=(0, 1)) / expected - 1).max() < (0.12 if layer == "base" else 0.2)


@pytest.mark.parametrize("layer", ["base", "coat"])
@pytest.mark.parametrize("slope, angular_radius", [(0.0, 0.0), (0.15, 0.0), (0.7, 0.0), (0.7, 0.004)])
def test_far_away_bumps_reflect_a_lamp_as_their_texels_do_together(radiance, layer, slope, angular_radius):
    """The mean over the texels in float64, where h is so steep. GGX of the wider alpha gives 29 times that at 0.7."""
    alpha, bumps = 0.0225, Texture(image_of(BUMPS))
    material = {"base": Material(metallic=1.0, perceptual_roughness=0.15, normal_texture=bumps,
                             normal_scale=0.5),
                "coat": Material(base_color=(0, 0, 0, 1), specular=0.0, metallic=0.0, clearcoat=1.0,
                                 clearcoat_roughness=0.15, clearcoat_normal_texture=bumps,
                             clearcoat_normal_scale=0.5)}[layer]
    azimuths = np.arctan(slope) + np.array([-0.3, 0.3])
    lamp = replace(Light.from_angles(azimuths[1], 0.0, 1.0), angular_radius=angular_radius)
    found = radiance(scene(plate(), materials=[material], lights=(lamp,)), orthographic(azimuths[0], height=1.0),
                     (8, 8), multiscatter="off", shadows="off")[2:-2, 2:-2, 1].mean()
    to_eye, to_lamp = np.stack([np.sin(azimuths), 0 * azimuths, np.cos(azimuths)], axis=1)
    n = (BUMPS.reshape(-1, 3) / 127.5 - 1) * [0.5, 0.5, 1]
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    NoV, NoL, NoH = (np.clip(n @ w, 0, 1) for w in (to_eye, to_lamp, (to_eye + to_lamp) / (2 * np.cos(0.3))))
    d = alpha**2 / (np.pi * (1 - NoH**2 * (1 - alpha**2)) ** 2)
    masked = (NoL * np.sqrt(alpha**2 + (1 - alpha**2) * NoV**2) + NoV * np.sqrt(alpha**2 + (1 - alpha**2) * NoL**2))
    fresnel = 1.0 if layer == "base" else 0.04 + 0.96 * (1 - np.cos(0.3)) ** 5
    expected = (fresnel * d * 0.5 / np.maximum(masked, 1e-6) * NoL).mean()
    assert found == pytest.approx(expected, rel=0.3)
