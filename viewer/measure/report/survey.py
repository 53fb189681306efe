"""One model measured: every method of the ladder that there is time for, and the reference."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...base.digest import code_digest, digest
from ...base.progress import Progress
from ...errors import InputError, UsageError
from .bench import Bench
from .errors import trimmed_floor, trimmed_relmse
from .ladder import Ladder, LeftOut, Method, ladder
from .patience import is_met_by_pilot, longest, reason_against
from .reference import LEAST_SPP, Reference, ReferenceMaker
from .store import Record, Store
from .timing import of_pictures

RASTER_SHARE, POINTS_SHARE, LONG_SHARE = 0.3, 0.55, 0.75
"""Of the time, what points of the raster may take, all points that are climbed to one by one, and all points; the
reference gets what is left."""
LEAST_SHARE = 0.1
"""What path-traced points get of each kind, however long the raster took to prepare."""
LONG = ("path", "path+oidn", "path+fast")
"""The methods of which a picture is wanted that takes about as long as is ever recommended."""
FLOOR_SHARE = 0.1
"""A reference is good enough when its floor is this share of the best picture's error."""


@dataclass(eq=False)
class Survey:
    """What was measured of a scene; `mask` (H, W) bool tells where the model is."""

    bench: Bench
    rungs: list[tuple[Method, Record]] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    mask: np.ndarray | None = None
    reference: Reference | None = None
    is_whole: bool = False
    """Whether all was measured that there was to be."""

    @property
    def seconds(self) -> float:
        """What all of it has taken, in this run or earlier ones."""
        return sum(record.seconds for _, record in self.rungs) + (self.reference.seconds if self.reference else 0.0)


class Surveyor:
    """Measuring may take `bench.limit` in all, what earlier runs took included."""

    def __init__(self, bench: Bench, store: Store, name: str, progress: Progress, use_cache: bool = True) -> None:
        self._bench, self._store, self._name, self._progress = bench, store, name, progress
        self._limit = bench.limit
        self._key = digest(bench.scene, bench.camera, bench.size, bench.settings, bench.context.renderer, code_digest())
        self._use_cache = use_cache
        self.survey = Survey(bench)

    def run(self) -> None:
        """Fills `survey`, which holds what there is also when this is interrupted.

        Raises InputError where nothing of the model is in the picture.
        """
        survey, bench = self.survey, self._bench
        self._tell("preparing")
        survey.mask = self._coverage()
        steps = ladder(bench.scene, bench.settings, self._use_cache)
        survey.left_out += steps.left_out
        maker = ReferenceMaker(bench, self._store, self._key)
        if maker.spp:
            self._take(maker.reference())
        self._climb(steps)
        self._leap(steps)
        self._converge(maker)
        survey.is_whole = True

    def _tell(self, text: str, more_seconds: float = 0.0) -> None:
        done = (self.survey.seconds + more_seconds) / self._limit
        self._progress.part(min(done, 1.0), f"{self._name}: {text}")

    def _coverage(self) -> np.ndarray:
        kept = self._store.load("coverage", self._key)
        if kept is None:
            mask = self._bench.coverage()
            if not mask.any():
                raise InputError(self._name, "", "nothing of it is in the picture: there is nothing to compare "
                                                 "(lines and points are not path traced)")
            kept = Record(np.repeat(mask[..., None], 4, axis=2).astype(np.float32))
            self._store.save("coverage", self._key, kept)
        return kept.picture[..., 0] > 0

    def _climb(self, steps: Ladder) -> None:
        survey = self.survey
        given_up: set[tuple[str, str]] = set()
        for method in (*steps.raster, *steps.traced):
            if self._store.load(method.slug, self._key) is None:
                if method.family in given_up or is_met_by_pilot(method, survey.rungs):
                    continue
                left = self._left(POINTS_SHARE if method.is_traced else RASTER_SHARE)
                if method.is_traced:
                    left = max(left, LEAST_SHARE * self._limit - self._traced_seconds())
                reason = reason_against(method, survey.rungs, left, of_pictures(self._limit))
                if reason:
                    steps_on = ", and the next steps" if "spp" in method.changes else ""
                    survey.left_out.append(LeftOut(method.label + steps_on, reason))
                    given_up.add(method.family)
                    continue
            try:
                survey.rungs.append((method, self._measured(method)))
            except UsageError as error:  # more samples a pixel than this OpenGL has for so large a picture
                survey.left_out.append(LeftOut(method.label, str(error)))

    def _leap(self, steps: Ladder) -> None:
        """Somebody who has ten seconds is to be told of a picture that takes them: past steps that there is no time
        for, to the most samples that this budget has room for."""
        survey = self.survey
        climbed = self._traced_seconds()
        for name in LONG:
            leapt = self._traced_seconds() - climbed
            left = max(self._left(LONG_SHARE), LEAST_SHARE * self._limit - leapt)
            method = longest([method for method in steps.traced if method.name == name], survey.rungs, left)
            if method is not None:
                survey.rungs.append((method, self._measured(method)))

    def _left(self, share: float) -> float:
        return share * self._limit - sum(record.seconds for _, record in self.survey.rungs)

    def _traced_seconds(self) -> float:
        return sum(record.seconds for method, record in self.survey.rungs if method.is_traced)

    def _measured(self, method: Method) -> Record:
        self._tell(method.label)
        record = self._store.load(method.slug, self._key)
        if record is None:
            record = self._bench.measure(method)
            self._store.save(method.slug, self._key, record)
        return record

    def _converge(self, maker: ReferenceMaker) -> None:
        survey = self.survey
        while True:
            left = self._limit - survey.seconds
            if maker.spp and (left <= 0 or self._is_good_enough()):
                return
            spp = maker.next_spp()
            rate = self._seconds_per_sample(maker)
            if rate:
                spp = min(spp, int(left / (2 * rate)))
            if maker.spp and spp < LEAST_SPP:
                return
            total, seconds = maker.spp, 2 * rate * spp

            def report(done: float, spp: int = spp, total: int = total, seconds: float = seconds) -> None:
                self._tell(f"reference, {total + 2 * done * spp:.0f} samples a pixel", done * seconds)

            maker.add(max(spp, LEAST_SPP), report)
            self._take(maker.reference())

    def _take(self, reference: Reference) -> None:
        """For the truth, where it is finite: light can be more than numbers hold."""
        survey = self.survey
        survey.reference = reference
        survey.mask &= np.isfinite(reference.halves.first + reference.halves.second).all(axis=-1)
        if not survey.mask.any():
            raise InputError(self._name, "", "its light is more than numbers hold: there is nothing to compare with")

    def _is_good_enough(self) -> bool:
        survey = self.survey
        assert survey.reference is not None and survey.mask is not None
        reference, mask = survey.reference, survey.mask
        floor = trimmed_floor(reference.halves, mask)
        best = min(trimmed_relmse(record.picture, reference.linear, mask) for _, record in survey.rungs)
        return floor <= FLOOR_SHARE * best

    def _seconds_per_sample(self, maker: ReferenceMaker) -> float:
        """Of one sample of every pixel, by the reference so far or the longest path-traced picture; 0: not known."""
        if maker.spp:
            return maker.seconds / maker.spp
        rates = [record.facts["time_ms"]["median"] / 1e3 / record.facts["spp"]
                 for method, record in self.survey.rungs if method.name == "path"]
        return rates[-1] if rates else 0.0
