"""docs/calling-glsl.md: its examples run."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

PAGE = Path(__file__).parents[1] / "docs" / "calling-glsl.md"


def test_examples(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    names: dict = {}
    for block in blocks:
        exec(block, names)
    assert names["V"].shape == (3, 100) and np.isfinite(names["V"]).all()
    assert names["shade"].shape == (7, 3) and names["step"].tolist() == [4, 4, 4, 3, 3, 2, 1]
    assert np.allclose(names["shade"], np.outer(names["step"], [1, 0.5, 0]) / 4 / np.pi)
    assert names["sample"]["weight"].shape == (1000, 3)
