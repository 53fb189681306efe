"""`--denoise raster` and `fast` in pictures: what is left of the error, layers, and films in two parts."""

from __future__ import annotations

import json
import math

import numpy as np
import OpenImageIO as oiio
import pytest
from command_line import SCENES
from shapes import WHITE, facing_floor, moved, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.estimate.mixture import raster_settings
from viewer.measure.compare.relmse import relmse
from viewer.scene.light import Light
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

MODEL = SCENES / "spheres.glb"


@pytest.fixture(scope="module")
def ball():
    return scene((sphere(segments=24), moved((0, 1, 0))), (plate(half=2), facing_floor()), materials=(WHITE,),
                 lights=(Light.from_angles(0.6, 0.9, 3.0),))


def test_pictures_of_few_samples(ball):
    size = 40, 40
    reference = viewer.render(ball, size, mode="path", spp=512, seed=5).linear[..., :3]
    raw, fast, mixed = (viewer.render(ball, size, mode="path", spp=4, denoise=denoise, aov=["albedo", "depth"])
                        for denoise in ("off", "fast", "raster"))
    errors = [relmse(image.linear[..., :3], reference) for image in (raw, fast, mixed)]
    assert errors[1] < errors[0] and errors[2] < 0.6 * errors[0]
    assert mixed.attributes["denoised"] == "raster" and mixed.stats["denoised"] == "raster"
    for image in (fast, mixed):
        assert image.stats["rays"] == pytest.approx(raw.stats["rays"], rel=0.02)
        assert np.abs(image.layers["albedo"] - raw.layers["albedo"]).mean() < 0.02


def test_one_sample_cannot_be_split(ball):
    """So it is filtered alone, and called that; with a colour behind it, too."""
    size = 16, 16
    fast, mixed = (viewer.render(ball, size, mode="path", spp=1, denoise=kind, background="#ff0000")
                   for kind in ("fast", "raster"))
    assert mixed.stats["denoised"] == mixed.attributes["denoised"] == "fast" and mixed.stats["spp"] == 1
    assert np.array_equal(fast.linear, mixed.linear) and mixed.linear[0, 0].tolist() == [1, 0, 0, 1]
    two = viewer.render(ball, size, mode="path", spp=2, denoise="raster", background="#ff0000", time_budget=9.0)
    assert two.stats["denoised"] == "raster" and two.stats["spp"] == 2
    assert np.isfinite(two.linear).all() and two.srgb[0, 0].tolist() == [255, 0, 0, 255]


def test_both_parts_of_a_film_have_half_of_it(context, ball):
    """Samples and photons; together they are the whole."""
    tracer, settings = Tracer(context), Settings(mode="path", spp=6, denoise="fast", caustics="photons")
    path_render = tracer.begin(ball, ball.framing_camera(1.0), settings, (24, 24))
    assert not path_render.film.is_split
    path_render.step(math.inf)
    whole, *parts = ([film.read_sums(), film.photons] for film in (path_render.film, *path_render.film.parts))
    assert path_render.film.is_split and {int(count) for (total, _), _ in parts for count in total[..., 3].flat} == {3}
    np.testing.assert_allclose(sum(squares for (_, squares), _ in parts), whole[0][1], rtol=1e-4)
    assert not np.array_equal(parts[0][0][0], parts[1][0][0])
    assert sum(photons for _, photons in parts) == whole[1]
    path_render.release()
    tracer.release()


def test_the_command_line_makes_it(run, folder):
    outcome = run("render", MODEL, "-o", "a.exr", "--mode", "path", "--size", "24", "--env", "furnace", "--spp", "2",
                  "--denoise", "raster", "--stats", "s.json", "--aov", "albedo")
    assert (outcome.status, outcome.err) == (0, "")
    spec = oiio.ImageInput.open("a.exr").spec()
    assert spec.get_string_attribute("denoised") == "raster" and "albedo.R" in spec.channelnames
    stats = json.loads((folder / "s.json").read_text())
    assert (stats["denoised"], stats["spp"], stats["samples"]) == ("raster", 2, 2 * 24 * 24) and stats["rays"] > 0
    outcome = run("render", MODEL, "-o", "b.png", "--size", "24", "--time-budget", "1", "--denoise", "raster")
    assert outcome.status != 0 and "denoise raster is for mode path" in outcome.error


def test_the_raster_draws_the_same_scene(context, ball):
    chosen = raster_settings(Settings(mode="path", spp=9, denoise="raster", clamp=2.0, fog=0.1, ndf="beckmann",
                                      background=(1.0, 0.0, 0.0)))
    chosen.check_used()
    assert (chosen.mode, chosen.fog, chosen.ndf, chosen.background) == ("pbr", 0.1, "beckmann", "none")
    tracer = Tracer(context)
    with pytest.raises(UsageError, match="for pictures of render"):
        tracer.begin(ball, ball.framing_camera(1.0), Settings(mode="path", denoise="raster"), (8, 8))
    tracer.release()
