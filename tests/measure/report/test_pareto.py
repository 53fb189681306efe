from __future__ import annotations

from viewer.measure.report.pareto import best_within, free_knobs, front


def test_the_front_holds_what_nothing_beats():
    times, errors = [1, 2, 3, 3, 4, 5], [9, 9, 5, 4, 6, 1]
    assert front(times, errors) == [True, False, False, True, False, True]
    assert front([2, 1], [1, 1]) == [False, True]
    assert front([1, 1], [1, 1]).count(True) == 1  # equals need not both stand there
    assert front([], []) == []


def test_the_best_within_a_time():
    times, errors = [10, 50, 20, 500], [4.0, 3.0, 3.0, 1.0]
    assert best_within(5, times, errors) is None
    assert best_within(10, times, errors) == 0
    assert best_within(100, times, errors) == 2  # as right as the other, and faster
    assert best_within(1e9, times, errors) == 3


def time_ms(median: float, spread: float = 0.01) -> dict[str, float]:
    return {"median": median, "p10": median * (1 - spread), "p90": median * (1 + spread)}


def test_a_knob_is_free_where_only_the_time_changes():
    settings = [{"a": 1, "b": 1}, {"a": 2, "b": 1}, {"a": 2, "b": 2}, {"a": 1}]
    errors = [[1.01], [1.0], [0.5], [1.0]]
    times = [time_ms(10), time_ms(20), time_ms(40), time_ms(1)]
    [knob] = free_knobs(settings, times, errors, noise=[0.0])
    assert (knob.setting, knob.cheap, knob.dear, knob.values) == ("a", 0, 1, (1, 2)) and knob.saved == 0.5


def test_noise_makes_errors_the_same_and_times_uncertain():
    settings, times = [{"a": 1}, {"a": 2}], [time_ms(10), time_ms(20)]
    assert not free_knobs(settings, times, [[1.5], [1.0]], noise=[0.1])
    assert free_knobs(settings, times, [[1.5], [1.0]], noise=[0.6])
    assert free_knobs(settings, times, [[0.5], [1.0]], noise=[0.0])  # cheaper and better
    assert not free_knobs(settings, [time_ms(10, 1.5), time_ms(20)], [[1.0], [1.0]], noise=[0.0])
    assert not free_knobs(settings, [time_ms(10), time_ms(20, 0.6)], [[1.0], [1.0]], noise=[0.0])


def test_what_looks_worse_is_not_free():
    settings, times = [{"a": 1}, {"a": 2}], [time_ms(10), time_ms(20)]
    assert free_knobs(settings, times, [[0.5, 0.1], [1.0, 0.1]], noise=[0.0, 0.0])
    assert not free_knobs(settings, times, [[0.5, 0.2], [1.0, 0.1]], noise=[0.0, 0.05])
