"""Measures one model: every method of the ladder that there is time for, and the reference."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...base.digest import code_digest, digest
from ...base.progress import Progress
from ...errors import InputError, UsageError
from .bench import Bench
from .errors import trimmed_floor, trimmed_relmse
from .ladder import Ladder, LeftOut, Method, ladder
from .reference import LEAST_SPP, Reference, ReferenceMaker
from .store import Record, Store
from .time_limit import Measured, ends_before_adapting, longest, reason_against
from .timing import picture_effort

RASTER_SHARE, LADDER_SHARE, METHODS_SHARE = 0.3, 0.55, 0.75
"""Shares of the time for the raster's methods, for all methods in the order of the ladder, and for these and the long
pictures. The reference gets the rest."""
LEAST_SHARE = 0.1
"""What path tracing gets for its part of the ladder, and again for long pictures, even if the raster took longer."""
LONG = ("path", "path+raster", "path+oidn", "path+fast")
"""Methods of which a long picture is rendered: one that takes about the longest time of the recommendations."""
FLOOR_SHARE = 0.1
"""A reference is good enough when its floor is this share of the best picture's error."""


@dataclass(eq=False)
class Survey:
    """What was measured of a scene; `mask` (H, W) bool is true where the model is."""

    bench: Bench
    measured: list[Measured] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    mask: np.ndarray | None = None
    reference: Reference | None = None
    is_whole: bool = False
    """Whether it was not interrupted."""

    @property
    def seconds(self) -> float:
        """What measuring took, in this run and in earlier ones whose results were kept."""
        return sum(record.seconds for _, record in self.measured) + (self.reference.seconds if self.reference else 0.0)


class Surveyor:
    """Measuring may take `bench.limit` seconds, those of earlier runs included."""

    def __init__(self, bench: Bench, store: Store, name: str, progress: Progress, use_cache: bool) -> None:
        self._bench, self._store, self._name, self._progress = bench, store, name, progress
        self._limit = bench.limit
        self._key = digest(bench.scene, bench.camera, bench.size, bench.settings, bench.context.renderer, code_digest())
        self._use_cache = use_cache
        self.survey = Survey(bench)

    def run(self) -> None:
        """Fills `survey`; if this is interrupted, it holds what was measured before.

        Raises InputError where nothing of the model is in the picture.
        """
        survey, bench = self.survey, self._bench
        self._tell("preparing")
        survey.mask = self._coverage()
        methods = ladder(bench.scene, bench.settings, self._use_cache)
        survey.left_out += methods.left_out
        maker = ReferenceMaker(bench, self._store, self._key)
        if maker.spp:
            self._take(maker.reference())
        self._measure_ladder(methods)
        self._measure_long_pictures(methods)
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

    def _measure_ladder(self, methods: Ladder) -> None:
        """Each method in turn; once one of a family takes too long, the others are left out."""
        survey = self.survey
        given_up: set[tuple[str, str]] = set()
        for method in (*methods.raster, *methods.traced):
            if self._store.load(method.slug, self._key) is None:
                if method.family in given_up or ends_before_adapting(method, survey.measured):
                    continue
                left = self._left(LADDER_SHARE if method.is_traced else RASTER_SHARE)
                if method.is_traced:
                    left = max(left, LEAST_SHARE * self._limit - self._traced_seconds())
                reason = reason_against(method, survey.measured, left, picture_effort(self._limit))
                if reason:
                    and_more = ", and more samples" if "spp" in method.changes else ""
                    survey.left_out.append(LeftOut(method.label + and_more, reason))
                    given_up.add(method.family)
                    continue
            try:
                survey.measured.append((method, self._measured(method)))
            except UsageError as error:  # more samples a pixel than this OpenGL has for so large a picture
                survey.left_out.append(LeftOut(method.label, str(error)))

    def _measure_long_pictures(self, methods: Ladder) -> None:
        """One picture each that takes about as long as the longest recommendation, for who has that time.

        The ladder may have ended long before, since it takes every number of samples in turn."""
        survey = self.survey
        before = self._traced_seconds()
        for name in LONG:
            spent = self._traced_seconds() - before
            left = max(self._left(METHODS_SHARE), LEAST_SHARE * self._limit - spent)
            method = longest([method for method in methods.traced if method.name == name], survey.measured, left)
            if method is not None:
                survey.measured.append((method, self._measured(method)))

    def _left(self, share: float) -> float:
        return share * self._limit - sum(record.seconds for _, record in self.survey.measured)

    def _traced_seconds(self) -> float:
        return sum(record.seconds for method, record in self.survey.measured if method.is_traced)

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
        """Compare with this reference from now on, where it is finite: radiance may exceed what float32 holds."""
        survey = self.survey
        survey.reference = reference
        survey.mask &= np.isfinite(reference.halves.first + reference.halves.second).all(axis=-1)
        if not survey.mask.any():
            raise InputError(self._name, "", "its radiance exceeds what float32 holds: nothing can be compared")

    def _is_good_enough(self) -> bool:
        survey = self.survey
        assert survey.reference is not None and survey.mask is not None
        reference, mask = survey.reference, survey.mask
        floor = trimmed_floor(reference.halves, mask)
        best = min(trimmed_relmse(record.picture, reference.linear, mask) for _, record in survey.measured)
        return floor <= FLOOR_SHARE * best

    def _seconds_per_sample(self, maker: ReferenceMaker) -> float:
        """For one sample of every pixel, from the reference so far or the longest path-traced picture; 0: unknown."""
        if maker.spp:
            return maker.seconds / maker.spp
        rates = [record.facts["time_ms"]["median"] / 1e3 / record.facts["spp"]
                 for method, record in self.survey.measured if method.name == "path"]
        return rates[-1] if rates else 0.0
