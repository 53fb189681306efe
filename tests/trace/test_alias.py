"""viewer/trace/scene/alias.py: probabilities are in proportion to the weights, and grids keep points stratified."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.trace.scene.alias import alias_grid, alias_table

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


@pytest.mark.parametrize("shape", [(512, 1024), (7, 20), (1, 1), (300, 3)])
def test_probabilities_of_a_grid(shape):
    weights = np.random.default_rng(2).exponential(size=shape) ** 4
    threshold, alias = alias_grid(weights)
    assert threshold.shape == alias.shape == (weights.size,) and alias.dtype == np.uint32
    assert np.abs(probabilities(threshold, alias) - weights.ravel() / weights.sum()).max() < 1e-12


def test_stratified_points_stay_so():
    """With one point in each of 256 parts of a grid, each 2 x 2 cells of a light of 16 x 16 get about four."""
    weights = np.zeros((64, 128))
    weights[8:24, 80:96] = 1
    _, alias = alias_grid(weights)
    points = np.random.default_rng(3).integers(0, (4, 8), (16, 16, 2)) + np.mgrid[0:64:4, 0:128:8].transpose(1, 2, 0)
    row, column = np.divmod(alias.reshape(weights.shape)[points[..., 0], points[..., 1]], 128)
    counts = np.bincount(((row - 8) // 2 * 8 + (column - 80) // 2).ravel(), minlength=64)  # of 2 x 2 cells
    assert counts.sum() == 256 and counts.min() >= 3 and counts.max() <= 6
