"""The DFG table of the split-sum approximation (Karis 2013): the directional albedo of a microfacet lobe, and where to
look up the prefiltered environment for it.

    E(NoV, alpha) = integral f(v, l) NoL dl = f0 a + f90 b,     a = <1 - Fc>, b = <Fc>, Fc = (1 - VoH)^5

Here <.> is the integral over half vectors h weighted by D(h) G2(v, l) VoH / NoV (lobe_samples.py). lookups.py finds the
lookups.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..base.resources import resource_folder
from ..settings import MASKINGS, NDFS
from .cache import key, load, store
from .lobe_samples import lobe_parts
from .lookups import GRID, fit_lookups
from .prefilter import level_of_roughness

SIZE = 64  # the error of bilinear lookups is 6e-5 on average, and at most 2e-3 for NoV and roughness above 0.1
_ROWS = 64
MIN_COSINE = 1e-4  # NoV at which the row for 0 is evaluated: the limit exists, but 0 / 0 is undefined


@lru_cache(maxsize=4)
def dfg_table(ndf: str = "ggx", masking: str = "smith") -> np.ndarray:
    """The DFG table, (4 SIZE, SIZE, 4) float32.

    The first quarter has a, b, and the hemispherical means of a and b. The means 2 int a mu dmu and 2 int b mu dmu are
    those of the table as shaders read it; they are the same in all rows. The second quarter has the one lookup that is
    best alone, the others the two that are best together: t, the level of the prefiltered environment, and the weights
    in a and b. The direction is mix(n, r, t); what the weights lack to 1 is the weight of the irradiance at n.

    Row j of each quarter is NoV = (j / (SIZE-1))^2; column i is perceptual roughness i / (SIZE-1). In texture
    coordinates that is u = roughness and v = sqrt(NoV), each inset by half a texel (shaders/light/dfg.glsl). The
    default table is in the package's assets. Any other is computed (two seconds) and stored in the cache on disk.
    """
    if (ndf, masking) == ("ggx", "smith"):
        table = np.load(resource_folder("assets") / "dfg_ggx_smith.npy", allow_pickle=False)
    else:
        cache_key = key("dfg", ndf, masking, SIZE)
        cached = load(cache_key)
        table = cached["table"] if cached else compute_dfg_table(ndf, masking, SIZE)
        if not cached:
            store(cache_key, {"table": table})
    table.flags.writeable = False
    return table


@lru_cache(maxsize=len(NDFS) * len(MASKINGS))
def dfg_albedos(ndf: str, masking: str) -> np.ndarray:
    """`dfg_table` for what looks up no environment: all lookups are 0, except in the default table. To fit them takes
    three quarters of the time that a table takes."""
    if (ndf, masking) == ("ggx", "smith"):
        return dfg_table()
    cache_key = key("dfg albedos", ndf, masking, SIZE)
    cached = load(cache_key)
    table = cached["table"] if cached else np.zeros((4 * SIZE, SIZE, 4), np.float32)
    if not cached:
        table[:SIZE] = albedo_table(ndf, masking, SIZE)
        store(cache_key, {"table": table})
    table.flags.writeable = False
    return table


def compute_dfg_table(ndf: str, masking: str, size: int, nodes: int = 24) -> np.ndarray:
    """Computes the table of `dfg_table` with `nodes` quadrature nodes per side."""
    lookups = np.concatenate([_near_mirror(_resized(found, size)) for found in fit_lookups(ndf, masking)], axis=2)
    return np.concatenate([albedo_table(ndf, masking, size, nodes), *np.moveaxis(lookups, 2, 0)]).astype(np.float32)


def albedo_table(ndf: str, masking: str, size: int, nodes: int = 24) -> np.ndarray:
    """The first quarter of that table, (size, size, 4) float64."""
    axis = np.arange(size) / (size - 1)
    NoV = np.maximum(axis**2, MIN_COSINE)
    NoV[-1] = np.cos(1e-3)  # for v = n there is no plane of incidence
    table = np.empty((size, size, 4))
    for column, perceptual_roughness in enumerate(axis):
        table[:, column, :2] = directional_albedo(ndf, masking, NoV, perceptual_roughness**2, nodes)
    table[..., 2:] = hemispherical_mean(table[..., :2])
    return table


def _resized(grid: np.ndarray, size: int) -> np.ndarray:
    """The first two axes of `grid` interpolated linearly to `size` values, with the same ends."""
    for axis in (0, 1):
        place = np.linspace(0, grid.shape[axis] - 1, size)
        low = np.minimum(place.astype(int), grid.shape[axis] - 2)
        part = np.expand_dims(place - low, tuple(range(1, grid.ndim))).swapaxes(0, axis)
        grid = (1 - part) * grid.take(low, axis) + part * grid.take(low + 1, axis)
    return grid


def _near_mirror(lookups: np.ndarray) -> np.ndarray:
    """The lookups, whose levels grow as `level_of_roughness` does from the mirror to the first roughness that was
    fitted: by the square of the roughness. In proportion to it, a blend with level 1 would surround lamps with a haze.
    """
    first, roughness = 1 / (GRID - 1), np.arange(lookups.shape[1]) / (lookups.shape[1] - 1)
    narrow = (roughness > 0) & (roughness < first)
    part = level_of_roughness(roughness[narrow]) / level_of_roughness(np.array(first))
    lookups[..., 1][:, narrow] *= (part * first / roughness[narrow])[:, None]
    return lookups


def hemispherical_mean(albedo: np.ndarray) -> np.ndarray:
    """The means of a and b over the hemisphere, (size, 2), from their table (size, size, 2).

    With v = sqrt(mu), 2 int E mu dmu = int E 4 v^3 dv. The result is exact for E linear in v between the rows. Without
    masking a + b may exceed 1; both are then divided by a + b, so that no light counts as missing.
    """
    limited = albedo / np.maximum(albedo.sum(axis=-1, keepdims=True), 1.0)
    v = np.linspace(0, 1, len(albedo))
    whole, moment = np.diff(v**4), np.diff(0.8 * v**5)
    upper = (moment - v[:-1] * whole) / np.diff(v)
    weight = np.append(whole - upper, 0) + np.append(0, upper)
    return np.einsum("j,jic->ic", weight, limited)


def directional_albedo(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """a and b by quadrature, (N, 2) float64, for NoV (N,) in (0, 1]; alpha 0 is a mirror."""
    if alpha == 0:
        mirror = (1 - np.asarray(NoV, np.float64)) ** 5
        return np.stack([1 - mirror, mirror], axis=-1)
    NoV = np.asarray(NoV, np.float64)
    # Some rows at a time: to get and give back the memory of more takes longer than the quadrature.
    return np.concatenate([lobe_parts(ndf, masking, NoV[first:first + _ROWS], alpha, nodes).sum(axis=1)
                           for first in range(0, len(NoV), _ROWS)])
