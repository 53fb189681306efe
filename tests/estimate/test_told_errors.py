"""`render --tell-error` and `viewer.render(tell_error=...)`: what is told, and that it is true."""

from __future__ import annotations

import json
import math
import re
import signal
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from command_line import SCENES, names
from shapes import WHITE, facing_floor, moved, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.estimate.measure import error_notes, measure_error
from viewer.estimate.paths import _SEED as SEED_STEP
from viewer.estimate.paths import LEAST_GROUPS, PathGroups, is_over, path_settings
from viewer.estimate.raster_error import raster_error
from viewer.image.image import Image
from viewer.measure.compare.relmse import relmse
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings
from viewer.trace.paths.film import Film
from viewer.trace.tracer import Tracer

MODEL = SCENES / "spheres.glb"
TELL = ("--size", "24", "--env", "furnace", "--tell-error=0.05")
LINE = r"(.*): [\d.]+ % from the truth \(95 % sure: .* %.*\); [\d.]+ % with the right brightness, .*\n"


@pytest.fixture(scope="module")
def ball():
    """On a floor, lit from above: light that the floor sends back is what the raster lacks."""
    material = replace(WHITE, base_color=(0.8, 0.8, 0.8, 1.0))
    light = Light.from_angles(0.6, 0.9, 3.0)
    return scene((sphere(segments=24), moved((0, 1, 0))), (plate(half=4), facing_floor()), materials=(material,),
                 lights=(light,))


def test_the_interval_holds_the_error_of_real_pictures(context, ball):
    size, camera = (32, 32), ball.framing_camera(1.0)
    renderer, tracer = Renderer(context), Tracer(context)
    reference = tracer.render(ball, camera, replace(path_settings(Settings()), spp=512, seed=7), size).linear
    paths = PathGroups.of_raster(tracer, ball, camera, Settings(), size)
    while paths.samples < 32:
        paths.step(math.inf)
    assert paths.groups.shape == (8, 32, 32, 3) and paths.is_enough
    mask = paths.shows_model
    assert 0.1 < mask.mean() < 1
    for settings in (Settings(), Settings(mode="phong"), Settings(shadows="off")):
        picture = renderer.render(ball, camera, settings, size).linear
        true = relmse(picture[mask][:, :3], reference[mask][:, :3])
        told = raster_error(picture, paths.groups, mask, paths.samples, paths.seconds)
        assert true > 0.003 and told.low <= true <= told.high
        assert told.relmse == pytest.approx(true, rel=0.3)
    paths.release()
    tracer.release()
    renderer.release()


def test_rounds_fill_the_groups_one_after_the_other_and_time_ends_them(context, ball):
    camera, tracer = ball.framing_camera(1.0), Tracer(context)
    paths = PathGroups.of_raster(tracer, ball, camera, Settings(), (8, 8))
    counts = []
    while paths.samples < 40:
        paths.step(math.inf)
        counts.append(paths.samples)
    assert counts[:9] == [1, 2, 3, 4, 5, 6, 7, 8, 9] and counts[16:18] == [18, 20]
    assert is_over(paths, 0.0) and not is_over(paths, 1e6)
    first = PathGroups.of_raster(tracer, ball, camera, Settings(), (8, 8))
    first.step(math.inf)
    assert not is_over(first, 0.0) and not first.is_enough
    again = PathGroups.of_raster(tracer, ball, camera, Settings(background=(1.0, 0.0, 0.0)), (8, 8))
    again.step(math.inf)
    assert np.array_equal(first.groups, again.groups)  # the same seeds, and no colour behind the model
    assert measure_error(tracer, np.zeros((8, 8, 4), np.float32), ball, camera, Settings(), (8, 8), 9.0,
                         lambda: True) is None
    assert LEAST_GROUPS >= 3  # the jackknife leaves one out, and needs pairs of the others
    tracer.release()


def test_the_pictures_of_a_group_are_parts_of_one(context, ball):
    """Of one sequence of random numbers, and not of as many as there are pictures."""
    camera, tracer, size = ball.framing_camera(1.0), Tracer(context), (8, 8)
    settings = replace(path_settings(Settings()), seed=3)
    paths = PathGroups(tracer, ball, camera, settings, size, 2)
    while paths.samples < 8:
        paths.step(math.inf)
    assert paths.pictures == 6
    for group, seed in enumerate((3 + SEED_STEP, 3 + 2 * SEED_STEP)):
        whole = tracer.render(ball, camera, replace(settings, spp=4, seed=seed & 0xFFFFFFFF), size)
        np.testing.assert_allclose(paths.groups[group], whole.linear[..., :3], rtol=1e-5)
    tracer.release()


def test_a_pixel_whose_samples_are_all_bad_is_black(context, ball, monkeypatch):
    """And not NaN, which the error of the whole picture would be then."""
    tracer, read_sums = Tracer(context), Film.read_sums

    def without_one(film):
        first, second = (part.copy() for part in read_sums(film))
        first[3, 4] = second[3, 4] = 0
        return first, second

    monkeypatch.setattr(Film, "read_sums", without_one)
    paths = PathGroups.of_raster(tracer, ball, ball.framing_camera(1.0), Settings(), (8, 8))
    while paths.pictures < 16:
        paths.step(math.inf)
    assert np.isfinite(paths.groups).all() and not paths.groups[:, 3, 4].any() and paths.groups.any()
    tracer.release()


def test_of_a_large_picture_each_few_th_pixel_is_traced(context, ball, monkeypatch):
    camera, tracer, size = ball.framing_camera(1.0), Tracer(context), (50, 50)
    settings = replace(path_settings(Settings()), spp=256)
    whole = tracer.render(ball, camera, settings, size).linear[..., :3]
    monkeypatch.setattr("viewer.estimate.paths._MOST_PIXELS", 400)
    paths = PathGroups.of_raster(tracer, ball, camera, Settings(), size)
    if not context.is_software:
        assert paths.every == 1
        return
    part = tracer.begin(ball, camera, settings, size, every=3)
    part.step(math.inf)
    assert paths.every == 3 and part.film.size == (16, 16)
    assert relmse(part.read_radiance()[..., :3], paths.of(whole)) < 0.003 < relmse(whole[17:33, 17:33], paths.of(whole))
    assert np.array_equal(paths.of(paths.spread(np.arange(256).reshape(16, 16))), np.arange(256).reshape(16, 16))
    inside = whole[17:33, 17:33]
    some, every = (raster_error(0.9 * inside, np.stack([inside] * 4), np.ones((16, 16), bool), 8.0, 1.0, left_out=share)
                   for share in (8 / 9, 0.0))
    assert some.high > every.high
    part.release()
    tracer.release()


def test_paths_show_what_the_raster_shows():
    raster = Settings(ndf="beckmann", antialias="ssaa-4", environment_shadows="16", fog=0.5, exposure=2.0)
    chosen = path_settings(raster)
    assert chosen == Settings(mode="path", ndf="beckmann", fog=0.5, exposure=2.0)
    chosen.check_used()
    assert path_settings(replace(raster, background=(1.0, 0.0, 0.0))).background == "none"
    assert error_notes(Settings(), ()) == ()
    notes = error_notes(Settings(shadows="off", media_scattering="single"), ("light through glass: none",))
    assert [re.split(r" |:", note)[0] for note in notes] == ["shadows=off", "media-scattering=single", "counts"]


def test_photons_are_in_the_truth_where_they_are_in_the_picture(context):
    """Below a ball of glass the raster has no light of a lamp. Its error against paths with photons is large, and with
    photons of its own it is small; what lies behind glass is told."""
    glass = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
    floor = replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))
    model = scene((plate(half=3), facing_floor()), (sphere(1, 24), moved((0, 1.2, 0), 0.4)), materials=(floor, glass),
                  lights=(Light("point", intensity=10.0, position=(0.2, 2.4, 0.1)),))
    camera = Camera.look_at((0, 0.5, 1.2), (0, 0, 0.1), fov_y=0.6)
    wanted = Settings(caustics="photons", photons=128)
    renderer, tracer = Renderer(context), Tracer(context)
    told = []
    for caustics in ("off", "photons"):
        raster = renderer.render(model, camera, replace(wanted, caustics=caustics), (16, 16)).linear
        told.append(measure_error(tracer, raster, model, camera, wanted, (16, 16), 0.2))
    assert told[1].relative < 0.5 * told[0].relative
    assert not told[0].notes
    above = Camera.look_at((0, 3, 0.2), (0, 0, 0), fov_y=0.3)
    error = measure_error(tracer, raster, model, above, wanted, (16, 16), 0.1)
    (note,) = error.notes
    assert re.match(r"not counted as error: about (100|[1-9]\d)% of the light of photons", note)
    tracer.release()
    renderer.release()


def test_the_command_line_tells_it_and_writes_the_map(run, folder):
    outcome = run("render", MODEL, "-o", "a.png", *TELL, "--error-map", "m.exr", "--stats", "s.json")
    assert outcome.status == 0 and re.fullmatch(LINE, outcome.err)
    told = json.loads((folder / "s.json").read_text())["estimated_error"]
    assert set(told) >= {"relmse", "low", "high", "relative", "trimmed_relmse", "samples", "seconds"}
    assert 0 <= told["low"] <= told["relmse"] <= told["high"] and told["samples"] >= LEAST_GROUPS
    assert told["relative"] == pytest.approx(math.sqrt(told["relmse"]))
    error = Image.open("m.exr").linear
    assert error.shape == (24, 24, 4) and error[..., 0].max() > 0 and np.array_equal(error[..., 0], error[..., 2])
    models = [MODEL, SCENES / "emissive.glb"]
    outcome = run("render", *models, "-o", "out/", "-q", *TELL, "--error-map", "out/{name}-map.png")
    assert (outcome.status, outcome.err) == (0, "")
    assert names(folder / "out") == ["emissive-map.png", "emissive.png", "manifest.jsonl", "spheres-map.png",
                                     "spheres.png"]


@pytest.mark.parametrize("arguments, problem", [
    (("--error-map", "m.png"), "--error-map needs --tell-error"),
    (("--tell-error", "--mode", "path"), "--tell-error is for pictures of the real-time modes"),
    (("--tell-error=2", "--time-budget", "2"), "--tell-error with --time-budget or --error"),
    (("--tell-error", "--error-map", "m.jpg"), "--error-map m.jpg: the name of a map must end in .exr or .png"),
    (("--tell-error", "--error-map", "./a.png"), "a.png: two outputs would be written to one file"),
    (("--stats", "a.png"), "a.png: two outputs would be written to one file"),
    (("second.glb", "-o", "out/", "--tell-error=1", "--error-map", "m.png"),
     "--error-map m.png: several models need a folder, m.png/"),
    (("--tell-error=-1",), "Invalid value for '--tell-error': -1 is not from 0.01 to 1e+06"),
    (("--tell-error", "second.glb"), "'second.glb' is not a number; a MODEL after it needs --tell-error=SECONDS"),
    (("--tell-error", "--error-map", f"{MODEL}/m.png"), f"{MODEL}: is a file, not a folder"),
    (("--tell-error", "--turntable", "2", "-o", "b.webp"), "it tells the error of pictures, not of films"),
])
def test_what_it_cannot_tell_is_refused(run, folder, arguments, problem):
    outcome = run("render", MODEL, "-o", "a.png", "--size", "8", *arguments)
    assert outcome.status in (1, 2) and problem in outcome.error and names(folder) == []


def test_ctrl_c_keeps_the_picture(run, folder, monkeypatch):
    def interrupted(paths: PathGroups, seconds: float, wants_to_stop: Callable[[], bool]) -> None:
        signal.raise_signal(signal.SIGINT)
        assert wants_to_stop()

    monkeypatch.setattr("viewer.estimate.measure.trace_for", interrupted)
    outcome = run("render", MODEL, "-o", "a.png", *TELL, "--error-map", "m.png")
    assert outcome.status == 130 and names(folder) == ["a.png"]
    assert outcome.error == "a.png: stopped after the picture, before its error was known"


def test_a_failure_of_the_path_tracer_keeps_the_picture(run, folder, monkeypatch):
    """And of another picture, told before, nothing is told again."""
    begin, models = Tracer.begin, [SCENES / "emissive.glb", MODEL]

    def without_spheres(tracer, scene, *arguments, **named):
        if (folder / "out/spheres.png").exists():
            raise UsageError("the scene does not fit")
        return begin(tracer, scene, *arguments, **named)

    monkeypatch.setattr(Tracer, "begin", without_spheres)
    outcome = run("render", *models, "-o", "out/", *TELL, "--error-map", "out/{name}-map.png", "--stats", "s.json")
    assert outcome.status == 1
    assert names(folder / "out") == ["emissive-map.png", "emissive.png", "manifest.jsonl", "spheres.png"]
    told = "out/spheres.png is written, but how far it is from the truth is not known: the scene does not fit"
    assert outcome.err.splitlines()[-1] == f"pbr-viewer: {told}"
    first, second = json.loads((folder / "s.json").read_text())
    assert "estimated_error" in first and "error" not in first
    assert second["error"] == told and second["triangles"] > 0 and "estimated_error" not in second


def test_from_python(ball):
    with pytest.warns(UserWarning, match="shadows=off leaves out light"):
        image = viewer.render(ball, (16, 16), tell_error=0.02, shadows="off")
    told = image.stats["estimated_error"]
    assert json.loads(json.dumps(told))["notes"] and image.layers["error"].shape == (16, 16)
    for wrong in ({"mode": "path"}, {"time_budget": 1.0}):
        with pytest.raises(UsageError, match="tell_error"):
            viewer.render(ball, (16, 16), tell_error=1.0, **wrong)
    with pytest.raises(UsageError, match=r"tell_error=-1: it must be a number from 0.01"):
        viewer.render(ball, (16, 16), tell_error=-1)
