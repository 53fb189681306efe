"""What to do with the time there is: the course that is expected to end with the least error."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

from .candidates import MIN_SAMPLES, SLACK, Candidate, TracedCandidate

SPREAD = 0.7
"""Standard deviation of the logarithm of how many times as wrong as expected a picture of the raster is, held against a
path-traced one: which of the two is better is not sure before both are there."""
NEAR = 1.5
"""How many times the error allowed the usual one of a method may be for it to be tried on a scene."""
NOTHING = 1.0
"""The error of having no picture."""


@dataclass(frozen=True)
class Course:
    """A picture of the raster, or paths, or that first and paths in the time that is left: the better one is kept.
    `error` is that expected of what is kept."""

    first: Candidate | None
    path: TracedCandidate | None
    error: float

    @property
    def seconds(self) -> float:
        return sum(one.seconds for one in (self.first, self.path) if one is not None)


def best_course(found: Sequence[Candidate], budget: float, had: Candidate | None = None) -> Course | None:
    """The one of the least error, by what is expected; None where nothing fits. The more time, the more courses there
    are and the better each is, so that more time never has a larger error expected. A picture that is `had` already
    can come first for nothing."""
    return min(_courses(found, budget, had), key=attrgetter("error", "seconds"), default=None)


def _courses(found: Sequence[Candidate], budget: float, had: Candidate | None) -> Iterator[Course]:
    raster = [one for one in found if not one.is_traced and one.fits(budget)]
    had = replace(had, seconds=0.0) if had is not None else None
    for one in raster:
        yield Course(one, None, one.error)
    for path in found:
        if isinstance(path, TracedCandidate):
            for first in ((None, *raster) if had is None else (had, *raster)):
                after = path.within(budget - (first.seconds if first is not None else 0.0))
                if after.seconds + (first.seconds if first is not None else 0.0) <= budget * (1 + SLACK):
                    yield Course(first, after, _expected(first, after))


def _expected(first: Candidate | None, path: TracedCandidate) -> float:
    """The geometric mean of what is left; the fewer samples are expected, the likelier it is that time runs out before
    every pixel has one."""
    alone = first.error if first is not None else NOTHING
    done = least_of_two(alone, path.error) if first is not None else path.error
    missed = min((MIN_SAMPLES / (path.samples or MIN_SAMPLES)) ** 2, 1.0)
    return math.exp(missed * math.log(alone) + (1 - missed) * math.log(done))


def least_of_two(a: float, b: float) -> float:
    """The geometric mean of the smaller one of two errors, when `a` and `b` are what is expected of them and the
    logarithm of their ratio deviates by `SPREAD`: Clark 1961, "The Greatest of a Finite Set of Random Variables",
    equation 2."""
    x = (math.log(b) - math.log(a)) / SPREAD
    below, density = 0.5 * math.erfc(-x / math.sqrt(2)), math.exp(-x * x / 2) / math.sqrt(2 * math.pi)
    return math.exp(math.log(a) * below + math.log(b) * (1 - below) - SPREAD * density)


def choose(found: Sequence[Candidate], budget: float | None, error: float | None) -> Candidate:
    """Of those within `budget` seconds the least error, but of those within `error` too the least time; where none is
    within the budget, the fastest."""
    fitting = [one for one in found if one.fits(budget)]
    if not fitting:
        return min(found, key=attrgetter("seconds", "error"))
    right = [one for one in fitting if error is not None and one.error <= error * (1 + SLACK)]
    if right:
        return min(right, key=attrgetter("seconds", "error"))
    return min(fitting, key=attrgetter("error", "seconds"))


def worth_trying(found: Sequence[Candidate], path: Candidate, target: float) -> list[Candidate]:
    """The methods of the raster that may have such an error and are faster than tracing to it, two at most: the
    fastest, and the one that usually is best."""
    near = sorted((one for one in found if not one.is_traced and one.error <= NEAR * target
                   and one.seconds < path.seconds / 2), key=attrgetter("seconds"))
    best = min(near[1:], key=attrgetter("error"), default=None)
    return near if best is None else [near[0], best]
