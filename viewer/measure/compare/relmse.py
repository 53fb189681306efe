"""The difference between two noisy pictures, and how much of it their noise alone would make.

relMSE is the mean over pixels and channels of (picture - reference)^2 / (reference^2 + 0.01) (Rousselle et al. 2011).
Two unbiased pictures of one scene are apart by the sum of their variances alone, so that a relMSE over that sum is a
bias. Pictures are linear radiance, (H, W, 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...estimate.neighbourhood import EPSILON


def relmse(picture: np.ndarray, reference: np.ndarray) -> float:
    reference = np.asarray(reference, np.float64)
    return float(((picture - reference) ** 2 / (reference**2 + EPSILON)).mean())


@dataclass(frozen=True, eq=False)
class Halves:
    """A picture as two of the same sample count with nothing in common but the scene."""

    first: np.ndarray
    second: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        return (np.asarray(self.first, np.float64) + self.second) / 2

    @property
    def variance(self) -> np.ndarray:
        """Of `mean`, (H, W, 3): an estimate of one degree of freedom a pixel, to be averaged over many."""
        return (np.asarray(self.first, np.float64) - self.second) ** 2 / 4

    def floor(self, reference: np.ndarray) -> float:
        """The relMSE that the noise of `mean` alone makes."""
        return float((self.variance / (np.asarray(reference, np.float64) ** 2 + EPSILON)).mean())

    def against(self, reference: np.ndarray, reference_floor: float = 0.0) -> Comparison:
        """`reference_floor` is the relMSE that the reference's own noise makes."""
        return Comparison(relmse(self.mean, reference), self.floor(reference) + reference_floor,
                          float(self.mean.mean() / np.mean(reference)),
                          float(np.sqrt(self.variance.sum()) / self.variance.size / np.mean(reference)))

    def block_scores(self, reference: np.ndarray, reference_floor: float, block: int) -> np.ndarray:
        """For blocks of `block` x `block` pixels and each channel how many standard deviations the means are apart.

        The reference's variance is taken for proportional to reference^2 + EPSILON, as relMSE weighs it.
        """
        reference = np.asarray(reference, np.float64)
        noise = self.variance + reference_floor * (reference**2 + EPSILON)
        difference, variance = (_blocks(values, block) for values in (self.mean - reference, noise))
        return difference.sum(axis=1) / np.sqrt(np.maximum(variance.sum(axis=1), 1e-12))


@dataclass(frozen=True)
class Comparison:
    relmse: float
    floor: float
    """The relMSE that the noise of both pictures makes."""
    mean_ratio: float
    """Mean radiance over the reference's."""
    mean_sigma: float
    """The standard deviation of `mean_ratio`, by the noise of our picture."""

    @property
    def excess(self) -> float:
        """1 where there is nothing but noise."""
        return self.relmse / self.floor


def reduced(picture: np.ndarray, factor: int) -> np.ndarray:
    """The picture in 1/factor of its size by a box filter."""
    height, width = (side // factor for side in picture.shape[:2])
    return picture[:height * factor, :width * factor].reshape(height, factor, width, factor, -1).mean(axis=(1, 3))


def _blocks(values: np.ndarray, block: int) -> np.ndarray:
    """(blocks, block * block, channels)."""
    rows, columns = (side // block for side in values.shape[:2])
    values = values[:rows * block, :columns * block].reshape(rows, block, columns, block, -1)
    return values.transpose(0, 2, 1, 3, 4).reshape(rows * columns, block * block, -1)
