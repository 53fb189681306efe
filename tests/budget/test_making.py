"""The course of a picture, with renderers whose frames and samples take the time that a test says, by its own clock."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from right_pictures import RASTERS, SIZE, truth
from shapes import plate, scene

from viewer.budget import making
from viewer.budget.chooser import Chooser
from viewer.budget.pace import maps, work
from viewer.estimate.paths import PathGroups
from viewer.image.image import Image
from viewer.scene.environment_files import load_environment
from viewer.settings import Settings

STEPS = 4
"""Iterations of a picture of one sample a pixel."""


@dataclass
class Machine:
    """Seconds of its work."""

    frame: float = 0.01
    first: float = 0.3
    """Of the first frame, on top, and of the first with shadows of the environment."""
    map: float = 0.002
    prepare: float = 0.5
    """Of paths."""
    sample: float = 0.05
    combine: float = 0.02
    surprise: float = 0.0
    """Of the combination of the whole picture, on top."""
    now: float = 0.0
    drawn: list[Settings] = field(default_factory=list)
    samples: int = 0
    is_held: bool = False
    is_traced: bool = False
    shadow_maps: int = 0

    def clock(self) -> float:
        return self.now


class Raster:
    """Whose picture is too bright, the less the more it works."""

    def __init__(self, machine: Machine) -> None:
        self._machine, self.times, self.texture_seconds, self.plan, self.context, self.programs = \
            machine, {}, 0.0, None, None, None

    def holds(self, shown) -> bool:
        return self._machine.is_held

    def expect(self, ahead) -> None:
        ahead.cancel()

    def draw(self, shown, camera, settings, size, half, still) -> None:
        machine = self._machine
        if not machine.is_held or (maps(settings) and not machine.shadow_maps):
            machine.now += machine.first
            self.times["compile and upload"] = self.times.get("compile and upload", 0) + machine.first
        if maps(settings):
            spent = 1e-6 if maps(settings) == machine.shadow_maps else machine.map * maps(settings)
            machine.shadow_maps = maps(settings)
            machine.now += spent
            self.times["environment shadows"] = self.times.get("environment shadows", 0) + spent
        machine.is_held = True
        if size != (SIZE, SIZE):
            machine.now += machine.map / 2
        else:
            machine.now += machine.frame * work(settings)
            machine.drawn.append(settings)
            self._linear = np.ones((SIZE, SIZE, 4), np.float32)
            self._linear[..., :3] = truth() * np.float32(1 + 1 / work(settings))

    def read_radiance(self) -> np.ndarray:
        return self._linear


class Paths:
    def __init__(self, machine: Machine) -> None:
        self._machine = machine

    def holds(self, shown) -> bool:
        return self._machine.is_traced

    def begin(self, shown, camera, settings, size, layers=(), every=1, first=0):
        machine = self._machine
        machine.now += 0 if machine.is_traced else machine.prepare
        machine.is_traced = True
        noise = np.random.default_rng((settings.seed, first)).exponential(size=(settings.spp, SIZE, SIZE, 1))
        total = (truth() * noise).sum(axis=0)
        done = SimpleNamespace(steps=0)

        def sums():
            share = done.steps / (settings.spp * STEPS)  # of the rows, when it ends early
            count = np.where(np.arange(SIZE)[:, None, None] < share * SIZE, settings.spp, 0) * np.ones((SIZE, SIZE, 1))
            return np.concatenate([total * (count > 0), count], -1), np.concatenate([total, count], -1)

        def step(seconds):
            begun = machine.now
            while not render.is_done:
                done.steps += 1
                machine.now += machine.sample / STEPS
                render.is_done = done.steps == settings.spp * STEPS
                if machine.now - begun >= seconds:
                    break

        render = SimpleNamespace(
            step=step, is_done=False, film=SimpleNamespace(read_sums=sums), release=lambda: None,
            plan=SimpleNamespace(missing=()), lost_share=0.0,
            stats=lambda: {"samples": settings.spp * SIZE**2, "bad_samples": 0, "rays": 9, "trace_s": 0.1})
        machine.samples += settings.spp
        return render


@pytest.fixture
def make(monkeypatch):
    """A function that makes a picture on a machine. It takes a scene of its own, but that of `again`."""
    shown = scene(plate(), environment=load_environment("furnace"))
    srgb = np.zeros((SIZE, SIZE, 4), np.uint8)
    monkeypatch.setattr(making, "displayed", lambda context, programs, linear, settings: Image(
        linear.astype(np.float32), srgb))

    def made(machine: Machine, chooser: Chooser | None = None, wants_to_stop=lambda: False, **settings):
        def judged(raster, samples):
            machine.now += machine.combine * raster.shape[0] * raster.shape[1] / SIZE**2
            machine.now += machine.surprise if machine.samples else 0.0
            return real(raster, samples)

        monkeypatch.setattr(making, "judged", judged)
        chooser = chooser or Chooser(None, Raster(machine), Paths(machine), machine.clock)
        return chooser.make(shown, None, Settings(**settings), (SIZE, SIZE), wants_to_stop=wants_to_stop)

    real = making.judged
    return made


MACHINES = {"quick": {}, "slow paths": {"sample": 1.0}, "slow raster": {"frame": 0.2}, "slow maps": {"map": 0.2},
            "slow combination": {"combine": 0.6}, "all in no time": {"frame": 1e-4, "first": 1e-3, "sample": 5e-3,
                                                                     "map": 1e-5, "prepare": 0.01, "combine": 1e-3}}


@pytest.mark.parametrize("speed", MACHINES)
def test_the_time_is_kept_and_used(make, speed):
    """Whether the scene is new or not."""
    for budget in (0.05, 0.3, 1.0, 3.0, 8.0):
        machine = Machine(**MACHINES[speed])
        chooser = Chooser(None, Raster(machine), Paths(machine), machine.clock)
        for _ in range(3):
            started = machine.now
            _, choice = make(machine, chooser, time_budget=budget)
            assert choice.seconds == pytest.approx(machine.now - started)
            first = next(candidate["seconds"] for candidate in choice.candidates if candidate["seconds"] is not None)
            assert choice.seconds <= max(1.1 * budget, first + machine.frame)
            if choice.told is not None:
                assert choice.seconds > 0.5 * budget


def test_more_time_improves_and_then_traces(make):
    methods = [make(Machine(), time_budget=budget)[1].method for budget in (0.1, 0.5, 1.2, 20.0)]
    assert methods[0] == "image-based light, no antialiasing" and methods[1] == "image-based light, SSAA 4"
    assert methods[2].startswith("shadows of the environment, ") and methods[3].endswith(", mixed with paths")


def test_what_comes_out_is_what_is_told(make):
    image, choice = make(Machine(), time_budget=6)
    right = truth().astype(np.float64)
    true = ((image.linear[..., :3] - right) ** 2 / (right**2 + 0.01)).mean()
    assert choice.told.low <= true <= choice.told.high
    assert choice.samples == pytest.approx(image.stats["spp"]) and choice.samples > 8
    assert image.stats["estimated_error"]["relmse"] == choice.told.relmse
    assert min(choice.compared.values()) == choice.measured and len(choice.compared) == 3


def test_a_scene_that_was_drawn_begins_with_the_best_candidate_there_is_time_for(make):
    machine = Machine(sample=5.0)
    chooser = Chooser(None, Raster(machine), Paths(machine), machine.clock)
    make(machine, chooser, time_budget=5)
    machine.drawn.clear()
    _, choice = make(machine, chooser, time_budget=0.5)
    assert [maps(settings) for settings in machine.drawn] == [64] and choice.seconds < 0.5


def test_maps_that_are_held_are_used_with_fewer_points(make):
    """A scene that was drawn with 64 shadow maps has them, and time for one point a pixel; otherwise none are drawn for
    so few."""
    machine = Machine(sample=5.0)
    chooser = Chooser(None, Raster(machine), Paths(machine), machine.clock)
    _, choice = make(machine, chooser, time_budget=5)
    held, = (candidate for candidate in choice.candidates if candidate["method"].endswith("64 lights, no antialiasing"))
    assert "SSAA 9" in choice.method and held["seconds"] is None
    _, choice = make(machine, chooser, time_budget=0.075)
    assert choice.method == held["method"] and choice.seconds < 0.075


def test_few_paths_do_not_keep_the_raster_from_improving(make):
    """There is time for four samples a pixel, which bring less than shadows of the environment."""
    machine = Machine()
    chooser = Chooser(None, Raster(machine), Paths(machine), machine.clock)
    make(machine, chooser, time_budget=10)
    machine.drawn.clear()
    _, choice = make(machine, chooser, time_budget=0.3)
    assert maps(machine.drawn[0]) == 64 and choice.seconds < 0.33
    machine.drawn.clear()
    make(machine, chooser, time_budget=1.2)
    assert maps(machine.drawn[0]) == 64 and machine.samples > 16


def test_maps_of_a_scene_that_was_drawn_are_foreseen(make):
    """Slow ones: the budget allows for the 16 that are held, and not for 64 others."""
    machine = Machine(map=0.05, sample=1.0)
    chooser = Chooser(None, Raster(machine), Paths(machine), machine.clock)
    make(machine, chooser, time_budget=8.0)
    assert machine.shadow_maps == 16
    for _ in range(3):
        _, choice = make(machine, chooser, time_budget=1.0)
        assert choice.seconds < 1.1 and machine.shadow_maps == 16


def test_paths_that_come_to_nothing_leave_the_raster_alone(make):
    """They take far longer than a frame lets expect."""
    _, choice = make(Machine(sample=3.0), time_budget=4)
    assert choice.unfinished == "paths" and choice.told is None and "SSAA 9" in choice.method
    assert choice.to_json()["error_is"] == "not measured" and "no time for enough samples" in str(choice)
    assert choice.seconds <= 4.4


def test_a_target_is_reached_and_no_more(make):
    results = [make(Machine(), error=target) for target in (0.5, 0.1, 0.05)]
    for (_, choice), target in zip(results, (0.5, 0.1, 0.05), strict=True):
        assert choice.told.high <= target**2 and choice.unmet == ""
    assert [choice.told.samples for _, choice in results] == sorted({choice.told.samples for _, choice in results})


def test_a_target_with_too_little_time(make):
    _, choice = make(Machine(), error=0.001, time_budget=3)
    assert choice.unmet == "the requested error was not reached" and 2 < choice.seconds < 3.3
    _, choice = make(Machine(), error=0.01, time_budget=0.6)
    assert choice.unmet == "it is not known whether the error is met: there was no time to trace paths"


def test_a_budget_that_is_not_kept_is_told_with_the_reason(make):
    _, choice = make(Machine(), time_budget=0.05)
    assert choice.unmet == "no picture can be ready within 0.05 s here, since the scene has to be prepared"
    _, choice = make(Machine(surprise=3.0), time_budget=3)
    assert choice.unmet == "it took longer than estimated" and choice.ready < 3


def test_where_a_setting_leaves_the_raster_alone_paths_only_judge(make):
    image, choice = make(Machine(), time_budget=5, shadows="off")
    assert choice.samples is None and choice.told is not None and "spp" not in image.stats
    assert image.stats["estimated_error"]["notes"] == ["shadows=off leaves out light, which counts as error"]
    _, choice = make(Machine(), error=0.01, shadows="off")
    assert choice.unmet == "the requested error was not reached" and "SSAA 9" in choice.method


@pytest.mark.parametrize("looks, is_mixed", [(1, False), (4, False), (60, True)])
def test_asked_to_stop_it_keeps_what_there_is(make, looks, is_mixed):
    asked = iter([False] * looks)
    image, choice = make(Machine(), wants_to_stop=lambda: next(asked, True), time_budget=100)
    assert (choice.told is not None) == is_mixed and choice.unfinished is None and np.isfinite(image.linear).all()
    assert choice.seconds < 50


def groups_of(machine: Machine) -> PathGroups:
    settings = Settings(mode="path")
    return PathGroups(Paths(machine), None, None, settings, (SIZE, SIZE), making.GROUPS, clock=machine.clock)


def test_groups_have_their_samples_evenly_and_keep_unfinished_ones():
    machine = Machine()
    groups = groups_of(machine)
    while not groups.is_enough:
        groups.step(10.0, np.inf)
    assert groups.is_even and groups.samples == 4 and (groups.count == 1).all()
    assert groups.seconds == pytest.approx(0.2) and groups.each == pytest.approx(0.05)
    groups.step(0.0, np.inf)
    groups.end()
    assert 4 < groups.samples < 5 and groups.count[1:].max() == 1 and groups.count[0].max() == 2
    before = groups.samples
    groups.end()
    assert groups.samples == before


@pytest.mark.parametrize("growth, rounds", [(1.0, [4, 8, 16, 28]), (3.0, [4, 16, 64, 76])])
def test_rounds_grow_and_end_where_they_are_wanted(growth, rounds):
    machine = Machine()
    settings = Settings(mode="path")
    groups = PathGroups(Paths(machine), None, None, settings, (SIZE, SIZE), making.GROUPS, growth=growth,
                        clock=machine.clock)
    seen = []
    for most in [np.inf] * 3 + [12.0]:
        for _ in range(4):
            groups.step(100.0, most)
        seen.append(groups.samples)
    assert seen == rounds


def test_a_round_fills_its_time():
    """Pictures take 0.1 s and 0.02 s for each sample."""
    groups = groups_of(Machine())
    assert groups.within(5.0) == np.inf
    groups._took = {1: 0.12}
    assert groups.within(4.8) == pytest.approx(40)
    groups._took[3] = 0.16
    assert groups.within(4 * (0.1 + 0.02 * 7)) == pytest.approx(28) and groups.within(0.1) == 0


def test_the_raster_is_no_lamp_that_paths_never_meet(make):
    """With enough samples the picture is the paths', whatever the raster shows."""
    assert RASTERS["one bright spot"].max() > truth().max()
    machine = Machine(sample=0.002)
    image, _ = make(machine, time_budget=8)
    assert np.abs(image.linear[..., :3] - truth()).mean() < 0.02 * truth().mean()
