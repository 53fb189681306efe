from __future__ import annotations

import numpy as np
import pytest

from viewer.errors import OutputError
from viewer.measure.report.store import Record, Store


def picture() -> np.ndarray:
    return np.random.default_rng(1).gamma(1, 1, (5, 7, 4)).astype(np.float32)


def test_what_was_kept_comes_back_to_the_bit(tmp_path):
    store = Store(tmp_path / "new")
    pixels = picture()
    pixels[0, 0, 0] = np.nan
    store.save("a", "key", Record(pixels, {"n": 3}, 1.5))
    kept = Store(tmp_path / "new").load("a", "key")
    assert kept is not None and np.array_equal(kept.picture, pixels, equal_nan=True)
    assert (kept.facts, kept.seconds) == ({"n": 3}, 1.5)


@pytest.mark.parametrize("harm", ["other key", "no picture", "half a picture", "half a figure", "other figures",
                                  "other kinds", "nothing"])
def test_what_cannot_be_trusted_is_not_there(tmp_path, harm):
    store = Store(tmp_path)
    if harm != "nothing":
        store.save("a", "key", Record(picture()))
    figures, file = tmp_path / "a.json", store.picture_path("a")
    if harm == "no picture":
        file.unlink()
    elif harm == "half a picture":
        file.write_bytes(file.read_bytes()[:40])
    elif harm == "half a figure":
        figures.write_text(figures.read_text()[:10])
    elif harm == "other figures":
        figures.write_text(figures.read_text().replace("0.0", "1.0"))
    elif harm == "other kinds":
        figures.write_text("[]")
    assert store.load("a", "key2" if harm == "other key" else "key") is None


def test_a_folder_that_cannot_be_made_is_told_in_one_line(tmp_path):
    with pytest.raises(OutputError, match="the folder .*missing does not exist"):
        Store(tmp_path / "missing" / "new")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file: is a file, not a folder"):
        Store(tmp_path / "file")
