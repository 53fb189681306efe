"""`--denoise raster`: what is left of the error of noisy pictures, and that no detail is worsened."""

from __future__ import annotations

import json

import numpy as np
import OpenImageIO as oiio
import pytest
from command_line import SCENES
from right_pictures import RASTERS, SIZE, truth
from shapes import WHITE, facing_floor, moved, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.estimate.mixture import half_settings, raster_settings, render_mixture
from viewer.estimate.neighbourhood import mixture
from viewer.measure.compare.relmse import relmse
from viewer.raster.renderer import Renderer
from viewer.scene.light import Light
from viewer.settings import Settings
from viewer.trace.denoise.denoiser import make_denoiser
from viewer.trace.tracer import Tracer

MODEL = SCENES / "spheres.glb"


def noisy(right: np.ndarray, samples: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """The mean of samples that are right times a number of mean 1 and variance 1, and its estimated variance."""
    each = right * np.random.default_rng(seed).exponential(size=(samples, *right.shape[:2], 1)).astype(np.float32)
    return each.mean(axis=0), each.var(axis=0, ddof=1) / samples


@pytest.mark.parametrize("samples, most", [(4, 0.5), (16, 0.5), (64, 0.8)])
def test_the_error_shrinks_whatever_the_raster(samples, most):
    right = truth()
    mean, noise = noisy(right, samples)
    shares = [relmse(mixture(raster, mean, noise), right) / relmse(mean, right) for raster in RASTERS.values()]
    assert max(shares) < 1.02 and np.median(shares) < most
    assert relmse(mixture(right, mean, noise), right) < most * relmse(mean, right)


def test_a_small_lamp_in_a_mirror_stays_where_it_is():
    """Which the raster does not have. Around it, nothing gets brighter; and likewise for a lamp of the raster alone."""
    dark, lamp = np.full((SIZE, SIZE, 3), 0.1, np.float32), np.full((SIZE, SIZE, 3), 0.1, np.float32)
    lamp[20:22, 30:32] = 500
    for right, raster in ((lamp, dark), (dark, lamp)):
        for samples in (4, 16):
            mean, noise = noisy(right, samples)
            mixed = mixture(raster, mean, noise)
            assert relmse(mixed, right) < 1.02 * relmse(mean, right)
    mean, noise = noisy(lamp, 16)
    assert mixture(dark, mean, noise)[20:22, 30:32].mean() == pytest.approx(mean[20:22, 30:32].mean(), rel=0.05)


def test_it_is_the_paths_when_they_have_no_noise():
    for raster in RASTERS.values():
        np.testing.assert_allclose(mixture(raster, truth(), np.zeros_like(truth())), truth(), rtol=1e-5)
    black = np.zeros((8, 9, 3), np.float32)
    assert not mixture(black, black, black).any()


@pytest.fixture(scope="module")
def ball():
    return scene((sphere(segments=24), moved((0, 1, 0))), (plate(half=2), facing_floor()), materials=(WHITE,),
                 lights=(Light.from_angles(0.6, 0.9, 3.0),))


def test_pictures_of_few_samples(ball):
    size = 40, 40
    reference = viewer.render(ball, size, mode="path", spp=512, seed=5).linear[..., :3]
    raw, mixed = (viewer.render(ball, size, mode="path", spp=4, denoise=denoise) for denoise in ("off", "raster"))
    assert relmse(mixed.linear[..., :3], reference) < 0.6 * relmse(raw.linear[..., :3], reference)
    assert mixed.attributes["denoised"] == "raster" and mixed.stats["denoised"] == "raster"
    few = viewer.render(ball, size, mode="path", spp=1, denoise="raster", background="#ff0000", time_budget=9.0)
    assert np.isfinite(few.linear).all() and few.linear[0, 0].tolist() == [1, 0, 0, 1] and few.stats["spp"] == 2
    assert few.srgb[0, 0].tolist() == [255, 0, 0, 255]


def test_stopped_early_it_leaves_the_samples_as_they_are(context, ball):
    renderer, tracer, asked = Renderer(context), Tracer(context), iter([False])
    camera, settings = ball.framing_camera(1.0), Settings(mode="path", spp=64, denoise="raster")
    image = render_mixture(tracer, renderer, ball, camera, settings, (16, 16),
                           wants_to_stop=lambda: next(asked, True))
    assert image.stats["denoised"] == "off" and "denoised" not in image.attributes
    tracer.release()
    renderer.release()


def test_the_halves_have_all_samples_and_nothing_in_common():
    for spp in (1, 2, 5, 64):
        first, second = half_settings(Settings(mode="path", spp=spp, seed=3, denoise="raster", error=0.1))
        assert first.most_spp + second.most_spp == max(spp, 2) and first.seed != second.seed
        assert first.error == second.error == pytest.approx(0.1 * 2**0.5) and first.denoise == "off"


def test_the_command_line_makes_it(run, folder):
    outcome = run("render", MODEL, "-o", "a.exr", "--mode", "path", "--size", "24", "--env", "furnace", "--spp", "2",
                  "--denoise", "raster", "--stats", "s.json")
    assert (outcome.status, outcome.err) == (0, "")
    assert oiio.ImageInput.open("a.exr").spec().get_string_attribute("denoised") == "raster"
    stats = json.loads((folder / "s.json").read_text())
    assert (stats["denoised"], stats["spp"], stats["samples"]) == ("raster", 2, 2 * 24 * 24) and stats["rays"] > 0
    outcome = run("render", MODEL, "-o", "b.exr", "--mode", "path", "--denoise", "raster", "--aov", "albedo")
    assert outcome.status != 0 and "aov has no effect together with denoise raster" in outcome.error
    outcome = run("render", MODEL, "-o", "b.png", "--size", "24", "--time-budget", "1", "--denoise", "raster")
    assert outcome.status != 0 and "denoise raster is for mode path" in outcome.error


def test_the_raster_draws_the_same_scene(context):
    chosen = raster_settings(Settings(mode="path", spp=9, denoise="raster", clamp=2.0, fog=0.1, ndf="beckmann",
                                      background=(1.0, 0.0, 0.0)))
    chosen.check_used()
    assert (chosen.mode, chosen.fog, chosen.ndf, chosen.background) == ("pbr", 0.1, "beckmann", "none")
    with pytest.raises(UsageError, match="for pictures of render"):
        make_denoiser(context, None, "raster")
