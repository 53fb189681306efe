"""The curve files of assets/curves are what assets/make_curves.py makes."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from viewer.base.resources import resource_folder
from viewer.scene.load import load_scene

ASSETS = resource_folder("assets")


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_curves", ASSETS / "make_curves.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_no_other_files(maker: ModuleType) -> None:
    assert {path.name for path in (ASSETS / "curves").iterdir()} == set(maker.FILES)


NAMES = ["fur.curves", "lock.hair", "knit.bcc", "woven.hair"]


@pytest.mark.parametrize("name, strands, points", [
    ("fur.curves", 440, 6), ("lock.hair", 220, 24), ("knit.bcc", 6, 153), ("woven.hair", 24, 73)])
def test_a_file_is_what_the_script_makes(maker: ModuleType, name: str, strands: int, points: int) -> None:
    """Up to the rounding of each: a sine may differ in its last bit between machines."""
    path = ASSETS / "curves" / name
    scene = load_scene(path)
    curves, = scene.curves
    made = maker.FILES[name][0]()
    assert made.shape[:2] == (strands, points) and path.stat().st_size < 100_000
    assert curves.lengths.tolist() == [points] * strands and (curves.colors is None) == (made.shape[2] == 4)
    np.testing.assert_allclose(curves.points, made[..., :3].reshape(-1, 3), rtol=0, atol=5.01e-6)
    if name.endswith(".bcc"):  # without radii: half the distance of points, which is about the radius
        np.testing.assert_allclose(curves.radii, made[..., 3].ravel(), rtol=0.05)
        assert len(scene.warnings) == 1
        return
    np.testing.assert_allclose(curves.radii, made[..., 3].ravel(), rtol=0, atol=5.01e-7)
    assert not scene.warnings
    if curves.colors is not None:
        np.testing.assert_allclose(curves.colors, made[..., 4:].reshape(-1, 3), rtol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_what_the_script_writes_is_read_as_the_file(maker: ModuleType, tmp_path: Path, name: str) -> None:
    make, written = maker.FILES[name]
    (tmp_path / name).write_bytes(written(make()))
    (ours,), (shipped,) = (load_scene(folder / name).curves for folder in (tmp_path, ASSETS / "curves"))
    assert ours.offsets.tolist() == shipped.offsets.tolist()
    np.testing.assert_allclose(ours.points, shipped.points, rtol=0, atol=1.01e-5)
    np.testing.assert_allclose(ours.radii, shipped.radii, rtol=0, atol=1.01e-6)
