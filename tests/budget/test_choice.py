"""Choosing by what is known of a device, with a device that is made up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.budget.calibration import Calibration, RasterMethod, TracedMethod
from viewer.budget.candidates import Candidate, Ready, candidates
from viewer.budget.choice import Choice
from viewer.budget.cost import Cost, Load
from viewer.budget.course import best_course, choose, least_of_two, worth_trying
from viewer.errors import UsageError
from viewer.measure.check.scenes import constant, scene, sphere
from viewer.scene.material import Material
from viewer.settings import Settings

SIZE = (100, 100)


def raster(title: str, seconds: float, error: float, **changes: str) -> RasterMethod:
    return RasterMethod(title, changes, Cost(fixed=0.5), Cost(fixed=0.1), Cost(fixed=0.1), Cost(pixel=seconds / 1e4),
                        {"environment": error})


CALIBRATION = Calibration(
    (raster("Phong", 0.001, 0.4, mode="phong"), raster("image", 0.01, 0.2, antialias="none"),
     raster("shadows", 0.5, 0.1, antialias="msaa-4")),
    TracedMethod(Cost(fixed=1.0), Cost(fixed=0.2), Cost(), Cost(), Cost(fixed=0.2), Cost(pixel=1e-5), Cost(pixel=1e-6),
                 Cost(pixel=5e-6), {"environment": 0.8}, ((0.8, 0.5), (0.05, 0.9))),
    {"raster": 0.1, "path": 0.3})
"""At SIZE: a raster takes 0.4 s to begin, paths 1 s, 0.1 s a sample and 0.01 s or 0.06 s to end."""
RASTER, PATH = frozenset({"Phong", "image", "shadows"}), frozenset({"path traced", "path traced, denoised (fast)"})
NEW = Ready()
KEPT = Ready(kept=RASTER | PATH)
ALL_READY = Ready(True, True, RASTER, True, True, RASTER | PATH)


@pytest.fixture(scope="module")
def ball():
    return scene([sphere(segments=8)], [Material()], environment=constant())


def found(ball, ready=KEPT, calibration=CALIBRATION, **settings) -> list[Candidate]:
    load = replace(Load.of(ball, SIZE), bakes=0)
    return candidates(calibration, load, ball, Settings(**settings), ready)


def chosen(ball, ready=KEPT, **settings) -> Candidate:
    return choose(found(ball, ready, **settings), settings.get("time_budget"), settings.get("error"))


@pytest.mark.parametrize("budget, method", [
    (0.01, "Phong"), (0.405, "Phong"), (0.42, "image"), (1.2, "shadows"), (6.0, "path traced, denoised (fast)")])
def test_a_budget_gets_the_least_error_there_is_time_for(ball, budget, method):
    assert chosen(ball, time_budget=budget).title == method


@pytest.mark.parametrize("ready", [NEW, KEPT, ALL_READY])
@pytest.mark.parametrize("pace", [1.0, 2.5])
def test_more_time_is_never_expected_to_be_worse(ball, ready, pace):
    before = 1.0
    for k in range(130):
        budget = 0.05 * 1.05**k
        course = best_course(found(ball, replace(ready, pace=pace), time_budget=budget), budget)
        if course is not None:
            assert course.seconds <= budget * 1.00001 and course.error <= before * 1.00001
            before = course.error
    assert before < 0.1


def test_what_little_time_allows_is_not_given_up_for_a_few_samples(ball):
    course = best_course(found(ball, time_budget=1.7), 1.7)
    assert course.first.title == "shadows" and course.path is None
    course = best_course(found(ball, time_budget=5.0), 5.0)
    assert course.first is not None and course.path is not None
    assert best_course(found(ball, ALL_READY, time_budget=900.0), 900.0).first is None
    assert best_course(found(ball, time_budget=0.2), 0.2) is None


def test_the_better_one_of_two_is_better_than_each():
    assert least_of_two(0.1, 0.1) == pytest.approx(0.1 * np.exp(-0.7 / np.sqrt(2 * np.pi)))
    assert least_of_two(0.1, 0.001) == pytest.approx(0.001, rel=1e-3)
    assert least_of_two(0.1, 0.2) == pytest.approx(least_of_two(0.2, 0.1))


def test_what_is_prepared_already_takes_no_time_again(ball):
    assert chosen(ball, ALL_READY, time_budget=0.02).title == "image"
    assert chosen(ball, ALL_READY, time_budget=0.02).seconds == pytest.approx(0.01)
    textured = replace(CALIBRATION.raster[1], prepare=Cost(fixed=0.2, shadowed=1.0))
    held = found(ball, Ready(has_raster=True, holds_raster=True, compiled=RASTER),
                 replace(CALIBRATION, raster=(textured,)))
    assert held[0].seconds == pytest.approx(1.5 * (0.01 + 0.2))
    path = found(ball, ALL_READY, time_budget=1.01)[-2]
    assert (path.title, path.samples) == ("path traced", pytest.approx(10))
    assert path.error == pytest.approx(0.8 / 10**0.5)


def test_what_the_driver_has_not_compiled_takes_longer(ball):
    assert found(ball, NEW)[0].seconds - found(ball, KEPT)[0].seconds == pytest.approx(1.5 * 0.4)
    assert found(ball, NEW)[-1].begin - found(ball, KEPT)[-1].begin == pytest.approx(1.5 * 0.8)


def test_where_pictures_take_longer_than_expected_more_time_is_allowed_for_them(ball):
    assert chosen(ball, replace(ALL_READY, pace=3.0), time_budget=0.02).title == "Phong"
    path = found(ball, replace(ALL_READY, pace=2.0), time_budget=1.02)[-2]
    assert path.samples == pytest.approx(5)


def test_filtering_is_left_out_where_samples_are_the_better_use_of_its_time(ball):
    slow = replace(CALIBRATION, raster=(), traced=replace(CALIBRATION.traced, denoise=Cost(fixed=0.6)))
    titles = [choose(found(ball, calibration=slow, time_budget=seconds), seconds, None).title
              for seconds in (1.4, 30.0)]
    assert titles == ["path traced", "path traced, denoised (fast)"]


def test_an_error_gets_the_fastest_method_that_usually_has_it(ball):
    assert chosen(ball, error=0.5).title == "Phong"
    assert chosen(ball, error=0.1).title == "shadows"
    path = chosen(ball, error=0.04)
    assert (path.title, path.samples) == ("path traced", pytest.approx(400))


def test_with_both_the_error_counts_only_as_far_as_the_time_allows(ball):
    assert chosen(ball, error=0.001, time_budget=0.42).title == "image"
    assert chosen(ball, error=0.25, time_budget=5).title == "image"


def test_what_the_user_has_set_stays(ball):
    def titles(**changes):
        return {one.title for one in found(ball, time_budget=1, **changes)}

    assert titles() == {"Phong", "image", "shadows", "path traced", "path traced, denoised (fast)"}
    assert titles(antialias="none") == {"Phong", "image"}
    with pytest.raises(UsageError, match="give a --mode"):
        titles(ambient_occlusion="gtao")
    assert titles(shadows="off") == {"Phong", "image", "shadows"}
    assert titles(seed=3) == {"path traced", "path traced, denoised (fast)"}
    assert titles(denoise="oidn") == {"path traced, denoised (oidn)"}
    with pytest.raises(UsageError, match="give a mode"):
        titles(seed=3, shadows="off")


def test_methods_that_usually_are_near_to_an_error_are_tried(ball):
    all_ = found(ball, error=0.07)
    path = all_[-1]
    assert [one.title for one in worth_trying(all_, path, 0.07)] == ["shadows"]
    assert [one.title for one in worth_trying(all_, path, 0.3)] == ["Phong", "shadows"]
    assert worth_trying(all_, replace(path, seconds=0.1), 0.3) == []
    assert worth_trying(all_, path, 0.01) == []


def test_the_choice_is_told_in_a_line(ball):
    all_ = found(ball, time_budget=2.0)
    choice = Choice(all_, all_[-2], 2.0, None, seconds=1.96, samples=12.0, error=0.23, held=[(all_[1], 0.31)])
    assert str(choice) == "time budget 2 s: path traced, 12 samples a pixel, in 2 s; error 0.23; image: 0.31"
    assert choice.to_json()["compared"] == [{"method": "image", "error": 0.31}]
    beaten = replace(all_[-2], error=0.4)  # by its samples, whatever was expected of it
    kept = Choice(all_, all_[1], 2.0, None, seconds=1.9, error=0.31, held=[(all_[1], 0.31)], beaten=beaten)
    assert str(kept) == "time budget 2 s: image, in 1.9 s; error 0.31; path traced: 0.4"
    assert kept.to_json()["compared"][1] == {"method": "path traced", "error": 0.4}
    late = Choice(all_, replace(all_[1], seconds=0.3), 0.05, None, seconds=0.3)
    assert str(late) == ("time budget 0.05 s: image, in 0.3 s; expected error 0.2 "
                         "(nothing is ready within 0.05 s here, preparing the scene included)")
    foggy = replace(late, budget=1.0, has_media=True)
    assert str(foggy) == ("time budget 1 s: image, in 0.3 s; expected error 0.2 without fog and volumes, with which it "
                          "is not known")
    assert foggy.to_json()["error_is"] == "expected without fog and volumes"
    assert "fog" not in str(replace(foggy, error=0.2)) + str(late)
    assert Choice(all_, all_[0], 2.0, 0.1, seconds=1.0, error=0.2).unmet == "the error asked for was not reached"
    assert Choice(all_, all_[0], 2.0, None, seconds=2.39).unmet == ""


def test_costs_are_told_apart_by_loads_that_differ():
    base, large, many = Load(100, 10, 0), Load(300, 10, 0), Load(100, 1010, 0, shadowed=2020)
    true, known = Cost(0.5, 0.01, 0.002, shadowed=3e-5), Cost(shadowed=3e-5)
    fitted = Cost.fitted((base, true.seconds(base)), known, pixel=(large, true.seconds(large)),
                         triangle=(many, true.seconds(many)))
    assert (fitted.fixed, fitted.pixel, fitted.triangle) == pytest.approx((0.5, 0.01, 0.002))
    assert Cost.fitted((base, 1.0), pixel=(large, 0.5)) == Cost(fixed=1.0)
