"""Pearson's test of a histogram against the counts a density predicts, and its threshold for many tests at once."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

MIN_EXPECTED = 5.0  # bins that expect less are pooled: below it the statistic is not chi-squared (Cochran 1954)
MAX_STRAY = 1e-3  # share of samples that rounding may put where none is expected
SIGNIFICANCE = 0.01  # of all tests together


def statistic(observed: np.ndarray, expected: np.ndarray) -> tuple[float, int]:
    """Pearson's sum and its degrees of freedom for counts (bins,); the smallest bins are pooled into one."""
    impossible = expected < 1e-9 * expected.sum()
    if observed[impossible].sum() > MAX_STRAY * observed.sum():
        return float("inf"), 1
    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    # Bins up to the first that expects enough, and as many more as their pool needs to expect enough itself.
    pooled = int((expected < MIN_EXPECTED).sum())
    if pooled:
        pooled = max(pooled, int(np.searchsorted(np.cumsum(expected), MIN_EXPECTED)) + 1)
        observed = np.append(observed[pooled:], observed[:pooled].sum())
        expected = np.append(expected[pooled:], expected[:pooled].sum())
    return float(((observed - expected) ** 2 / np.maximum(expected, 1.0)).sum()), max(len(expected) - 1, 1)


def critical_value(degrees: int, tests: int) -> float:
    """What chi-squared exceeds with probability SIGNIFICANCE in any one of `tests` independent tests.

    Each test gets 1 - (1 - SIGNIFICANCE)^(1 / tests) (Sidak 1967); the quantile is that of Wilson & Hilferty 1931.
    """
    each = -np.expm1(np.log1p(-SIGNIFICANCE) / tests)
    z = NormalDist().inv_cdf(1 - each)
    k = 2 / (9 * degrees)
    return degrees * (1 - k + z * np.sqrt(k)) ** 3
