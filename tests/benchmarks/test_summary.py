"""The figures that the benchmarks report, on runs whose answers are known."""

from __future__ import annotations

import pytest

from benchmarks.programs import OURS, OURS_EVERYTHING, ours
from benchmarks.shot import REPOSITORY
from benchmarks.summary import Spread, Target, judge, ratios, values
from benchmarks.tables import phase_table, target_table

WARM = Target("warm", "wall_s", 0.5, "f3d")


def runs(*seconds: float) -> list[dict[str, object]]:
    return [{"wall_s": s, "processor_s": 2 * s, "rss_mb": 100 * s} for s in seconds]


def test_spread_of_eleven_values_has_their_second_and_tenth() -> None:
    spread = Spread.of([float(x) for x in (10, 0, 1, 9, 2, 8, 3, 7, 4, 6, 5)])
    assert (spread.median, spread.p10, spread.p90, spread.n) == pytest.approx((5, 1, 9, 11))


def test_one_value_has_no_spread() -> None:
    assert Spread.of([3.0]) == Spread(3.0, 3.0, 3.0, 1)


def test_a_ratio_stays_within_its_round() -> None:
    # The machine was twice as slow in the second round; ratios of medians would not see that both were.
    assert ratios(runs(1, 2, 1), runs(4, 8, 4), "wall_s") == [0.25] * 3


def test_a_round_in_which_one_failed_has_no_ratio() -> None:
    assert ratios(runs(1, 2), [{"error": "status 1"}, {"wall_s": 4.0}], "wall_s") == [0.5]


def test_single_frames_count_where_they_are_listed() -> None:
    assert values([{"frame_median_ms": 2.0, "frame_ms": [1.0, 2.0, 9.0]}, {"frame_median_ms": 5.0}, {"error": "x"}],
                  "frame_median_ms") == [1.0, 2.0, 9.0, 5.0]


@pytest.mark.parametrize(("rivals", "expected", "ratio"), [("f3d", "f3d-egl", 0.5), ("image-based", "panda3d", 1.0),
                                                           ("all", "pyrender-egl", 2.0),
                                                           ("everything", OURS_EVERYTHING, 4.0)])
def test_a_target_picks_the_best_of_its_rivals(rivals: str, expected: str, ratio: float) -> None:
    rounds = {OURS: runs(2, 2), "f3d-egl": runs(4, 4), "f3d-osmesa": runs(5, 5), "panda3d": runs(2, 2),
              "pyrender-egl": runs(1, 1), OURS_EVERYTHING: runs(0.5, 0.5)}
    verdict = judge(Target("warm", "wall_s", 0.5, rivals), rounds, {*rounds} - {"pyrender-egl"})
    assert (verdict.rival, verdict.ratio.median, verdict.reached) == (expected, ratio, ratio <= 0.5)


def test_no_verdict_without_a_rival() -> None:
    assert judge(WARM, {OURS: runs(1)}, {OURS}) is None
    assert target_table({"warm": {OURS: runs(1)}}, {OURS}) == ""


def test_the_tables_show_failures_and_verdicts() -> None:
    rounds = {OURS: runs(1, 1), "f3d-egl": runs(4, 4), "pygfx": [{"error": "status 1: a | b"}] * 2}
    table = phase_table("warm", rounds, {OURS, "f3d-egl"})
    assert "| pygfx | failed: status 1: a / b | | | | |" in table
    assert "| f3d-egl | 4.00 (4.00 to 4.00, 2) | x4.00 | 8.00 | 400 | image-based |" in table
    assert "| warm, time | f3d-egl | 0.25 (0.25 to 0.25, 2) | 0.4 | yes |" in target_table({"warm": rounds}, {OURS})


def test_our_plan_of_everything_is_asked_of_both_commands(tmp_path) -> None:
    program = next(one for one in ours() if one.name == OURS_EVERYTHING)
    arguments = str(REPOSITORY / "assets/demo.glb"), "studio", (8, 8), tmp_path / "a.png"
    assert program.frames(*arguments, 3)[-2:] == ["--plan", "everything"]
    assert program.screenshot(*arguments)[-2:] == ["--set", "plan=everything"]
