from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest
from needs import needs

from viewer.bake import cache

ARRAYS = {"half": np.arange(24, dtype=np.float16).reshape(2, 4, 3), "none": np.zeros((0, 7)), "one": np.array([2.5])}


def assert_same(loaded):
    assert loaded is not None
    assert list(loaded) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert loaded[name].dtype == array.dtype
        assert np.array_equal(loaded[name], array)


def test_what_is_stored_is_found(own_cache):
    name = cache.key("thing", 1)
    assert cache.load(name) is None
    cache.store(name, ARRAYS)
    assert_same(cache.load(name))
    assert [path.suffix for path in own_cache.iterdir()] == [".bake"]


def test_keys_tell_content_and_parameters_apart():
    assert cache.key("a", 1) == cache.key("a", 1)
    assert len({cache.key("a", 1), cache.key("a", 2), cache.key("b", 1), cache.key("a", "1"), cache.key("a1")}) == 5


def test_a_change_of_the_code_changes_every_key(monkeypatch):
    before = cache.key("a")
    monkeypatch.setattr(cache, "_code_digest", lambda: "other code")
    assert cache.key("a") != before


@pytest.mark.parametrize("damage", ["truncated", "flipped", "empty", "longer", "header", "not ours"])
def test_a_damaged_entry_is_ignored_and_made_again(own_cache, damage):
    name = cache.key("thing")
    cache.store(name, ARRAYS)
    [path] = own_cache.iterdir()
    whole = bytearray(path.read_bytes())
    flipped = whole.copy()
    flipped[-3] ^= 1
    header = whole.copy()
    header[7] ^= 255
    path.write_bytes({"truncated": whole[:-5], "flipped": flipped, "empty": b"", "longer": whole + b"x",
                      "header": header, "not ours": b"\x89PNG" + bytes(200)}[damage])
    assert cache.load(name) is None
    cache.store(name, ARRAYS)
    assert_same(cache.load(name))


def test_a_writer_that_dies_leaves_no_half_entry(own_cache, monkeypatch):
    def die(*_):
        raise OSError("disk full")

    monkeypatch.setattr(cache.os, "replace", die)
    cache.store(cache.key("thing"), ARRAYS)
    assert list(own_cache.iterdir()) == []
    assert cache.load(cache.key("thing")) is None


def test_a_folder_that_cannot_be_made_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(tmp_path / "file" / "cache"))
    cache.store(cache.key("thing"), ARRAYS)
    assert cache.load(cache.key("thing")) is None
    assert cache.clear_cache() == 0


def test_it_can_be_switched_off(own_cache, monkeypatch):
    monkeypatch.setenv("PBR_VIEWER_CACHE", "off")
    assert cache.cache_folder() is None
    cache.store(cache.key("thing"), ARRAYS)
    assert cache.load(cache.key("thing")) is None
    assert not own_cache.exists()


@needs("linux")  # XDG
def test_it_lies_in_the_users_cache_folder(monkeypatch, tmp_path):
    monkeypatch.delenv("PBR_VIEWER_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.cache_folder() == Path(tmp_path / "pbr-viewer")


def test_the_least_recently_used_go_when_it_is_full(monkeypatch):
    names = [cache.key(k) for k in range(4)]
    megabyte = {"data": np.zeros(1 << 20, np.uint8)}
    monkeypatch.setattr(cache, "LIMIT", 2.5 * (1 << 20))
    for age, name in zip((50, 40), names):
        cache.store(name, megabyte)
        os.utime(cache._path(name), (time.time() - age,) * 2)
    assert cache.load(names[0]) is not None  # used again, so names[1] is the oldest now
    cache.store(names[2], megabyte)
    assert [cache.load(name) is not None for name in names] == [True, False, True, False]


def test_shadow_maps_go_before_the_others(monkeypatch):
    megabyte = {"data": np.zeros(1 << 20, np.uint8)}
    monkeypatch.setattr(cache, "LIMIT", 4.5 * (1 << 20))
    monkeypatch.setattr(cache, "SHADOWS_LIMIT", 2.5 * (1 << 20))
    names = [cache.key(0), *(cache.SHADOWS + cache.key(k) for k in range(3)), cache.key(4), cache.key(5)]
    for age, name in enumerate(names):
        cache.store(name, megabyte)
        os.utime(cache._path(name), (time.time() - 50 + age,) * 2)
    assert [cache.load(name) is not None for name in names] == [False, False, True, True, True, True]


def test_abandoned_temporary_files_go(own_cache):
    own_cache.mkdir()
    old, fresh = own_cache / ".a.bake.1-aa", own_cache / ".b.bake.2-bb"
    for path in (old, fresh):
        path.write_bytes(b"half")
    os.utime(old, (time.time() - 7200,) * 2)
    cache.store(cache.key("thing"), ARRAYS)
    assert not old.exists()
    assert fresh.exists()


def test_the_size_is_that_of_all_entries(own_cache, monkeypatch):
    assert cache.cache_size() == 0
    for name in ("one", "two"):
        cache.store(name, {"a": np.zeros(1000, np.float32)})
    size = cache.cache_size()
    assert size == sum(path.stat().st_size for path in cache.cache_folder().iterdir()) > 8000
    assert cache.clear_cache() == size and cache.cache_size() == 0
    monkeypatch.setenv("PBR_VIEWER_CACHE", "off")
    assert cache.cache_size() == 0


def test_clearing_frees_what_it_says_and_nothing_else(own_cache):
    cache.store(cache.key("a"), ARRAYS)
    cache.store(cache.key("b"), ARRAYS)
    (own_cache / "letter.txt").write_text("mine")
    size = sum(path.stat().st_size for path in own_cache.glob("*.bake"))
    assert cache.clear_cache() == size > 0
    assert [path.name for path in own_cache.iterdir()] == ["letter.txt"]
