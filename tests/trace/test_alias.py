"""viewer/trace/scene/alias.py: the probabilities of a table are in proportion to the weights."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.trace.scene.alias import alias_table

RANDOM = np.random.default_rng(5)
CASES = {
    "one": [3.0],
    "equal": np.full(1000, 0.1),
    "two": [1e-3, 1.0],
    "zeros": [0, 0, 5, 0, 1, 0, 0],
    "one of many": np.eye(1, 1000, 137)[0],
    "ratio of 1e30": np.geomspace(1e-30, 1, 4001),
    "shuffled": RANDOM.permutation(np.geomspace(1e-6, 1, 5000)),
    "huge": [1e308, 1e308, 1e307],
    "tiny": [3e-300, 1e-300],
    "sun": np.append(RANDOM.uniform(0, 1, 100000), 1e9),
    "many": RANDOM.exponential(size=1 << 18) ** 4,
}


def probabilities(threshold: np.ndarray, alias: np.ndarray) -> np.ndarray:
    return (threshold + np.bincount(alias, 1 - threshold, len(alias))) / len(alias)


@pytest.mark.parametrize("name", CASES)
def test_probabilities(name):
    """Each probability is right to 1e-12, and entries of weight 0 are never chosen."""
    weights = np.asarray(CASES[name], np.float64)
    threshold, alias = alias_table(weights)
    assert threshold.shape == alias.shape == weights.shape and alias.dtype == np.uint32
    assert (threshold >= 0).all() and (threshold <= 1).all() and (alias < len(weights)).all()
    found = probabilities(threshold, alias)
    expected = weights / weights.max() / (weights / weights.max()).sum()
    assert np.abs(found - expected).max() < 1e-12
    assert (found[weights == 0] == 0).all()
