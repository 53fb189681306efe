"""Factors by which rough glass loses no light, though its facets scatter once.

What would meet a second facet is lost (shaders/bsdf/lobe/dielectric.glsl): at alpha 0.3 a tenth at each crossing, and
more in grazing light. We scale the lobe by a factor for each of the two directions, s(o) s(i) f(o, i), such that

    s(o) integral f(o, i) s(i) |cos i| di = 1        for all directions o, on both sides of the interface

So f stays reciprocal, and no light is lost, whether paths begin at the eye or at a light. A power series in the lost
light is what reality has; this is the only factor of its form (Sinkhorn 1964, "A Relationship Between Arbitrary
Positive Matrices and Doubly Stochastic Matrices"), and its fixed point is found by repetition. Kulla & Conty 2017 add a
diffuse lobe instead, by which glass of an index near 1 would turn to milk.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..base.resources import resource_folder
from .cache import key, load, store
from .dfg import SIZE as DFG_SIZE
from .rough_boundary import RoughBoundary

LAYERS = COSINES = ROUGHNESSES = 16
"""Values of the fourth root of f0, of the root of the cosine, and of the perceptual roughness up to ROUGHEST."""
ROUGHEST = 0.5
"""Rougher glass has the factors of this. Where light is reflected inside again and again, the products of its own,
which are as great as 50, would have no variance; at 0.6 some pixels were far too bright."""
_TILES, _FINE = 4, 3  # tiles in a row; steps of the solution for one of the table
_LEAST = 1e-4  # cosine, and alpha, in place of 0
_LARGEST = 1e4  # index in place of that where f0 is 1: all is reflected, as facets of thin walls do in all
_ROUNDS, _SETTLED = 400, 1e-6
_KEPT = 1e-4
"""Of light that each facet is taken to send straight back. In grazing light next to nothing else of it may be left, and
no s is greater than 1 / sqrt of this."""
_SPARE = 0.004
"""Of log s, times the roughness: between the values of the table up to twice as much light would be gained."""


def with_rough_glass(table: NDArray[np.float32], masking: str) -> NDArray[np.float32]:
    """The DFG table for what looks up no environment, with these factors in its second quarter
    (shaders/light/rough_glass.glsl)."""
    return np.concatenate([table[:DFG_SIZE], rough_glass_factors(masking), table[2 * DFG_SIZE:]])


def rough_glass_factors(masking: str) -> NDArray[np.float32]:
    """log s, (64, 64, 4) float32: a tile of 16 x 16 for each of 16 f0, four in a row. In a tile the row is the cosine,
    the column the roughness. The first channel is for light outside of the glass, the second for light inside; the
    others are those of the next f0."""
    if masking != "smith-separable":  # glass has Smith's masking where a setting asks for another one
        return _shipped()
    cache_key = key("rough glass", masking)
    cached = load(cache_key)
    if cached is None:
        cached = {"factors": compute_factors(masking)}
        store(cache_key, cached)
    return cached["factors"]


@lru_cache(maxsize=1)
def _shipped() -> NDArray[np.float32]:
    with np.load(resource_folder("assets") / "rough_glass_smith.npz", allow_pickle=False) as found:
        return found["factors"]


def compute_factors(masking: str) -> NDArray[np.float32]:
    """What `rough_glass_factors` returns."""
    cube = np.zeros((LAYERS + 1, COSINES, ROUGHNESSES, 2))
    for layer, root in enumerate(np.linspace(0, 1, LAYERS)):
        ior = min((1 + root**2) / max(1 - root**2, 1e-9), _LARGEST)
        for column, roughness in enumerate(np.linspace(0, ROUGHEST, ROUGHNESSES)[1:], 1):
            found = np.minimum(solve(RoughBoundary(ior, roughness**2, masking)), -0.5 * np.log(_KEPT))
            cube[layer, :, column] = found.T - _SPARE * roughness
    cube[LAYERS] = cube[LAYERS - 1]
    pairs = np.concatenate([cube[:-1], cube[1:]], axis=3)
    tiles = pairs.reshape(LAYERS // _TILES, _TILES, COSINES, ROUGHNESSES, 4).swapaxes(1, 2)
    return tiles.reshape(-1, _TILES * ROUGHNESSES, 4).astype(np.float32)


def solve(boundary: RoughBoundary) -> NDArray[np.float64]:
    """log s of light outside and inside, (2, COSINES): linear between these, they lose least light."""
    count = _FINE * (COSINES - 1) + 1
    cosines = np.maximum(np.linspace(0, 1, count) ** 2, _LEAST)
    cosines[-1] = np.cos(1e-3)  # along the normal there is no plane of incidence
    sides = []
    for eta in (boundary.ior, 1 / boundary.ior):
        (back, reflected), (onward, refracted) = boundary.scattered(cosines, eta)
        sides.append((_shares(back, reflected, count), _shares(onward, refracted, count)))
    (reflected_out, entering), (reflected_in, leaving) = sides
    kernel = np.block([[reflected_out, entering], [leaving, reflected_in]]) + _KEPT * np.eye(2 * count)
    linear = _shares(cosines[:, None], np.ones((count, 1)), COSINES)
    weight = linear.T * np.sqrt(cosines) ** 3  # 2 mu dmu = 4 sqrt(mu)^3 dsqrt(mu)
    nearest = np.linalg.solve(weight @ linear, weight)
    found = np.zeros((2, COSINES))
    for _ in range(_ROUNDS):
        s = np.exp(found @ linear.T).ravel()
        lost = np.log(s * (kernel @ s)).reshape(2, count) @ nearest.T
        found -= 0.5 * lost
        if np.abs(lost).max() < _SETTLED:
            break
    return found


def _shares(cosines: NDArray[np.float64], shares: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """What goes from each of N directions to each of `count` nodes, (N, count). Between two nodes it is divided."""
    place = np.sqrt(np.clip(cosines, 0, 1)) * (count - 1)
    low = np.minimum(place.astype(int), count - 2)
    found = np.zeros((len(place), count))
    rows = np.broadcast_to(np.arange(len(place))[:, None], place.shape)
    np.add.at(found, (rows, low), shares * (1 - (place - low)))
    np.add.at(found, (rows, low + 1), shares * (place - low))
    return found
