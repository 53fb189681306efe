"""A few pictures by other drivers than the one that all other tests use. docs/drivers.md has what has run where."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from drivers import DRIVERS, REFERENCE, Driver, Run, differences
from needs import require, skip
from path_classes import COUNT

from viewer.gpu.probe import probe

SHORT = [driver for driver in DRIVERS if driver.short]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, object]]:
    """What each driver draws; they draw at the same time."""
    require("linux")
    if "llvmpipe" not in probe("egl").get("renderer", ""):
        skip("llvmpipe")
    folder = tmp_path_factory.mktemp("drivers")
    started = [Run.start(REFERENCE, folder, sorted({name for driver in SHORT for name in driver.short})),
               *(Run.start(driver, folder, driver.short) for driver in SHORT)]
    yield {run.driver.name: run.result() for run in started}


@pytest.mark.parametrize("driver", [REFERENCE, *SHORT], ids=lambda driver: driver.name)
def test_classes_of_paths_survive_as_depths(runs, driver: Driver):
    told = runs[driver.name]
    if isinstance(told, str):
        skip(driver.need)  # the test of pictures tells whether it is there, and fails
    assert told["classes"] == [0] * COUNT


def test_the_depths_of_classes_are_exact():
    """In float32: as written, as a vertex's z between -1 and 1, and mapped back to 0 to 1."""
    numbers = np.arange(COUNT, dtype=np.float32)
    written = numbers / np.float32(16)
    vertex = written * np.float32(2) - np.float32(1)
    np.testing.assert_array_equal(vertex * np.float32(0.5) + np.float32(0.5), written)
    np.testing.assert_array_equal(written.astype(float) * 16, np.arange(COUNT))
    assert len(set(written.tolist())) == COUNT and written.max() < 1


@pytest.mark.parametrize("driver", SHORT, ids=lambda driver: driver.name)
def test_pictures_are_those_of_llvmpipe(runs, driver: Driver):
    told, reference = runs[driver.name], runs[REFERENCE.name]
    assert not isinstance(reference, str), reference
    found = told if isinstance(told, str) else told["renderer"]
    if driver.need != "llvmpipe" and driver.renderer not in found:
        skip(driver.need)  # it is not installed; where it is, a picture that fails is no reason to skip
    assert not isinstance(told, str), told
    assert driver.renderer in told["renderer"] and told["is_reversed"] == driver.is_reversed
    assert not told["errors"] and told["pictures"]
    assert all(np.isfinite(linear).all() for linear, _ in told["pictures"].values())
    distances = differences(told, reference)
    assert max(distances.values()) <= driver.bound, distances
