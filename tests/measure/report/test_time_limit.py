from __future__ import annotations

import numpy as np

from viewer.measure.report.ladder import Method
from viewer.measure.report.store import Record
from viewer.measure.report.time_limit import ends_before_adapting, longest, reason_against
from viewer.measure.report.timing import Effort

EFFORT = Effort(least=3, most=9, seconds=1.0, once_s=3.0)


def traced(name: str, spp: int, seconds: float, error: float = 0.1) -> tuple[Method, Record]:
    facts = {"spp": spp, "time_ms": {"median": 1e3 * seconds}, "estimated_error": error}
    return Method(name, "", {"mode": "path", "spp": spp}), Record(np.zeros((1, 1, 4), np.float32), facts)


def why(method: Method, measured, left: float) -> str:
    return reason_against(method, measured, left, EFFORT)


def test_twice_the_samples_take_twice_as_long_and_are_run_three_times():
    method = Method("path", "", {"mode": "path", "spp": 8})
    measured = [traced("path", 4, 0.5), traced("path+fast", 4, 50.0)]
    assert why(method, measured, 3.1) == "" and why(method, measured, 2.9) == "it would take 3 s, more than is left"
    assert why(method, [traced("path", 4, 5.0)], 10.1) == ""  # long ones are run once
    assert why(method, [], -1.0) == ""
    denoised = Method("path+fast", "", {"mode": "path", "spp": 8, "denoise": "fast"})
    assert why(denoised, [], 1.0) == "" and why(denoised, [], -1.0) == "no time is left for it"


def test_more_lights_take_as_many_times_as_long_preparing_included():
    def lights(count: str, seconds: float = 0.0) -> tuple[Method, Record]:
        method = Method("environment-shadows", "", {"environment_shadows": count})
        return method, Record(np.zeros((1, 1, 4), np.float32), {"time_ms": {"median": 5.0}}, seconds)

    measured = [lights("16", 2.0)]
    assert why(lights("64")[0], measured, 8.1) == "" and "8 s" in why(lights("64")[0], measured, 7.9)
    assert why(lights("16")[0], [], -1.0) == ""  # the first of a family is always measured
    finer = Method("environment-shadows", "", {"environment_shadows": "64", "antialias": "ssaa-4"})
    measured = [lights("256", 9.0), (finer, Record(np.zeros((1, 1, 4), np.float32), {}, 2.0))]
    assert why(finer, measured, 2.1) == "" and why(finer, measured[:1], 2.1) != ""  # its own family, or the nearest
    plain = Method("ibl", "", {"environment_shadows": "off"})
    measured = [(plain, Record(np.zeros((1, 1, 4), np.float32), {}, 2.0))]
    assert why(plain, measured, 2.1) == "" and why(plain, measured, 1.9) != ""


def test_an_adaptive_picture_is_predicted_from_the_error_after_64_samples():
    method = Method("path-adaptive", "", {"mode": "path", "error": 0.05})
    measured = [traced("path", 32, 2.0, 0.14), traced("path", 64, 4.0, 0.1)]
    assert why(method, measured, 16.1) == "" and "16 s" in why(method, measured, 15.9)
    assert "take too long here" in why(method, measured[:1], 1e9)
    assert not ends_before_adapting(method, measured) and ends_before_adapting(method, [traced("path", 64, 4.0, 0.04)])
    assert not ends_before_adapting(measured[0][0], measured)


def test_a_picture_of_about_ten_seconds_is_found():
    steps = [Method("path", "", {"mode": "path", "spp": 1 << k}) for k in range(9)]
    measured = [traced("path", 4, 0.5), traced("path+fast", 8, 50.0)]
    assert longest(steps, measured, 8.1).changes["spp"] == 64  # 8 s; twice as many would take 16
    assert longest(steps, measured, 7.9) is None
    assert longest(steps, [traced("path", 64, 8.0)], 1e9) is None  # it is there
    assert longest(steps, [traced("path", 4, 0.001)], 1e9).changes["spp"] == 256  # there are no more
    assert longest(steps, [], 1e9) is None
