"""Normal maps full of grooves: what their mip levels lose of the normals stretches a lobe."""

from __future__ import annotations

import numpy as np
import pytest
from images import image_of
from shapes import lopsided, orthographic, plate, scene

from viewer.gpu.call import call_glsl
from viewer.gpu.context import Context
from viewer.raster.renderer import Renderer
from viewer.scene.material import Material, Texture
from viewer.scene.mip_levels import mip_levels
from viewer.scene.normal_spread import with_spread
from viewer.settings import Settings

RNG = np.random.default_rng(5)


def normal_map(slopes: np.ndarray, dtype: type = np.uint8) -> np.ndarray:
    """(H, W, 3) texels of the normals of (H, W, 2) slopes."""
    normals = np.concatenate([slopes, np.ones_like(slopes[..., :1])], axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    return np.rint((normals + 1) / 2 * np.iinfo(dtype).max).astype(dtype)


def grooves(azimuth: float, spread: float = 0.4, size: int = 64, dtype: type = np.uint8) -> np.ndarray:
    """A map whose slopes are those of grooves across `azimuth`, in each texel another one."""
    slopes = RNG.normal(0, spread, (size, size, 1)) * [np.cos(azimuth), np.sin(azimuth)]
    return normal_map(slopes, dtype)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("azimuth", [0.0, 0.6, 2.2])
def test_what_is_kept_of_grooves_is_the_root_of_their_covariance(dtype, azimuth):
    pixels = grooves(azimuth, dtype=dtype)
    levels = with_spread(mip_levels(pixels))
    full = np.iinfo(dtype).max
    assert all(level.shape[2] == 7 and level.dtype == dtype for level in levels)
    assert (levels[0][0, 0, 4:] == [0, 0, 128 * (full // 255)]).all()
    for k in (2, 4):
        xx, yy, xy = np.moveaxis(levels[k][..., 4:] / full - [0, 0, 128 / 255], 2, 0)
        root = np.moveaxis(np.array([[xx, xy], [xy, yy]]), (0, 1), (2, 3))
        side = 2**k
        blocks = (pixels[..., :2] / full * 2 - 1).reshape(64 // side, side, 64 // side, side, 2).swapaxes(1, 2)
        blocks = blocks.reshape(64 // side, 64 // side, -1, 2)
        rest = blocks - blocks.mean(axis=2, keepdims=True)
        covariance = np.einsum("ijkc,ijkd->ijcd", rest, rest) / side**2
        assert np.abs(root @ root - covariance).max() < (0.004 if dtype == np.uint8 else 3e-4), k


def test_bumps_and_shallow_grooves_keep_one_number():
    bumps = normal_map(RNG.normal(0, 0.4, (64, 64, 2)))
    for pixels in (bumps, grooves(0.3, spread=0.1), grooves(0.3, size=16)):
        assert all(level.shape[2] == 4 for level in with_spread(mip_levels(pixels)))


def test_the_lobe_is_stretched_by_the_covariance_about_the_mean_normal():
    """alpha^2 + 1.365 C as a matrix, whose C is that of slopes about the mean; from normals and not from J."""
    for tilt, azimuth, scale in ((0.0, 0.4, 1.0), (0.5, 0.4, 1.0), (0.4, 2.0, 2.0), (-0.6, 1.0, 0.4)):
        across = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        texels = np.array([np.sin(tilt), 0.0, np.cos(tilt)]) + RNG.normal(0, 0.03, (4000, 1)) * across
        texels /= np.linalg.norm(texels, axis=1, keepdims=True)
        values, vectors = np.linalg.eigh(np.cov(texels[:, :2].T))
        root = (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T
        normals = texels * [scale, scale, 1]
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        n = normals.mean(axis=0) / np.linalg.norm(normals.mean(axis=0))
        x = np.cross([0.0, 1.0, 0.0], n)
        x /= np.linalg.norm(x)
        frame = np.stack([x, np.cross(n, x), n], axis=1)
        slopes = (normals @ frame[:, :2]) / (normals @ n)[:, None]
        expected = np.diag([0.05**2, 0.02**2]) + 1.365 * np.cov(slopes.T)
        found = call_glsl("bsdf/grooves.glsl", "stretch_lobe", alpha=[0.05, 0.02],
                          frame=frame, texel=(texels.mean(axis=0) + 1) / 2,
                          root=[root[0, 0], root[1, 1], root[0, 1] + 128 / 255], scale=scale, map=np.eye(3))
        axes = frame.T @ found["frame"]
        assert np.allclose(axes[2], [0, 0, 1], atol=1e-5) and np.allclose(axes @ axes.T, np.eye(3), atol=1e-5)
        matrix = axes[:2, :2] @ np.diag(np.square(found["alpha"])) @ axes[:2, :2].T
        assert np.abs(matrix - expected).max() < 0.03 * np.linalg.norm(expected), (tilt, azimuth, scale)


def test_any_texel_gives_alphas_that_are_no_smaller_and_at_most_1():
    texels = np.concatenate([RNG.random((500, 6)), np.indices((2,) * 6).reshape(6, -1).T])
    for scale in (0.0, 1.0, 1e6):
        found = call_glsl("bsdf/grooves.glsl", "stretch_lobe", alpha=[0.1, 0.3],
                          frame=np.eye(3), texel=texels[:, :3], root=texels[:, 3:], scale=scale, map=np.eye(3))
        assert np.isfinite(found["frame"]).all() and np.isfinite(found["alpha"]).all()
        assert found["alpha"].min() >= 0.1 * (1 - 1e-6) and found["alpha"].max() <= 1
        assert (found["alpha"][:, 0] >= found["alpha"][:, 1]).all()


@pytest.mark.parametrize("azimuth", [0.0, np.pi / 2])
def test_far_away_a_grooved_mirror_reflects_the_mean_of_what_its_texels_reflect(radiance, azimuth):
    """The mean over the texels in float64. A smooth mirror shows the lamp, three times as bright."""
    to_eye = np.array([-0.5, -0.4, 0.77]) / np.linalg.norm([0.5, 0.4, 0.77])
    camera = orthographic(np.arctan2(to_eye[0], to_eye[2]), np.arcsin(to_eye[1]), height=1.0)
    pixels = grooves(azimuth, size=256)
    material = Material(perceptual_roughness=0.05, normal_texture=Texture(image_of(pixels)))
    found = radiance(scene(plate(), materials=[material], environment=lopsided()), camera, (8, 8))[2:-2, 2:-2, :3]
    n = pixels.reshape(-1, 3) / 127.5 - 1
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    cosine = n @ to_eye
    n, cosine = n[cosine > 0], cosine[cosine > 0]
    d = 2 * cosine[:, None] * n - to_eye
    d[:, 2] = np.abs(d[:, 2])  # what is reflected into the plate is mirrored to its upper side
    spot = np.exp(40 * (d @ (np.array([0.5, 0.4, 0.77]) / np.linalg.norm([0.5, 0.4, 0.77])) - 1))
    expected = np.average(0.6 + 0.5 * d + 4 * spot[:, None], axis=0, weights=cosine / n[:, 2])
    assert np.abs(found.mean(axis=(0, 1)) / expected - 1).max() < 0.12


def test_only_grooved_maps_have_the_code(context: Context):
    renderer = Renderer(context)
    camera, settings = orthographic(0.0, 0.0, height=1.0), Settings.of(antialias="none")
    for pixels, is_grooved in ((grooves(0.0), True), (normal_map(RNG.normal(0, 0.4, (64, 64, 2))), False)):
        material = Material(perceptual_roughness=0.05, normal_texture=Texture(image_of(pixels)))
        renderer.render(scene(plate(), materials=[material], environment=lopsided()), camera, settings, (4, 4))
        program = renderer.plan.programs[0]
        assert program["GROOVED"] == program["ANISOTROPIC"] == is_grooved
        assert program["LOOKUPS"] == (16 if is_grooved else 2)
    renderer.release()


def test_a_map_that_a_coat_wore_first_is_grooved_on_a_base(context: Context):
    renderer = Renderer(context)
    camera, settings = orthographic(0.0, 0.0, height=1.0), Settings.of(antialias="none")
    texture = Texture(image_of(grooves(0.0)))
    for material in (Material(clearcoat=1.0, clearcoat_normal_texture=texture), Material(normal_texture=texture)):
        renderer.render(scene(plate(), materials=[material], environment=lopsided()), camera, settings, (4, 4))
    assert renderer.plan.programs[0]["GROOVED"] == 1
    renderer.release()
