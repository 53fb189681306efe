"""Choosing by what is known of a device, with a device that is made up."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from viewer.budget.calibration import Calibration, RasterMethod, TracedMethod
from viewer.budget.choice import Candidate, Choice, Ready, candidates, choose, stand_in, worth_trying
from viewer.budget.cost import Cost, Load
from viewer.errors import UsageError
from viewer.measure.scenes import constant, scene, sphere
from viewer.scene.material import Material
from viewer.settings import Settings

SIZE = (100, 100)


def raster(title: str, seconds: float, error: float, **changes: str) -> RasterMethod:
    return RasterMethod(title, changes, Cost(fixed=0.2), Cost(pixel=seconds / 1e4), {"environment": error})


CALIBRATION = Calibration(
    (raster("Phong", 0.001, 0.4, mode="phong"), raster("image", 0.01, 0.2, antialias="none"),
     raster("shadows", 0.5, 0.1, antialias="msaa-4")),
    TracedMethod(Cost(fixed=0.4), Cost(pixel=1e-5), Cost(pixel=1e-6), Cost(pixel=5e-6), {"environment": 0.8},
                 ((0.8, 0.5), (0.05, 0.9))),
    {"raster": 0.1, "path": 0.3})
"""At SIZE: a raster takes 0.4 s to begin, paths 0.9 s, 0.1 s a sample and 0.01 s or 0.06 s to end."""
FRESH = Ready()
ALL_READY = Ready(True, True, frozenset({"Phong", "image", "shadows"}),
                  frozenset({"path traced", "path traced, denoised (fast)"}))


@pytest.fixture(scope="module")
def ball():
    return scene([sphere(segments=8)], [Material()], environment=constant())


def chosen(ball, ready=FRESH, **settings) -> Candidate:
    wish = Settings(**settings)
    return choose(candidates(CALIBRATION, ball, SIZE, wish, ready), wish.time_budget, wish.error)


@pytest.mark.parametrize("budget, method", [
    (0.01, "Phong"), (0.405, "Phong"), (0.43, "image"), (0.95, "shadows"), (6.0, "path traced, denoised (fast)")])
def test_a_budget_gets_the_least_error_there_is_time_for(ball, budget, method):
    assert chosen(ball, time_budget=budget).title == method


def test_more_time_is_never_worse(ball):
    found = [chosen(ball, time_budget=0.41 * 1.1**k) for k in range(60)]
    assert all(one.seconds <= 0.41 * 1.1**k * 1.000001 for k, one in enumerate(found))
    assert all(later.error <= earlier.error for earlier, later in pairwise(found))


def test_what_is_prepared_already_takes_no_time_again(ball):
    assert chosen(ball, ALL_READY, time_budget=0.02).title == "image"
    assert chosen(ball, ALL_READY, time_budget=0.02).seconds == pytest.approx(0.01)
    textured = replace(CALIBRATION.raster[1], prepare=Cost(fixed=0.2, triangle=1.0))
    held = candidates(replace(CALIBRATION, raster=(textured,)), ball, SIZE, Settings(time_budget=1.0),
                      Ready(has_raster=True, holds_raster=True))
    assert held[0].seconds == pytest.approx(0.01 + 1.5 * 0.2)
    path = candidates(CALIBRATION, ball, SIZE, Settings(time_budget=1.01), ALL_READY)[-2]
    assert (path.title, path.samples) == ("path traced", pytest.approx(10))
    assert path.error == pytest.approx(0.8 / 10**0.5)


def test_where_pictures_take_longer_than_expected_more_time_is_allowed_for_them(ball):
    assert chosen(ball, replace(ALL_READY, pace=3.0), time_budget=0.02).title == "Phong"
    path = candidates(CALIBRATION, ball, SIZE, Settings(time_budget=1.02), replace(ALL_READY, pace=2.0))[-2]
    assert path.samples == pytest.approx(5)


def test_filtering_is_left_out_where_samples_are_the_better_use_of_its_time(ball):
    slow = replace(CALIBRATION, raster=(), traced=replace(CALIBRATION.traced, denoise=Cost(fixed=0.6)))
    titles = [choose(candidates(slow, ball, SIZE, Settings(time_budget=seconds)), seconds, None).title
              for seconds in (1.0, 30.0)]
    assert titles == ["path traced", "path traced, denoised (fast)"]


def test_an_error_gets_the_fastest_method_that_usually_has_it(ball):
    assert chosen(ball, error=0.5).title == "Phong"
    assert chosen(ball, error=0.1).title == "shadows"
    path = chosen(ball, error=0.04)
    assert (path.title, path.samples) == ("path traced", pytest.approx(400))


def test_with_both_the_error_counts_only_as_far_as_the_time_allows(ball):
    assert chosen(ball, error=0.001, time_budget=0.44).title == "image"
    assert chosen(ball, error=0.25, time_budget=5).title == "image"


def test_what_the_user_has_set_stays(ball):
    def titles(**changes):
        return {one.title for one in candidates(CALIBRATION, ball, SIZE, Settings(time_budget=1, **changes))}

    assert titles() == {"Phong", "image", "shadows", "path traced", "path traced, denoised (fast)"}
    assert titles(antialias="none") == {"Phong", "image"}
    assert titles(shadows="off") == {"Phong", "image", "shadows"}
    assert titles(seed=3) == {"path traced", "path traced, denoised (fast)"}
    assert titles(denoise="oidn") == {"path traced, denoised (oidn)"}
    with pytest.raises(UsageError, match="give a mode"):
        titles(seed=3, shadows="off")


def test_a_picture_to_compare_with_is_made_where_it_is_quick_and_may_be_the_better_one(ball):
    found = candidates(CALIBRATION, ball, SIZE, Settings(time_budget=2.0))
    path = found[-1]
    assert stand_in(found, 2.0, path).title == "image"
    assert stand_in(found, 1.2, path) is None
    assert stand_in(found, 2.0, replace(path, error=0.01)) is None


def test_methods_that_usually_are_near_to_an_error_are_tried(ball):
    found = candidates(CALIBRATION, ball, SIZE, Settings(error=0.07))
    path = found[-1]
    assert [one.title for one in worth_trying(found, path, 0.07)] == ["shadows"]
    assert [one.title for one in worth_trying(found, path, 0.3)] == ["Phong", "shadows"]
    assert worth_trying(found, replace(path, seconds=0.1), 0.3) == []
    assert worth_trying(found, path, 0.01) == []


def test_the_choice_is_told_in_a_line(ball):
    found = candidates(CALIBRATION, ball, SIZE, Settings(time_budget=2.0))
    choice = Choice(found, found[-2], 2.0, None, seconds=1.96, samples=12.0, error=0.23, held=[(found[1], 0.31)])
    assert str(choice) == "time budget 2 s: path traced, 12 samples a pixel, in 2 s; error 0.23; image: 0.31"
    assert choice.to_json()["compared"] == [{"method": "image", "error": 0.31}]
    beaten = replace(found[-2], error=0.4)  # by its samples, whatever was expected of it
    kept = Choice(found, found[1], 2.0, None, seconds=1.9, error=0.31, held=[(found[1], 0.31)], beaten=beaten)
    assert str(kept) == "time budget 2 s: image, in 1.9 s; error 0.31; path traced: 0.4"
    assert kept.to_json()["compared"][1] == {"method": "path traced", "error": 0.4}
    late = Choice(found, replace(found[1], seconds=0.3), 0.05, None, seconds=0.3)
    assert str(late) == ("time budget 0.05 s: image, in 0.3 s; expected error 0.2 "
                         "(nothing is ready within 0.05 s here, preparing the scene included)")
    assert Choice(found, found[0], 2.0, 0.1, seconds=1.0, error=0.2).unmet == "the error asked for was not reached"
    assert Choice(found, found[0], 2.0, None, seconds=2.39).unmet == ""


def test_costs_are_told_apart_by_loads_that_differ():
    base, large, many = Load(100, 10, 0), Load(300, 10, 0), Load(100, 1010, 0)
    true = Cost(0.5, 0.01, 0.002)
    fitted = Cost.fitted((base, true.seconds(base)), pixel=(large, true.seconds(large)),
                         triangle=(many, true.seconds(many)))
    assert (fitted.fixed, fitted.pixel, fitted.triangle) == pytest.approx((0.5, 0.01, 0.002))
    assert Cost.fitted((base, 1.0), pixel=(large, 0.5)) == Cost(fixed=1.0)
