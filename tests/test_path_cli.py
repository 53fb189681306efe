"""`--mode path` through the doors: what it writes, tells and survives."""

from __future__ import annotations

import json
import os
import re
import signal

import numpy as np
import OpenImageIO as oiio
import pytest
from command_line import SCENES, names
from PIL import Image as Pillow

import viewer
from viewer.errors import UsageError
from viewer.image.image import Image
from viewer.trace.paths.path_render import PathRender

MODEL = SCENES / "spheres.glb"
PATH = ("--mode", "path", "--size", "24", "--env", "furnace")


def test_a_picture_with_layers_and_stats(run, folder):
    outcome = run("render", MODEL, "-o", "a.exr", *PATH, "--spp", "3", "--aov", "samples,depth,samples", "--denoise",
                  "fast", "--set", "clamp=5", "--stats", "s.json", "--background", "none")
    assert (outcome.status, outcome.err) == (0, "") and names(folder) == ["a.exr", "s.json"]
    spec = oiio.ImageInput.open("a.exr").spec()
    assert set(spec.channelnames) == {*"RGBA", "samples.Y", "depth.Z"}
    assert spec.get_string_attribute("denoised") == "fast" and "luminance 5" in spec.get_string_attribute("clamped")
    image = Image.open("a.exr")
    assert image.linear[0, 0, 3] == 0 and image.linear[..., 3].max() == 1
    assert "rmse: 0\n" in run("diff", "a.exr", "a.exr").out
    stats = json.loads((folder / "s.json").read_text())
    assert stats["spp"] == 3 and stats["samples"] == 3 * 24 * 24 and stats["bad_samples"] == 0
    assert stats["rays"] > stats["samples"] and stats["rays_per_s"] > 0 and stats["estimated_error"]["relative"] > 0
    assert stats["denoised"] == "fast" and stats["intersector"] == stats["plan"]["intersector"]
    assert stats["stopped"] is False and stats["plan"]["passes"][0] == "intersect" and stats["trace_s"] > 0


def test_a_png_says_how_many_samples_it_has_and_verbose_tells_it(run, folder):
    outcome = run("render", MODEL, "-o", "a.png", *PATH, "--spp", "2", "-v")
    assert Pillow.open("a.png").text == {"samples": "2 a pixel"}
    assert "2 of 2 samples a pixel, estimated error" in outcome.err and "million rays by " in outcome.err


def test_the_options_change_what_they_are_named_for(run, folder):
    changes = [[], [], ["--seed", "1"], ["--spp", "3"], ["--denoise", "fast"], ["--set", "bounces=1"],
               ["--env-intensity", "2"], ["--exposure", "1"]]
    for number, change in enumerate(changes):
        options = {"--spp": ["--spp", "2"]} if "--spp" not in change else {}
        assert run("render", MODEL, "-o", f"{number}.png", *PATH, *options.get("--spp", []), *change).status == 0
    first, again, *others = (Image.open(f"{number}.png").srgb for number in range(len(changes)))
    assert np.array_equal(first, again)
    assert [change for change, other in zip(changes[2:], others, strict=True) if np.array_equal(first, other)] == []


def test_a_time_budget_ends_it_with_a_whole_picture(run, folder):
    outcome = run("render", MODEL, "-o", "a.png", *PATH, "--time-budget", "0.01", "--stats", "s.json")
    assert (outcome.status, outcome.err) == (0, "")
    stats = json.loads((folder / "s.json").read_text())
    assert 1 <= stats["spp"] < 65536 and stats["trace_s"] < 30
    assert (Image.open("a.png").srgb[..., 3] == 255).all()


def test_a_target_ends_it(run, folder):
    run("render", MODEL, "-o", "a.png", *PATH, "--error", "1", "--spp", "200", "--stats", "s.json")
    stats = json.loads((folder / "s.json").read_text())
    assert stats["estimated_error"]["relative"] <= 1 and stats["spp"] == 64


def interrupting(monkeypatch, before: int, times: int = 1):
    """PathRender.step as if somebody pressed Ctrl-C so many times, once `before` steps were made."""
    step, steps = PathRender.step, []

    def interrupted(self, seconds):
        steps.append(None)
        assert len(steps) < before + 50, "Ctrl-C is not heard"
        if len(steps) > before:
            for _ in range(times):
                os.kill(os.getpid(), signal.SIGINT)
        else:
            while not self.is_whole:
                step(self, seconds)

    monkeypatch.setattr(PathRender, "step", interrupted)


def test_ctrl_c_writes_the_picture_so_far_and_says_how_far_it_came(run, folder, monkeypatch):
    handlers = signal.getsignal(signal.SIGINT)
    interrupting(monkeypatch, before=1)
    outcome = run("render", MODEL, SCENES / "unlit.glb", "-o", folder, *PATH, "--spp", "65536", "--stats", "s.json")
    assert outcome.status == 130 and names(folder) == ["manifest.jsonl", "s.json", "spheres.png"]
    line = r"spheres\.png: stopped after [0-9.]+ of 65536 samples a pixel(, estimated error [0-9.]+)?, .* rays by .*"
    assert re.fullmatch(f".*{line}", outcome.error)
    [stats] = json.loads((folder / "s.json").read_text())
    assert stats["stopped"] is True and 1 <= stats["spp"] < 65536
    assert Image.open("spheres.png").size == (24, 24) and signal.getsignal(signal.SIGINT) is handlers


@pytest.mark.parametrize("before, times", [(0, 1), (1, 2)])
def test_ctrl_c_before_there_is_a_picture_or_twice_leaves_nothing(run, folder, monkeypatch, before, times):
    interrupting(monkeypatch, before, times)
    outcome = run("render", MODEL, "-o", "a.png", *PATH, "--spp", "65536")
    assert (outcome.status, outcome.error) == (130, "interrupted") and names(folder) == []


def test_ctrl_c_while_only_the_sky_has_samples_leaves_nothing(run, folder, monkeypatch):
    """The bare sky has all of its samples at once, before the first path of a surface ends."""
    step, seen = PathRender.step, []

    def interrupted(self, seconds):
        step(self, 0.0)
        seen.append((self.samples, self.is_whole))
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(PathRender, "step", interrupted)
    outcome = run("render", MODEL, "-o", "a.png", *PATH, "--size", "128", "--spp", "65536")
    assert seen[0][0] > 0 and not seen[0][1]
    assert (outcome.status, outcome.error) == (130, "interrupted") and names(folder) == []


def test_info_tells_the_plan(run):
    facts = json.loads(run("info", MODEL, "--mode", "path", "--json", "-").out)
    assert facts["plan"]["passes"][0] == "intersect" and facts["plan"]["triangles"] == facts["triangles"]


def test_the_python_api_shares_a_context_with_the_raster():
    scene = viewer.load(MODEL, environment="furnace")
    raster = viewer.render(scene, size=(40, 24)).linear
    path = viewer.render(scene, size=(40, 24), mode="path", spp=2, aov=["albedo", "variance"])
    assert set(path.layers) == {"albedo", "variance"} and path.layers["albedo"].shape == (24, 40, 3)
    assert path.layers["albedo"].dtype == np.float32 and path.stats["spp"] == 2
    assert np.array_equal(viewer.render(scene, size=(40, 24)).linear, raster)
    again = viewer.render(scene, size=(40, 24), mode="path", spp=2)
    assert np.array_equal(again.linear, path.linear) and again.layers == {}
    assert path.linear.mean() == pytest.approx(raster.mean(), rel=0.05)


@pytest.mark.parametrize("arguments, words", [
    ({"aov": ["samples"]}, "only mode path has samples, not mode pbr"),
    ({"mode": "path", "aov": ["z"]}, "there is no layer 'z'; choose from albedo"),
    ({"spp": 4}, "spp has no effect in mode pbr"),
])
def test_the_python_api_refuses_what_does_nothing(arguments, words):
    with pytest.raises(UsageError, match=words):
        viewer.render(viewer.load(MODEL), size=(8, 8), **arguments)


def test_samples_that_are_left_out_are_told(run, folder):
    """A grid of one dense voxel beside an empty one: a ray that enters the empty one needs a million collisions."""
    np.savez("wall.npz", density=np.float32([[[0, 1]]]), bbox=[[0, 0, 0], [2, 1, 1]])
    words = ("--set", "volume-density=1e6", "--set", "volume-albedo=0,0,0", "--orbit", "-90,0", "--spp", "1")
    outcome = run("render", "wall.npz", "-o", "a.png", *PATH, *words, "--stats", "s.json")
    bad = json.loads((folder / "s.json").read_text())["bad_samples"]
    told = f"{bad} of 576 samples are left out of the picture, because their light could not be computed"
    assert outcome.status == 0 and outcome.err == f"wall.npz: warning: {told}\n" and 0 < bad < 576
    assert run("render", "wall.npz", "-o", "a.png", *PATH, *words, "-q").err == ""
    with pytest.warns(UserWarning, match="samples are left out of the picture"):
        viewer.render(viewer.load("wall.npz", "furnace"), (8, 8), mode="path", spp=1, volume_density=1e6,
                      volume_albedo=(0.0, 0.0, 0.0))
