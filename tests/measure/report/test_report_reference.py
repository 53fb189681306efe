from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from viewer.measure.report.reference import FIRST_SPP, ReferenceMaker
from viewer.measure.report.store import Store
from viewer.settings import Settings

SIZE = (8, 4)


class Noisy:
    """A bench whose pictures are of radiance 1, with as much noise as their samples let them have."""

    size = SIZE
    settings = Settings(clamp=5.0, seed=7)

    def __init__(self, stop_after: int = 10**9) -> None:
        self.asked: list[tuple[int, int]] = []
        self._stop_after = stop_after

    def trace(self, settings: Settings, report=None) -> np.ndarray:
        if len(self.asked) == self._stop_after:
            raise KeyboardInterrupt
        assert settings.mode == "path" and settings.clamp == 0
        self.asked.append((settings.spp, settings.seed))
        rng = np.random.default_rng(settings.seed)
        return rng.normal(1, settings.spp**-0.5, (SIZE[1], SIZE[0], 4)).astype(np.float32)


def test_parts_double_weigh_by_their_samples_and_have_nothing_in_common(tmp_path):
    bench = Noisy()
    maker = ReferenceMaker(bench, Store(tmp_path), "key")
    for _ in range(4):
        maker.add(maker.next_spp())
    assert [spp for spp, _ in bench.asked] == [n for n in (64, 64, 128, 256) for _ in range(2)]
    assert len({seed for _, seed in bench.asked} | {7}) == 9
    reference = maker.reference()
    assert reference.spp == maker.spp == 1024
    expected = sum(n * bench.trace(SimpleNamespace(mode="path", clamp=0, spp=n, seed=seed))
                   for n, seed in list(bench.asked)) / 1024
    assert np.allclose(reference.linear, expected, atol=1e-6)
    assert np.allclose(reference.halves.mean, reference.linear[..., :3], atol=1e-6)
    mask = np.ones(SIZE[::-1], bool)
    assert reference.floor(mask) == pytest.approx(1 / 1024, rel=0.3)


def test_an_interrupted_one_goes_on_where_it_was(tmp_path):
    first = ReferenceMaker(Noisy(stop_after=3), Store(tmp_path), "key")
    first.add(FIRST_SPP)
    with pytest.raises(KeyboardInterrupt):
        first.add(32)
    bench = Noisy()
    second = ReferenceMaker(bench, Store(tmp_path), "key")
    assert second.spp == 128 and bench.asked == []
    second.add(999)  # the half that is there has 32, so the other gets as many
    assert [spp for spp, _ in bench.asked] == [32] and second.spp == 192
    assert ReferenceMaker(Noisy(), Store(tmp_path), "other key").spp == 0
