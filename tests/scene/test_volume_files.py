"""Volume files of other formats than OpenVDB's: numpy's .npz and Mitsuba's .vol."""

from __future__ import annotations

import io
import json
import struct
import zipfile

import numpy as np
import pytest
from byte_mutations import mutations
from click.testing import CliRunner
from needs import SHARED, needs

from viewer.cli import cli
from viewer.errors import InputError, UsageError
from viewer.scene.load import load_scene
from viewer.scene.volume import Volume

BOX = [[-1.5, -0.75, -1.0], [1.5, 0.95, 1.2]]
DENSITY = np.random.default_rng(0).random((3, 5, 4)).astype(np.float32)


def npz(path, compressed: bool = True, **arrays):
    values = {"density": DENSITY, "bbox": np.array(BOX), "axes": "zyx"} | arrays
    values = {name: array for name, array in values.items() if array is not None}
    (np.savez_compressed if compressed else np.savez)(path, **values)
    return path


def vol(path, kind=1, version=3, shape=(4, 5, 3), channels=1, box=BOX, values=DENSITY):
    head = b"VOL" + struct.pack("<B5i6f", version, kind, *shape, channels, *np.ravel(box))
    path.write_bytes(head + np.asarray(values, "<f4").tobytes())
    return path


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("arrays, held", [
    ({}, np.float32), ({"axes": None}, np.float32), ({"density": DENSITY.astype(np.float64)}, np.float32),
    ({"density": DENSITY.astype(">f4")}, np.float32), ({"density": np.asfortranarray(DENSITY)}, np.float32),
    ({"density": DENSITY.transpose(2, 1, 0), "axes": "xyz"}, np.float32),
    ({"density": np.ascontiguousarray(DENSITY.transpose(2, 1, 0)), "axes": "xyz"}, np.float32),
    ({"density": DENSITY.astype(np.float16)}, np.float16), ({"other": np.zeros(3)}, np.float32)])
def test_npz(tmp_path, arrays, held, compressed):
    scene = load_scene(npz(tmp_path / "cloud.npz", compressed, **arrays))
    volume, = scene.volumes
    assert volume.density.dtype == held and volume.density.flags.c_contiguous
    np.testing.assert_array_equal(volume.density, DENSITY.astype(held))
    np.testing.assert_allclose(scene.bounds, BOX, rtol=1e-12)


def test_vol_is_the_same_grid(tmp_path):
    one, two = load_scene(vol(tmp_path / "cloud.vol")), load_scene(npz(tmp_path / "cloud.npz"))
    np.testing.assert_array_equal(one.volumes[0].density, two.volumes[0].density)
    np.testing.assert_allclose(one.volumes[0].index_to_world, two.volumes[0].index_to_world, rtol=1e-6)
    told, = one.facts["grids"]
    assert told == {
        "name": "density", "type": "float32", "active_voxels": 60, "index_box": [[0, 0, 0], [3, 4, 2]],
        "sum": pytest.approx(DENSITY.sum(dtype=float)), "min": DENSITY.min(), "max": DENSITY.max(),
        "index_to_world": one.volumes[0].index_to_world.tolist()}


def test_the_content_tells_a_vol_and_not_its_name(tmp_path):
    assert load_scene(vol(tmp_path / "cloud")).facts["format"] == "VOL"


def test_a_vol_that_is_written_is_read_again(tmp_path):
    box = np.float32([[-1.1, 2.2, 3.3], [4.7, 5.3, 6.1]])
    volume = Volume.in_box(DENSITY.astype(np.float16), box)
    volume.save(tmp_path / "a.vol")
    found = load_scene(tmp_path / "a.vol").volumes[0]
    np.testing.assert_array_equal(found.density, volume.density)
    np.testing.assert_allclose(found.index_to_world, volume.index_to_world, rtol=1e-6, atol=1e-6)
    data = (tmp_path / "a.vol").read_bytes()
    assert data[:4] == b"VOL\x03" and struct.unpack_from("<5i", data, 4) == (1, 4, 5, 3, 1)
    np.testing.assert_array_equal(np.frombuffer(data, "<f4", 6, 24), box.ravel())
    assert struct.unpack_from("<f", data, 48 + 4 * (1 + 4 * 2)) == (volume.density[0, 2, 1],)


@pytest.mark.parametrize("matrix", [np.diag([1.0, -1, 1, 1]), np.eye(4)[[1, 0, 2, 3]]])
def test_a_turned_box_is_not_written(tmp_path, matrix):
    with pytest.raises(UsageError, match="a.vol: the box of <Volume 'a': .*> is turned"):
        Volume("a", DENSITY, matrix).save(tmp_path / "a.vol")
    with pytest.raises(UsageError, match="path is of type int, not a path"):
        Volume("a", DENSITY, np.eye(4)).save(3)
    with pytest.raises(UsageError, match="a.vdb: a volume is saved as .vol"):
        Volume("a", DENSITY, np.eye(4)).save(tmp_path / "a.vdb")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("changes, problem", [
    ({"version": 4}, "has version 4 and values of type 1"), ({"kind": 3}, "and values of type 3"),
    ({"channels": 3}, "has 3 numbers in each voxel"), ({"shape": (4, 0, 3)}, "has 4 x 0 x 3 voxels"),
    ({"shape": (4, 5, -3)}, "has 4 x 5 x -3 voxels"), ({"shape": (4, 5, 4)}, "take 320 bytes, but the file has 240"),
    ({"shape": (4, 5, 2)}, "take 160 bytes, but the file has 240"),
    ({"shape": (1 << 13, 1 << 13, 1 << 13)}, "8,192 x 8,192 x 8,192 voxels is too large"),
    ({"shape": (2**31 - 1,) * 3}, "is too large"),
    ({"box": BOX[::-1]}, "has no volume"), ({"box": [[0, 0, 0], [1, 1, np.nan]]}, "NaN"),
    ({"values": np.where(DENSITY[2, 1, 3] == DENSITY, -1, DENSITY)}, "density: voxel (3, 1, 2): -1 is not a finite"),
    ({"values": np.where(DENSITY[2, 1, 3] == DENSITY, np.nan, DENSITY)}, "density: voxel (3, 1, 2): nan is not"),
    ({"values": DENSITY * np.float32(np.inf)}, "density: voxel (0, 0, 0): inf is not a finite")])
def test_a_vol_that_cannot_be_used(tmp_path, changes, problem):
    with pytest.raises(InputError) as error:
        load_scene(vol(tmp_path / "bad.vol", **changes))
    assert str(error.value).startswith(f"{tmp_path / 'bad.vol'}: ") and problem in str(error.value)


@pytest.mark.parametrize("arrays, problem", [
    ({"density": None}, "has no array 'density'"), ({"bbox": None}, "has no array 'bbox'"),
    ({"bbox": np.zeros(6)}, "bbox: has the shape (6,)"), ({"bbox": np.array(BOX)[::-1]}, "has no volume"),
    ({"bbox": [[0, 0, 0], [0, 1, 1]]}, "bbox: [0.0, 0.0, 0.0] to [0.0, 1.0, 1.0] has no volume"),
    ({"bbox": [[0, 0, 0], [1, np.inf, 1]]}, "bbox: [0.0, 0.0, 0.0] to [1.0, inf, 1.0]: a corner is infinite or NaN"),
    ({"bbox": [[0, 0, 0], [1e30, 1, 1]]}, "bbox: [0.0, 0.0, 0.0] to [1e+30, 1.0, 1.0]: has coordinates beyond 1e+18"),
    ({"density": DENSITY[0]}, "density: has the shape (5, 4)"), ({"density": DENSITY[:0]}, "density: has the shape"),
    ({"density": DENSITY.astype(complex)}, "density: holds complex128, not numbers"),
    ({"density": np.full((2, 2, 2), "x")}, "density: holds <U1, not numbers"),
    ({"density": np.full((2, 2, 2), None)}, "density: holds object, not numbers"),
    ({"axes": "yxz"}, "axes: 'yxz', not 'zyx' or 'xyz'"), ({"axes": 3}, "axes: holds int64, not a word"),
    ({"density": np.where(DENSITY[2, 1, 3] == DENSITY, -1, DENSITY)}, "density: voxel (3, 1, 2): -1 is not"),
    ({"density": np.full((2, 2, 2), 1e300)}, "density: voxel (0, 0, 0): inf is not")])
def test_an_npz_that_cannot_be_used(tmp_path, arrays, problem):
    with pytest.raises(InputError) as error:
        load_scene(npz(tmp_path / "bad.npz", **arrays))
    assert str(error.value).startswith(f"{tmp_path / 'bad.npz'}: ") and problem in str(error.value)


def zipped(path, **members: bytes):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return path


def npy(array, shape=None, version=1) -> bytes:
    """An array that says it has another shape."""
    file = io.BytesIO()
    np.save(file, array)
    data = file.getvalue()
    if shape is not None:
        head = f"{{'descr': '{array.dtype.str}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
        data = data[:8] + struct.pack("<H", len(head)) + head.encode() + array.tobytes()
    return data[:6] + bytes([version]) + data[7:]


@pytest.mark.parametrize("density, problem", [
    (npy(DENSITY, (1 << 14, 1 << 14, 1 << 13)), "a box of 8,192 x 16,384 x 16,384 voxels is too large"),
    (npy(DENSITY, (3, 5, 5)), "density: ends before its 75 values do"),
    (npy(DENSITY, (3, 5, 3)), "density: has more than the 45 values that it names"),
    (npy(DENSITY, (3, 5, -4)), "density: has the shape (3, 5, -4)"),
    (npy(DENSITY, "__import__('os')"), "density: has a broken header"),
    (npy(DENSITY, "(3, 5, 4\0"), "density: has a broken header"),
    (npy(DENSITY, "(" * 60), "density: has a broken header"),
    (npy(DENSITY, version=2), "has a header that is not version 1.0"),
    (npy(DENSITY)[:60], "density: has a broken header"), (b"", "is no .npz file, or a broken one"),
    (bytes(1 << 24), "is no .npz file, or a broken one")])
def test_an_archive_that_lies(tmp_path, density, problem):
    with pytest.raises(InputError) as error:
        load_scene(zipped(tmp_path / "bad.npz", density=density, bbox=npy(np.array(BOX))))
    assert problem in str(error.value)


def test_a_name_with_the_wrong_content(tmp_path):
    for ending, problem in (("npz", "is no .npz file"), ("vdb", "ends before its content does"),
                            ("vol", "the file ends in its header")):
        (tmp_path / f"bad.{ending}").write_bytes(b"hello")
        with pytest.raises(InputError, match=problem):
            load_scene(tmp_path / f"bad.{ending}")


def test_broken_data_does_no_harm(tmp_path):
    """A sample of what 10,000 mutations of each were tried for."""
    refused = 0
    for path in (npz(tmp_path / "a.npz"), npz(tmp_path / "b.npz", compressed=False), vol(tmp_path / "c.vol")):
        for broken in mutations(path.read_bytes(), 60):
            path.write_bytes(broken)
            try:
                load_scene(path)
            except InputError:
                refused += 1
    assert refused > 90


def test_info_lists_the_grids(tmp_path):
    result = CliRunner().invoke(cli, ["info", str(vol(tmp_path / "cloud.vol")), "--json", "-"], catch_exceptions=False)
    told = json.loads(result.stdout)
    assert [grid["name"] for grid in told["grids"]] == ["density"] and told["bounds_m"][1][1] == pytest.approx(0.95)
    text = CliRunner().invoke(cli, ["info", str(tmp_path / "cloud.vol")], catch_exceptions=False).stdout
    assert "name density, type float32, active_voxels 60" in text


@needs("truth")
def test_the_grids_of_other_renderers_are_the_same_in_both_formats():
    for name, shape in (("cloud/cloud", (42, 32, 56)), ("smoke-absorbing/smoke", (38, 54, 34))):
        one, two = (load_scene(SHARED / "truth" / f"{name}.{ending}") for ending in ("npz", "vol"))
        assert one.volumes[0].density.shape == shape
        np.testing.assert_array_equal(one.volumes[0].density, two.volumes[0].density)
        np.testing.assert_allclose(one.bounds, two.bounds, rtol=1e-6)
