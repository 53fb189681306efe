"""One path-traced picture, or one film, that several workers share."""

from __future__ import annotations

import json
import signal
from concurrent.futures import Future
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from typing import Self

import numpy as np
import pytest
from command_line import SCENES
from PIL import Image as Pillow

import viewer.batch.run
import viewer.jobs.part_renderer
from viewer.base.progress import Progress
from viewer.base.signals import Stopped
from viewer.batch.engines import WorkerLost
from viewer.batch.sums import LEAST_SAMPLES, MOST_PARTS, Sums, parts_of
from viewer.batch.work import Done, Worker
from viewer.image.image import Image
from viewer.jobs.render_job import RenderJob, RenderTask
from viewer.trace.paths.part import Part

PATH = ("render", SCENES / "spheres.glb", "--size", "20x12", "--mode", "path", "--spp", "48", "--background", "none")


class Losing:
    """An engine in this process, which does several parts at a time and loses each part of `lost` once or for ever."""

    room = 3

    def __init__(self, job: RenderJob, lost: dict[int, int]) -> None:
        self._worker, self._lost = Worker(job), dict(lost)

    def submit(self, task: RenderTask) -> Future[Done]:
        future: Future[Done] = Future()
        part = task.samples or task.frames
        assert part is not None
        if self._lost.get(part.start, 0):
            self._lost[part.start] -= 1
            future.set_exception(WorkerLost("its worker has died"))
        else:
            future.set_result(self._worker.do(task, Progress(1, enabled=False)))
        return future

    def finish(self) -> bool:
        return True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self._worker.renderer.release()


@pytest.fixture
def lose(monkeypatch):
    """`lose(lost)`: from then on an engine does the parts that loses those that begin at these samples so often."""
    def patch(lost: dict[int, int]) -> None:
        monkeypatch.setattr("viewer.batch.run.make_engine", lambda job, *_: Losing(job, lost))

    return patch


@pytest.mark.parametrize("samples", [1, 15, 16, 31, 32, 100, 513, 65536])
def test_parts_are_all_samples_once(samples):
    parts = parts_of(samples)
    assert [k for part in parts for k in part] == list(range(samples))
    assert len(parts) <= MOST_PARTS and (len(parts) == 1 or min(map(len, parts)) >= LEAST_SAMPLES)


def test_the_sums_do_not_depend_on_the_order_in_which_parts_come():
    parts = np.random.default_rng(3).lognormal(0, 9, (5, 2, 3, 5, 4)).astype(np.float32)
    found = []
    for order in permutations(range(5)):
        sums = Sums()
        for number in order:
            sums.add(number, Part(parts[number], 10**number, 0.5))
        assert [half.rays for half in sums.halves] == [10101, 1010] and sums.halves[1].seconds == 1
        found.append(np.stack([half.sums for half in sums.halves]))
    assert all(np.array_equal(halves, found[0]) for halves in found) and found[0].dtype == np.float64


def test_a_picture_in_parts_is_the_same_whoever_dies_and_that_of_one_process_but_for_rounding(run, folder, lose):
    alone = run(*PATH, "-o", "alone.exr")
    lose({})
    whole = run(*PATH, "-o", "whole.exr", "--jobs", "2")
    lose({0: 1, 32: 1})
    lossy = run(*PATH, "-o", "lossy.exr", "--jobs", "2", "--stats", "stats.json")
    assert [outcome.status for outcome in (alone, whole, lossy)] == [0, 0, 0] and alone.err == whole.err == ""
    assert lossy.err.count("its worker has died") == 2 and lossy.err.count("is tried again") == 2
    first, second, third = (Image.open(f"{name}.exr") for name in ("alone", "whole", "lossy"))
    assert np.array_equal(second.linear, third.linear)
    np.testing.assert_allclose(second.linear, first.linear, rtol=1e-5, atol=1e-6)
    assert (first.linear[..., 3] == 0).any() and first.linear[..., :3].std() > 0.05
    stats = json.loads((folder / "stats.json").read_text())
    assert (stats["spp"], stats["parts"], stats["size"], stats["bad_samples"]) == (48, 3, [20, 12], 0)
    assert stats["rays"] > 48 * 20 * 12 and stats["trace_s"] > 0


def test_layers_and_the_shadow_on_the_ground_are_those_of_one_process(run, folder, lose):
    command = [*PATH[:-1], "#ffffff", "--ground", "shadow", "--aov", "albedo,normal,depth,variance,samples"]
    assert run(*command, "-o", "alone.npz").status == 0
    lose({16: 1})
    assert run(*command, "-o", "shared.npz", "--jobs", "2").status == 0
    alone, shared = (np.load(f"{name}.npz") for name in ("alone", "shared"))
    assert alone.files == shared.files and (alone["samples"] == 48).all() and np.ptp(alone["rgba"]) > 0.5
    for name in alone.files:
        np.testing.assert_allclose(shared[name], alone[name], rtol=1e-4, atol=1e-5, err_msg=name)


@pytest.mark.parametrize("stop_at, left", [(2, 24), (1, 8)])
def test_ctrl_c_keeps_the_samples_there_are(run, folder, lose, monkeypatch, stop_at, left):
    """Of the parts that are finished, and of that in the making, whose second half is missing."""
    run(*PATH, "-o", "whole.exr")
    waits, real, part = [], viewer.batch.run.wait, viewer.jobs.part_renderer.PartRenderer.part

    def wait(*args, **options):
        waits.append(args)
        if len(waits) == stop_at:
            raise Stopped(signal.SIGINT)
        return real(*args, **options)

    def stopped(renderer, task, wants_to_stop):
        assert not wants_to_stop()
        half = task.samples if len(waits) + 1 < stop_at else range(task.samples.start, task.samples.start + 8)
        return part(renderer, replace(task, samples=half), wants_to_stop)

    lose({})
    monkeypatch.setattr(Losing, "room", 1)
    monkeypatch.setattr("viewer.batch.run.wait", wait)
    monkeypatch.setattr("viewer.jobs.part_renderer.PartRenderer.part", stopped)
    outcome = run(*PATH, "-o", "a.exr", "--jobs", "2", "--stats", "stats.json")
    assert outcome.status == 130 and f"a.exr: stopped after {left} of 48 samples a pixel" in outcome.err
    stats = json.loads((folder / "stats.json").read_text())
    assert stats["stopped"] and stats["spp"] == left and stats["bad_samples"] == 0
    early, whole = (Image.open(f"{name}.exr").linear for name in ("a", "whole"))
    assert 0 < np.sqrt(np.mean((early - whole) ** 2)) < whole.std() / np.sqrt(left)


def test_ctrl_c_before_the_first_sample_leaves_nothing(run, folder, lose, monkeypatch):
    def wait(*args, **options):
        monkeypatch.setattr("viewer.batch.run.wait", lambda *_, **__: None)
        raise Stopped(signal.SIGINT)

    lose({})
    monkeypatch.setattr("viewer.batch.run.wait", wait)
    monkeypatch.setattr("viewer.jobs.part_renderer.PartRenderer.part", lambda *_: ([], None))
    outcome = run(*PATH, "-o", "a.exr", "--jobs", "2")
    assert outcome.status == 130 and not (folder / "a.exr").exists()


def test_a_picture_in_parts_is_denoised_as_a_whole(run, folder, lose):
    """The denoiser compares halves of the samples, which are others than those of one process."""
    command = [*PATH, "--denoise", "fast"]
    assert run(*PATH, "--spp", "512", "-o", "truth.exr").status == 0
    assert run(*command, "-o", "alone.exr").status == 0
    for name, lost in (("shared", {}), ("lossy", {0: 1, 32: 1})):
        lose(lost)
        assert run(*command, "-o", f"{name}.exr", "--jobs", "2", "--stats", f"{name}.json").status == 0
    truth, alone, shared, lossy = (Image.open(f"{name}.exr").linear for name in ("truth", "alone", "shared", "lossy"))
    assert np.array_equal(shared, lossy)
    assert json.loads((folder / "shared.json").read_text())["denoised"] == "fast"
    ours, theirs = (np.mean((picture - truth) ** 2) for picture in (shared, alone))
    assert ours < 1.25 * theirs


def test_a_part_that_is_lost_for_good_fails_the_picture(run, folder, lose):
    lose({16: 9})
    outcome = run(*PATH, "-o", "a.png", "--jobs", "2", "--retries", "2")
    assert outcome.status == 1 and not (folder / "a.png").exists() and outcome.err.count("has died") == 3
    outcome = run("render", "none.glb", "-o", "a.png", "--mode", "path", "--spp", "900", "--jobs", "2")
    told = outcome.err.count("none.glb: no such file")
    assert outcome.status == 1 and 1 <= told <= Losing.room, "and no part after it"


@pytest.mark.parametrize("moves", [("--turntable", "10", "--quality", "standard"),
                                   ("--animation", "0", "--fps", "6", "--mode", "phong")])
def test_a_film_in_parts_is_that_of_one_process_whoever_dies(run, folder, lose, moves):
    film = ("render", SCENES / "arm.glb", "--size", "24", *moves)
    assert run(*film, "-o", "alone.apng").status == 0
    lose({4: 1})
    outcome = run(*film, "-o", "shared.apng", "--jobs", "2", "--stats", "stats.json")
    assert outcome.status == 0 and outcome.err.count("is tried again") == 1
    assert Path("shared.apng").read_bytes() == Path("alone.apng").read_bytes()
    assert json.loads((folder / "stats.json").read_text())["parts"] == 3


@pytest.mark.parametrize("stop_at, left", [(4, 4), (1, 0)])
def test_ctrl_c_leaves_the_film_up_to_the_first_frame_that_is_missing(run, folder, lose, monkeypatch, stop_at, left):
    """The second part is lost, and would be tried again after the third."""
    waits, real = [], viewer.batch.run.wait

    def wait(*args, **options):
        waits.append(args)
        if len(waits) == stop_at:
            raise Stopped(signal.SIGINT)
        return real(*args, **options)

    lose({4: 1})
    monkeypatch.setattr(Losing, "room", 1)
    monkeypatch.setattr("viewer.batch.run.wait", wait)
    outcome = run("render", SCENES / "arm.glb", "--size", "24", "--turntable", "10", "--mode", "phong",
                  "-o", "a.apng", "--jobs", "2", "--stats", "stats.json")
    assert outcome.status == 130 and Path("a.apng").exists() == bool(left)
    if left:
        assert outcome.err.endswith("pbr-viewer: a.apng: stopped after 4 of 10 frames\n")
        with Pillow.open("a.apng") as film:
            assert film.n_frames == left == json.loads((folder / "stats.json").read_text())["frames"]


@pytest.mark.parametrize("more, why", [(("--error", "0.5"), "--error"), (("--time-budget", "1"), "--time-budget"),
                                       (("--view", "front,top"), "several views"), (("--resume",), "--resume"),
                                       (("--set", "caustics=photons"), "caustics=photons")])
def test_what_needs_all_samples_is_not_in_parts(run, folder, monkeypatch, more, why):
    asked = []
    monkeypatch.setattr("viewer.batch.samples.render_in_parts", lambda *_: asked.append("parts") or 0)
    monkeypatch.setattr("viewer.batch.run.render_all", lambda *_: asked.append("whole") or 0)
    told = [run(*PATH, "-o", "a.png", "--jobs", "2", *extra).err for extra in ((), more, (*more, "-q"))]
    assert asked == ["parts", "whole", "whole"]
    assert told == ["", f"{PATH[1]}: with {why} one worker makes the picture: its samples are not shared\n", ""]
