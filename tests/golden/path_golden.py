"""Whether a path-traced picture is the golden one but for its noise.

A path-traced picture is a sample: another seed, another device give another one, so that no tolerance for pixels is
right everywhere. But its noise is known. A golden image here is the mean of PICTURES pictures of other seeds and, pixel
by pixel, the variance of one of them; a picture's difference from the mean over the standard deviation is a score z
that should be normal, and a Z test tells whether it is (as in Mitsuba 3, src/render/tests/test_renders.py; Subr & Arvo
2007, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators").

- *Variance.* The samples of a pixel are points of one scrambled Sobol sequence: their own variance over their number
  is more than that of their mean. So it is taken between whole pictures of the same number of samples and different
  scramblings. Pixels are scrambled independently, so that the variance of a block's mean follows from its pixels'.
- *Heavy tails.* A pixel's mean of some tens of samples is not normal where a few paths bring much light. That of a
  block of 8 x 8 pixels is nearly so. Blocks and the whole picture have to pass without exception; of pixels a few may
  fail. Blocks and picture find a wrong amount of light; pixels one at the wrong place.
- *Little noise.* Where light hardly varies, one sample in ten thousand that does, at an outline for instance, is no
  normal noise. So no deviation counts for less than a quarter of what deviations are in the picture (their root mean
  square). And where light does not vary at all, as in the background, devices still round: ROUNDING of the value is
  added.
- *Many tests.* With m of them, the level of each is 1 - (1 - SIGNIFICANCE)^(1/m) (Sidak 1967).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np

from viewer.image.image import Image

FOLDER = Path(__file__).parent / "path"
PICTURES = 64
"""Of each golden image."""
SIGNIFICANCE = 1e-4
"""Of blocks, picture and pixels each: how often one of them fails that is right. Tails make it somewhat more."""
BLOCK = 8
FEW = 0.01
"""The share of pixels' values that may fail."""
ROUNDING = 5e-4


@dataclass(frozen=True, eq=False)
class PathGolden:
    """`mean` and, of one picture, `variance`; (H, W, 3) float64, linear radiance."""

    mean: np.ndarray
    variance: np.ndarray

    @classmethod
    def of(cls, pictures: Sequence[np.ndarray]) -> PathGolden:
        stack = np.stack(pictures).astype(np.float64)
        return cls(stack.mean(axis=0), stack.var(axis=0, ddof=1))

    @classmethod
    def load(cls, name: str) -> PathGolden:
        """Raises InputError where it is not stored."""
        return cls(*(Image.open(path).linear[..., :3].astype(np.float64) for path in _paths(name)))

    def save(self, name: str) -> None:
        for path, pixels in zip(_paths(name), (self.mean, self.variance), strict=True):
            Image.from_linear(pixels).save(path)

    def scores(self, picture: np.ndarray, block: int) -> np.ndarray:
        """How many standard deviations the means of blocks of block x block pixels are apart, each channel; signed."""
        difference, mean = _means(picture - self.mean, block), _means(self.mean, block)
        variance = _means(self.variance, block) / block**2 * (1 + 1 / PICTURES)
        return difference / np.sqrt(np.maximum(variance, variance.mean() / 16) + (ROUNDING * mean) ** 2)

    def problem(self, picture: np.ndarray) -> str | None:
        """In words why `picture`, (H, W, 3) linear radiance of as many samples, is another; None if only noise is."""
        if not np.isfinite(picture).all():
            return "some pixels are not finite"
        ratio = picture.mean() / self.mean.mean()
        for block, shown in ((len(self.mean), "the picture's mean"), (BLOCK, f"the mean of {BLOCK} x {BLOCK} pixels")):
            worst = self.worst(picture, block)
            if worst > critical(self.scores(picture, block).size):
                return f"{shown} is {worst:.1f} standard deviations off (all light: {ratio - 1:+.2%})"
        share = self.failing_pixels(picture)
        if share > FEW:
            return f"{share:.2%} of the pixels' values are too far off (all light: {ratio - 1:+.2%})"
        return None

    def worst(self, picture: np.ndarray, block: int) -> float:
        return float(np.abs(self.scores(picture, block)).max())

    def failing_pixels(self, picture: np.ndarray) -> float:
        scores = self.scores(picture, 1)
        return float((np.abs(scores) > critical(scores.size)).mean())

    def detectable(self) -> float:
        """The relative error of all light that makes the picture's mean fail in half of all pictures, and in nearly all
        if it is by half larger; of the channel that notices first."""
        block = len(self.mean)
        mean, variance = _means(self.mean, block), _means(self.variance, block) / block**2
        return float((critical(3) * np.sqrt(variance / mean**2 + ROUNDING**2)).min())


def critical(tests: int) -> float:
    """The |z| that the largest of so many scores exceeds with probability SIGNIFICANCE."""
    level = 1 - (1 - SIGNIFICANCE) ** (1 / tests)
    return NormalDist().inv_cdf(1 - level / 2)


def _paths(name: str) -> tuple[Path, Path]:
    return FOLDER / f"{name}.exr", FOLDER / f"{name}-variance.exr"


def _means(values: np.ndarray, block: int) -> np.ndarray:
    height, width, channels = values.shape
    return values.reshape(height // block, block, width // block, block, channels).mean(axis=(1, 3))
