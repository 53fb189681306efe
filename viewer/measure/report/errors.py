"""The errors of a picture, over the pixels that show the model.

The background is left out: it is a lookup in the environment, the same for every method. relMSE and RMSE are of linear
radiance, before exposure and tone map; FLIP is of the displayed pictures, over white where they are transparent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ...image.image import Image
from ..compare.difference import compare
from ..compare.relmse import EPSILON, Halves

MEASURES = ("relmse_trimmed", "relmse", "rmse", "flip")
"""The first decides about recommendations and the Pareto front."""
FREE_BY = ("relmse_trimmed", "flip")
"""A setting is said to cost no error if it costs none by both of these."""
TRIMMED = 0.001
"""Share of the pixels, those with the largest errors, that `relmse_trimmed` leaves out.

A few pixels can dominate relMSE: those in which a rare path found a light, or a highlight is shifted by a pixel."""


@dataclass(frozen=True, eq=False)
class Errors:
    """The errors of one picture."""

    relmse: float
    """Mean of (x - r)^2 / (r^2 + 0.01) (Rousselle et al. 2011); its root is about the relative error."""
    relmse_trimmed: float
    """The same without the worst pixels, TRIMMED of all."""
    rmse: float
    flip: float
    """Mean FLIP (Andersson et al. 2020)."""
    too_bright: float
    """Share of relMSE that comes from pixels brighter than the reference."""
    bad_pixels: int
    """How many pixels are not finite; they count as black."""
    map: np.ndarray = field(repr=False)
    """FLIP of each pixel, (H, W) float32 in [0, 1]."""

    def to_json(self) -> dict[str, float]:
        return {name: getattr(self, name) for name in MEASURES}


def errors(picture: Image, reference: Image, mask: np.ndarray) -> Errors:
    """Of `picture` against `reference` where `mask` (H, W) bool is true, which it is somewhere."""
    ours, truth = (image.linear[..., :3].astype(np.float64) for image in (picture, reference))
    bad = ~np.isfinite(ours).all(axis=-1)
    ours = np.where(np.expand_dims(bad, -1), 0.0, ours)[mask]
    truth = truth[mask]
    squared = (ours - truth) ** 2
    relative = squared / (truth**2 + EPSILON)
    bright = float(relative[ours > truth].sum() / max(relative.sum(), 1e-300))
    difference = compare(reference, picture)
    flip = float(difference.map[mask].mean(dtype=np.float64))
    return Errors(float(relative.mean()), _trimmed_mean(relative), math.sqrt(squared.mean()), flip, bright,
                  int((bad & mask).sum()), difference.map)


def relmse_floor(halves: Halves, mask: np.ndarray) -> float:
    """The relMSE that the noise of a reference of two halves, (H, W, 3) each, adds to that of any picture."""
    return Halves(halves.first[mask], halves.second[mask]).floor(halves.mean[mask])


def trimmed_floor(halves: Halves, mask: np.ndarray) -> float:
    """`relmse_floor` without the worst pixels."""
    inside = Halves(halves.first[mask], halves.second[mask])
    return _trimmed_mean(inside.variance / (inside.mean**2 + EPSILON))


def trimmed_relmse(picture: np.ndarray, reference: np.ndarray, mask: np.ndarray) -> float:
    """`Errors.relmse_trimmed` of linear radiance, (H, W, 3 or more), alone."""
    truth = reference[mask][:, :3].astype(np.float64)
    ours = np.nan_to_num(picture[mask][:, :3], nan=0.0, posinf=0.0, neginf=0.0)
    return _trimmed_mean((ours - truth) ** 2 / (truth**2 + EPSILON))


def _trimmed_mean(values: np.ndarray) -> float:
    """Of (pixels, 3), without the pixels whose mean is largest."""
    means = np.sort(values.mean(axis=1))
    return float(means[:len(means) - int(TRIMMED * len(means))].mean())
