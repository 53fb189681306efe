"""Pearson's test of a histogram against the counts a density predicts, and its threshold for many tests at once."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

MIN_EXPECTED = 5.0  # bins that expect less are pooled: below it the statistic is not chi-squared (Cochran 1954)
SIGNIFICANCE = 0.01  # of all tests together


def statistic(observed: np.ndarray, expected: np.ndarray) -> tuple[float, int]:
    """Pearson's sum and its degrees of freedom for counts (bins,); the smallest bins are pooled into one."""
    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    below = np.searchsorted(np.cumsum(expected), MIN_EXPECTED) + 1
    small = max(int((expected < MIN_EXPECTED).sum()), below if expected[0] < MIN_EXPECTED else 0)
    if small:
        observed = np.append(observed[small:], observed[:small].sum())
        expected = np.append(expected[small:], expected[:small].sum())
    keep = expected > 0
    if (observed[~keep] > 0).any():
        return float("inf"), max(int(keep.sum()) - 1, 1)
    sums = (observed[keep] - expected[keep]) ** 2 / np.maximum(expected[keep], 1.0)
    return float(sums.sum()), max(int(keep.sum()) - 1, 1)


def critical_value(degrees: int, tests: int, significance: float = SIGNIFICANCE) -> float:
    """What chi-squared exceeds with probability `significance` in any one of `tests` independent tests.

    Each test gets 1 - (1 - significance)^(1 / tests) (Sidak 1967); the quantile is that of Wilson & Hilferty 1931.
    """
    each = -np.expm1(np.log1p(-significance) / tests)
    z = NormalDist().inv_cdf(1 - each)
    k = 2 / (9 * degrees)
    return degrees * (1 - k + z * np.sqrt(k)) ** 3
