"""The layers of a path-traced picture: albedo, normal, distance, variance and samples of each pixel."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from .film import Film

FIRST_HIT_LAYERS = frozenset({"albedo", "normal", "distance"})
"""Those that only a film with `has_layers` gathers."""


def read_layers(film: Film, names: Collection[str]) -> dict[str, np.ndarray]:
    """The layers `names`, (H, W, 3) or (H, W) float32, row 0 at the top.

    albedo, normal (world axes, length at most 1) and distance (along the ray, in the scene's unit) are means over the
    first hits of the pixel's camera rays; a pixel without hits has 0, 0 and infinity. variance is the estimated
    variance of the mean radiance, infinite for fewer than two samples. samples is the number of samples.
    """
    layers: dict[str, np.ndarray] = {}
    if FIRST_HIT_LAYERS & set(names):
        albedo, normal, _ = film.read_layers()
        hits = albedo[..., 3:]
        is_hit = hits[..., 0] > 0
        layers["albedo"], mean = (np.where(hits > 0, total / np.maximum(hits, 1), 0) for total in (albedo, normal))
        layers["normal"], layers["distance"] = mean[..., :3], np.where(is_hit, mean[..., 3], np.inf)
    if not set(names) <= FIRST_HIT_LAYERS:
        total, squares = film.read_sums()
        n = total[..., 3:]
        mean = total / np.maximum(n, 1)
        spread = np.maximum(squares / np.maximum(n, 1) - mean * mean, 0) / np.maximum(n - 1, 1)
        layers["variance"], layers["samples"] = np.where(n > 1, spread, np.inf), n[..., 0]
    return {name: np.ascontiguousarray(layers[name][..., :3] if layers[name].ndim == 3 else layers[name], np.float32)
            for name in names}
