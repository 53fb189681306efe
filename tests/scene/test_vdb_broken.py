"""OpenVDB files that are broken, lie, or hold what is not drawn: each is refused in one line."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from byte_mutations import mutations
from needs import needs
from vdb_grids import blosc, load, puff

from assets.vdb import ACTIVE_MASK, BLOSC, ZIP, VdbGrid, vdb_bytes
from viewer.base.apart import apart
from viewer.errors import InputError
from viewer.scene.vdb.load import load_vdb
from viewer.scene.vdb.tree import read_tree


def said(name: str, kind: str, value: bytes) -> VdbGrid:
    return VdbGrid("density", puff(), metadata={name: (kind, value)})


@pytest.mark.parametrize("grid, problem", [
    (VdbGrid("ball", puff(), fog=b"level set"), "has no grid of densities: 'ball' is a level set, the distance to a"),
    (VdbGrid("Cd", np.stack([puff()] * 3, axis=-1)), "'Cd' has 3 numbers in each voxel; a density is one"),
    (VdbGrid("density", -puff()), "grid 'density': voxel (0, 0, 0): -0.5 is not a finite number from 0 up"),
    (VdbGrid("density", np.where(puff() == 0.5, np.inf, puff()), (5, 6, 7)), "voxel (5, 6, 7): inf is not a finite"),
    (VdbGrid("density", np.where(puff() == 0.5, np.nan, puff()), tiles=True), "voxel (0, 0, 0): nan is not a finite"),
    (said("file_voxel_count", "int64", struct.pack("<q", 7)), "active voxels, but says that it has 7"),
    (said("file_bbox_min", "vec3i", struct.pack("<3i", 0, 0, 1)), None),
    (VdbGrid("density", puff(), index_to_world=np.diag([1, 0, 1, 1])), "it makes the grid flat"),
    (VdbGrid("density", puff(), index_to_world=np.diag([1, np.nan, 1, 1])), "numbers that are not finite"),
    (VdbGrid("density", puff(), flags=8), "its compression 8 is unknown"),
], ids=str.split("level-set colour negative infinite nan-tile count box-half-told flat nan-transform flags"))
def test_what_is_wrong_is_said_in_one_line(grid, problem):
    if problem is None:
        load(grid)
        return
    with pytest.raises(InputError) as error:
        load(grid)
    assert problem in str(error.value) and str(error.value).startswith("some.vdb: ")


def test_a_box_that_differs_from_what_the_file_says():
    low, high = struct.pack("<3i", 0, 0, 0), struct.pack("<3i", 1, 1, 1)
    box = {"file_bbox_min": ("vec3i", low), "file_bbox_max": ("vec3i", high)}
    with pytest.raises(InputError, match=r"in the box \[\[0, 0, 0\], \[12, 17, 8\]\], but it says in"):
        load(VdbGrid("density", puff(), metadata=box))


def test_instances_do_not_read_a_tree_again(monkeypatch):
    """A file of 1 MB could have thousands of them, each of a tree that takes 0.1 s."""
    read = []
    monkeypatch.setattr("viewer.scene.vdb.voxels.read_tree", lambda *args: read.append(args) or read_tree(*args))
    source = VdbGrid("density", puff())
    scene = load(source, *[VdbGrid(f"copy {k}", source.values, parent="density") for k in range(20)])
    assert len(scene.facts["grids"]) == 21 and len(read) == 1


def test_too_many_grids():
    data = vdb_bytes([]).replace(struct.pack("<2I", 0, 0), struct.pack("<2I", 0, 1025))
    with pytest.raises(InputError, match="has 1025 grids; at most 1024 are read"):
        load_vdb(Path("some.vdb"), data)


def patched(grid: VdbGrid, old: bytes, new: bytes) -> bytes:
    data = vdb_bytes([grid])
    assert data.count(old) == 1
    return data.replace(old, new)


POINTS = patched(VdbGrid("points", puff()), b"Tree_float_5_4_3", b"Tree_ptdataidx32")
BOOLS = patched(VdbGrid("mask", puff()), b"Tree_float_5_4_3", b"Tree_boolx_5_4_3")
FRUSTUM = patched(VdbGrid("view", puff()), b"AffineMap", b"FrustuMap")


@pytest.mark.parametrize("data, problem", [
    (POINTS, "'points' holds points"), (BOOLS, "'mask' is of the type Tree_boolx_5_4_3, which is not read"),
    (FRUSTUM, "'view' has a transform that is not linear"), (vdb_bytes([]), "there are no grids"),
    (vdb_bytes([], version=221), "has version 221 of OpenVDB's format; 222 to 225 are read"),
    (vdb_bytes([VdbGrid("a", puff()), VdbGrid("a", puff())]), "two grids have this name"),
    (vdb_bytes([]).replace(struct.pack("<IIB", 10, 0, 1), struct.pack("<IIB", 10, 0, 0)), "was written as a stream"),
])
def test_what_is_not_read_is_said(data, problem):
    with pytest.raises(InputError) as error:
        load_vdb(Path("some.vdb"), data)
    assert problem in str(error.value)


def test_a_file_that_is_cut_off():
    data = vdb_bytes([VdbGrid("density", puff())])
    for length in [*range(8, 400, 7), *range(400, len(data), 997), len(data) - 1]:
        with pytest.raises(InputError):
            load_vdb(Path("some.vdb"), data[:length])


def test_a_box_of_two_terabytes_is_not_made():
    wide = VdbGrid("density", puff(), more=[((9000, -9000, 5000), puff())])
    with pytest.raises(InputError, match="a box of 9,015 x 9,020 x 5,011 voxels is too large: at most 268,435,456"):
        load(wide)


def upper_node(data: bytes) -> int:
    """Where the only child of the root begins, behind its place."""
    return data.index(struct.pack("<If2I", 1, 0, 0, 1)) + 28


def test_a_node_that_begins_between_two_is_refused():
    data = vdb_bytes([VdbGrid("density", puff())])
    start = upper_node(data)
    with pytest.raises(InputError, match=r"a node begins at \[7, 0, 0\], not at multiples of 4096"):
        load_vdb(Path("some.vdb"), data[:start - 12] + struct.pack("<3i", 7, 0, 0) + data[start:])


def test_tiles_that_would_fill_the_memory_are_not_made():
    data = vdb_bytes([VdbGrid("density", puff(), flags=ACTIVE_MASK)])
    start = upper_node(data)
    tiles = np.full(1 << 15, True)
    tiles[0] = False  # there is the child
    values = np.ones(tiles.sum(), "<f4").tobytes()
    masks = data[start:start + 4096] + np.packbits(tiles, bitorder="little").tobytes()
    with pytest.raises(InputError, match="has tiles of more than 268,435,456 voxels, which are too many"):
        load_vdb(Path("some.vdb"), data[:start] + masks + b"\0" + values + data[start + 8193:])


def test_broken_data_does_no_harm():
    """A sample of what 10,000 mutations of each were tried for."""
    refused = 0
    for flags in (ZIP | ACTIVE_MASK, 0):
        data = vdb_bytes([VdbGrid("t", puff(), half=True, flags=flags), VdbGrid("density", puff(), tiles=True)])
        for broken in mutations(data, 60):
            try:
                with np.errstate(invalid="ignore"):  # as `load_scene` does
                    load_vdb(Path("some.vdb"), broken)
            except InputError:
                refused += 1
    assert refused > 60


@needs("vdb")
def test_broken_data_of_blosc_does_no_harm():
    """A sample of what 10,000 mutations were tried for."""
    chunk, refused = blosc(puff()[:8, :8, :8].tobytes()), 0
    data = vdb_bytes([VdbGrid("density", puff(), flags=BLOSC, pack=blosc)])
    for broken in mutations(chunk[16:], 30):
        try:
            load_vdb(Path("some.vdb"), data.replace(chunk, chunk[:16] + broken))
        except InputError:
            refused += 1
    assert refused > 10


@needs("vdb")
def test_a_chunk_of_blosc_that_lies_is_not_decoded():
    data = vdb_bytes([VdbGrid("density", puff(), flags=BLOSC, pack=blosc)])
    chunk = blosc(puff()[:8, :8, :8].tobytes())
    assert data.count(chunk) == 1
    for change in (struct.pack("<I", 1 << 30), struct.pack("<I", 8)):
        for place in (4, 12):  # the size without compression, and with it
            broken = chunk[:place] + change + chunk[place + 4:]
            with pytest.raises(InputError, match="Blosc-compressed values at byte [0-9]+ are not 2048 bytes"):
                load_vdb(Path("some.vdb"), data.replace(chunk, broken))
    assert len(apart.call("viewer.scene.decoders:blosc", chunk, 60, 1 << 28, lengths=[len(chunk)])["bytes"]) == 2048


@needs("vdb")
def test_without_the_package_for_blosc_the_error_says_so(monkeypatch):
    data = vdb_bytes([VdbGrid("density", puff(), flags=BLOSC, pack=blosc)])
    monkeypatch.setattr("viewer.scene.vdb.blocks.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'pbr-viewer\[vdb\]'"):
        load_vdb(Path("some.vdb"), data)
