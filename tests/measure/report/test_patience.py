from __future__ import annotations

import numpy as np

from viewer.measure.report.ladder import Method
from viewer.measure.report.patience import is_met_by_pilot, longest, reason_against
from viewer.measure.report.store import Record
from viewer.measure.report.timing import Effort

EFFORT = Effort(least=3, most=9, seconds=1.0, once_s=3.0)


def rung(name: str, spp: int, seconds: float, error: float = 0.1) -> tuple[Method, Record]:
    facts = {"spp": spp, "time_ms": {"median": 1e3 * seconds}, "estimated_error": error}
    return Method(name, "", {"mode": "path", "spp": spp}), Record(np.zeros((1, 1, 4), np.float32), facts)


def why(method: Method, rungs, left: float) -> str:
    return reason_against(method, rungs, left, EFFORT)


def test_the_next_number_of_samples_takes_as_many_times_as_long_three_times_over():
    method = Method("path", "", {"mode": "path", "spp": 8})
    rungs = [rung("path", 4, 0.5), rung("path+fast", 4, 50.0)]
    assert why(method, rungs, 3.1) == "" and why(method, rungs, 2.9) == "it would take 3 s, more than is left"
    assert why(method, [rung("path", 4, 5.0)], 10.1) == ""  # long ones are run once
    assert why(method, [], -1.0) == ""
    denoised = Method("path+fast", "", {"mode": "path", "spp": 8, "denoise": "fast"})
    assert why(denoised, [], 1.0) == "" and why(denoised, [], -1.0) == "no time is left for it"


def test_more_lights_take_as_many_times_as_long_preparing_included():
    def lights(count: str, seconds: float = 0.0) -> tuple[Method, Record]:
        method = Method("environment-shadows", "", {"environment_shadows": count})
        return method, Record(np.zeros((1, 1, 4), np.float32), {"time_ms": {"median": 5.0}}, seconds)

    rungs = [lights("16", 2.0)]
    assert why(lights("64")[0], rungs, 8.1) == "" and "8 s" in why(lights("64")[0], rungs, 7.9)
    assert why(lights("16")[0], [], -1.0) == ""  # the first of a family is always measured
    finer = Method("environment-shadows", "", {"environment_shadows": "64", "antialias": "ssaa-4"})
    rungs = [lights("256", 9.0), (finer, Record(np.zeros((1, 1, 4), np.float32), {}, 2.0))]
    assert why(finer, rungs, 2.1) == "" and why(finer, rungs[:1], 2.1) != ""  # by its own kind, or else by the next
    plain = Method("ibl", "", {"environment_shadows": "off"})
    rungs = [(plain, Record(np.zeros((1, 1, 4), np.float32), {}, 2.0))]
    assert why(plain, rungs, 2.1) == "" and why(plain, rungs, 1.9) != ""


def test_an_adaptive_picture_is_foretold_from_what_64_samples_reach():
    method = Method("path-adaptive", "", {"mode": "path", "error": 0.05})
    rungs = [rung("path", 32, 2.0, 0.14), rung("path", 64, 4.0, 0.1)]
    assert why(method, rungs, 16.1) == "" and "16 s" in why(method, rungs, 15.9)
    assert "take too long here" in why(method, rungs[:1], 1e9)
    assert not is_met_by_pilot(method, rungs) and is_met_by_pilot(method, [rung("path", 64, 4.0, 0.04)])
    assert not is_met_by_pilot(rungs[0][0], rungs)


def test_ten_seconds_are_filled_past_the_steps_there_is_no_time_for():
    steps = [Method("path", "", {"mode": "path", "spp": 1 << k}) for k in range(9)]
    rungs = [rung("path", 4, 0.5), rung("path+fast", 8, 50.0)]
    assert longest(steps, rungs, 8.1).changes["spp"] == 64  # 8 s; twice as many would take 16
    assert longest(steps, rungs, 7.9) is None
    assert longest(steps, [rung("path", 64, 8.0)], 1e9) is None  # it is there
    assert longest(steps, [rung("path", 4, 0.001)], 1e9).changes["spp"] == 256  # there are no more
    assert longest(steps, [], 1e9) is None
