"""What is kept of a device."""

from __future__ import annotations

import json

import pytest
from test_choice import CALIBRATION

from viewer.bake import cache
from viewer.budget import calibration as module
from viewer.budget.calibration import Calibration, load_calibration, store_calibration


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(tmp_path))
    return tmp_path


def test_what_is_kept_is_found_again_for_the_same_device_alone():
    assert load_calibration("a") is None
    store_calibration("a", CALIBRATION)
    assert load_calibration("a") == CALIBRATION
    assert load_calibration("b") is None


def test_another_number_of_processors_is_another_device(monkeypatch):
    store_calibration("a", CALIBRATION)
    monkeypatch.setattr(module.os, "cpu_count", lambda: 999)
    assert load_calibration("a") is None


def test_a_damaged_file_counts_as_none(folder):
    store_calibration("a", CALIBRATION)
    (path,) = folder.iterdir()
    path.write_bytes(path.read_bytes()[:-3] + b"xyz")
    assert load_calibration("a") is None


@pytest.mark.parametrize("change", [
    {"raster": []}, {"start": {}}, {"traced": {}}, {"start": {"raster": "a", "path": 1}}])
def test_content_that_is_none_counts_as_none(change):
    store_calibration("a", CALIBRATION)
    content = CALIBRATION.to_json() | change
    with pytest.raises((KeyError, TypeError, ValueError)):
        Calibration.from_json(content)
    text = json.dumps(content).encode()
    cache.store(module._key("a"), {"calibration": module.np.frombuffer(text, module.np.uint8)})
    assert load_calibration("a") is None


def test_filtering_is_interpolated_and_leaves_no_error_as_it_is():
    traced = CALIBRATION.traced
    assert traced.factor(0.8) == traced.factor(2.0) == 0.5
    assert traced.factor(0.2) == pytest.approx(0.7)
    assert traced.factor(0.0) == 1.0
