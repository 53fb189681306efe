"""OpenVDB files: what is read of them, against what was written, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from needs import CORPUS, needs, require
from vdb_grids import SHEARED, blosc, load, puff

from assets.vdb import ACTIVE_MASK, BLOSC, ZIP, VdbGrid
from viewer.errors import InputError
from viewer.scene.load import load_scene
from viewer.scene.scene import Scene


def same_density(scene: Scene, grid: VdbGrid) -> None:
    """The volume of `scene` has the values of `grid` in the middle, at the same places, and nothing around them."""
    volume, = scene.volumes
    index = np.argwhere(grid.values)
    low = index.min(axis=0)
    expected = grid.values[tuple(slice(a, b + 1) for a, b in zip(low, index.max(axis=0)))]
    expected = expected.astype(np.float16 if grid.half else np.float32)
    np.testing.assert_array_equal(volume.density, np.pad(expected, 1).transpose(2, 1, 0))
    first = grid.index_to_world @ [*(low + grid.origin), 1]
    np.testing.assert_allclose(volume.index_to_world @ [1, 1, 1, 1], first, rtol=1e-12)
    np.testing.assert_array_equal(volume.index_to_world[:3, :3], grid.index_to_world[:3, :3])


@pytest.mark.parametrize("flags", [0, ZIP, ACTIVE_MASK, ZIP | ACTIVE_MASK, BLOSC, BLOSC | ACTIVE_MASK])
@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("tiles", [False, True])
def test_every_way_to_store_it_gives_the_same_voxels(flags, half, tiles):
    if flags & BLOSC:
        require("vdb")
    grid = VdbGrid("density", puff(), (-5, 4090, 8), SHEARED, half, flags, tiles=tiles,
                   **({"pack": blosc} if flags & BLOSC else {}))
    scene = load(grid)
    same_density(scene, grid)
    told, = scene.facts["grids"]
    held = grid.values.astype(np.float16 if half else np.float32).astype(np.float64)
    assert told == {
        "name": "density", "type": "FloatGrid", "active_voxels": np.count_nonzero(held),
        "index_box": [[-5, 4090, 8], [7, 4107, 16]], "sum": pytest.approx(held.sum(), rel=1e-12),
        "min": held[held > 0].min(), "max": held.max(), "index_to_world": SHEARED.tolist()}
    json.dumps(told, allow_nan=False)


@pytest.mark.parametrize("flags", [ZIP | ACTIVE_MASK, BLOSC | ACTIVE_MASK, BLOSC])
@pytest.mark.parametrize("half", [False, True])
def test_leaves_without_active_voxels(flags, half):
    if flags & BLOSC:
        require("vdb")
    values = puff((24, 8, 8))
    values[8:16] = 0
    grid = VdbGrid("density", values, half=half, flags=flags, empty_leaves=True,
                   **({"pack": blosc} if flags & BLOSC else {}))
    same_density(load(grid), grid)


@pytest.mark.parametrize("version", [222, 223, 224, 225])
def test_versions(version):
    same_density(load(VdbGrid("density", puff()), version=version), VdbGrid("density", puff()))


@pytest.mark.parametrize("kind, numbers, matrix", [
    ("ScaleMap", [2, 3, 4, *[9] * 12], np.diag([2, 3, 4, 1])),
    ("UniformScaleMap", [2, 2, 2, *[9] * 12], np.diag([2, 2, 2, 1])),
    ("TranslationMap", [5, 6, 7], [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]),
    ("ScaleTranslateMap", [5, 6, 7, 2, 3, 4, *[9] * 12], [[2, 0, 0, 5], [0, 3, 0, 6], [0, 0, 4, 7], [0, 0, 0, 1]]),
    ("UniformScaleTranslateMap", [5, 6, 7, 2, 2, 2, *[9] * 12],
     [[2, 0, 0, 5], [0, 2, 0, 6], [0, 0, 2, 7], [0, 0, 0, 1]])])
def test_transforms(kind, numbers, matrix):
    grid = VdbGrid("density", puff(), transform=(kind, np.array(numbers, "<f8").tobytes()))
    assert load(grid).facts["grids"][0]["index_to_world"] == np.array(matrix).tolist()


@pytest.mark.parametrize("kind, values", [(1, 0), (2, 1), (3, 0), (4, 1), (5, 2)])
@pytest.mark.parametrize("half", [False, True])
def test_inactive_values_are_passed_over(kind, values, half):
    """They are float32 in a file of half floats, too, which python3-openvdb's files show."""
    begin = bytes([kind]) + b"\xff" * (4 * values + 64 * (kind > 2))
    grid = VdbGrid("density", puff(), half=half, inactive=begin)
    same_density(load(grid), grid)


def test_colours_and_other_grids_are_told_and_not_drawn():
    colour = np.stack([puff(), 2 * puff(), 3 * puff()], axis=-1)
    scene = load(VdbGrid("Cd", colour, fog=b""), VdbGrid("temperature", -5 * puff(seed=1)), VdbGrid("density", puff()))
    same_density(scene, VdbGrid("density", puff()))
    names = [(grid["name"], grid["type"], grid["active_voxels"]) for grid in scene.facts["grids"]]
    assert names == [("Cd", "Vec3SGrid", np.count_nonzero(puff())), ("temperature", "FloatGrid", np.count_nonzero(
        puff(seed=1))), ("density", "FloatGrid", np.count_nonzero(puff()))]
    assert scene.facts["grids"][0]["sum"] == pytest.approx(colour.sum(dtype=float), rel=1e-12)
    assert scene.facts["grids"][1]["min"] == pytest.approx(-5 * puff(seed=1).max())
    assert scene.warnings == ("only the grid 'density' is drawn, without 'Cd', 'temperature'",)


def test_without_a_density_the_first_fog_is_drawn():
    scene = load(VdbGrid("heat", puff(seed=1), fog=b"unknown"), VdbGrid("smoke", puff()))
    same_density(scene, VdbGrid("smoke", puff()))
    assert scene.warnings[0] == "there is no grid 'density'; 'smoke' is taken for it"
    same_density(load(VdbGrid("heat", puff(seed=1), fog=b"unknown")), VdbGrid("heat", puff(seed=1)))


def test_numbers_that_json_has_not_are_left_out():
    values = puff((48, 48, 48))
    values[0, 1, 1] = np.nan  # leaves of another batch follow
    told = load(VdbGrid("flame", values), VdbGrid("density", puff())).facts["grids"][0]
    assert told["sum"] is None and told["min"] is None and told["max"] is None


def test_a_grid_without_voxels_draws_nothing():
    scene = load(VdbGrid("density", np.zeros((8, 8, 8), np.float32)))
    assert not scene.volumes and scene.warnings == ("grid 'density' has no active voxels: there is nothing to draw",)
    told = scene.facts["grids"][0]
    assert (told["active_voxels"], told["index_box"], told["sum"], told["min"]) == (0, None, 0, None)


def test_a_background_is_said():
    scene = load(VdbGrid("density", puff(), background=0.25))
    assert scene.warnings == ("grid 'density' has the background 0.25, which fills all space; it is not drawn",)


def test_an_instance_shares_a_tree_and_has_a_transform_of_its_own():
    source = VdbGrid("other", puff(), half=True)
    copy = VdbGrid("density", puff(), index_to_world=SHEARED, half=True, parent="other")
    scene = load(source, copy)
    same_density(scene, copy)
    one, two = scene.facts["grids"]
    assert (one["name"], two["name"]) == ("other", "density") and one["active_voxels"] == two["active_voxels"] > 0
    assert one["index_to_world"] == np.eye(4).tolist() and two["index_to_world"] == SHEARED.tolist()
    with pytest.raises(InputError, match="is an instance of 'other', which does not stand before it"):
        load(copy, source)


@pytest.mark.parametrize("name, voxels", [("cloud", 120383), ("smoke", 42385)])
def test_the_projects_own_volumes(name, voxels):
    """OpenVDB 10 counts as many voxels."""
    path = Path(__file__).parents[2] / "assets" / "volumes" / f"{name}.vdb"
    scene = load_scene(path)
    assert scene.facts["grids"][0]["active_voxels"] == voxels and not scene.warnings
    assert scene.volumes[0].maximum == 1 and path.stat().st_size < 300_000


@needs("corpus", "vdb")
def test_files_of_others():
    """Their numbers are those of OpenVDB 10. It had the half floats of one file before they were rounded."""
    folder = CORPUS / "volumes"
    expected = json.loads((folder / "VOLUMES.json").read_text())
    for file, grids in expected.items():
        told = load_scene(folder / file).facts["grids"]
        assert [grid["name"] for grid in told] == [grid["grid"] for grid in grids]
        rounding = 2.0**-11 if file.startswith("half") else 1e-12
        for found, grid in zip(told, grids):
            for key in ("type", "active_voxels", "index_box"):
                assert found[key] == grid[key], (file, key)
            for key in ("sum", "min", "max"):
                assert (grid[key] is None and found[key] is None) or \
                    found[key] == pytest.approx(grid[key], rel=rounding), (file, key)
            matrix = np.array(found["index_to_world"])
            np.testing.assert_allclose(matrix[:3, :3].T, grid["index_to_world_axes"], atol=1e-12)
            np.testing.assert_allclose(matrix[:3, 3], grid["index_to_world_origin"], atol=1e-12)
    smoke, = load_scene(folder / "smoke.vdb").facts["grids"]
    assert smoke["active_voxels"] == 1049275 and smoke["sum"] == pytest.approx(171499.695, abs=1e-3)
    for file, problem in (("level_set_sphere.vdb", "level set"), ("point_grid.vdb", "points")):
        with pytest.raises(InputError, match=problem):
            load_scene(folder / file)
