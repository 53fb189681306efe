"""The directional albedo of GGX lobes that anisotropy stretches.

It depends on two alphas, and on both angles of the view. What the view sees of the facets are the slopes along its
azimuth and across it. With d the azimuth, their widths and their correlation are

    along^2 = (alpha_t dx)^2 + (alpha_b dy)^2,    across^2 = (alpha_t dy)^2 + (alpha_b dx)^2,
    rho = dx dy (alpha_t^2 - alpha_b^2) / (along across)

`along` alone gives the masking of the view, so the isotropic lobe of that alpha is a first guess, and exact for smooth
lobes that graze. The correlation matters little, and its influence has nearly the same shape everywhere. So a small
table of three dimensions is enough for what the guess lacks of a and b of the split sum (dfg.py); c is a fit:

    (a, b) = isotropic(along, NoV) + E_0(along, across, NoV) + s E_1(along, across, NoV),
    s = rho^2 (1 - c + c rho^2),    c = min(1.3 across^2 (1 - NoV), 1)

With Smith masking a + b is right within 0.004, against the quadrature, for alphas from 0.002 to 1 and views from one
degree above the surface (tests/shaders/test_stretched_dfg.py). Without masking the isotropic albedo has no bound, and
that of stretched lobes between the nodes of the table may be far off near the horizon.

The albedo is integrated over visible normals in the cap of Dupuy & Benyoub 2023 ("Sampling Visible GGX Normals with
Spherical Caps"), whose slopes are correlated by the Cholesky factor of their covariance (Heitz 2014, "Understanding the
Masking-Shadowing Function", section 5.4).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..base.resources import resource_folder
from .cache import key, load, store
from .dfg import SIZE as DFG_SIZE
from .dfg import dfg_albedos

SIZE = 16  # values along each axis; widths and NoV are the squares of equal steps
LEAST = 1e-4  # in place of 0: the limit exists, but 0 / 0 is undefined
_CORRELATIONS = np.array([0.0, 0.35, 0.6, 0.8, 0.93, 1 - 1e-7])  # that E_0 and E_1 are fitted to
_TILES, _ROWS = 2, 64
_AZIMUTHS, _PANELS = 32, 21  # of the means


def stretched_levels(masking: str) -> tuple[np.ndarray, np.ndarray]:
    """The levels 1 and 2 of the texture whose level 0 is the DFG table (shaders/light/stretched_dfg.glsl), float32.

    Level 1, (128, 32, 4), has a tile of 16 x 16 for each of 16 NoV, two in a row. In a tile the column is `along`, the
    row `across`; the channels are a and b of E_0 and those of E_1. Level 2, (64, 16, 4), has what the
    hemispherical means of a and b, as shaders read them, have beside those of the isotropic lobe of the root mean
    square alpha; its columns are alpha_t, its rows alpha_b.
    """
    if masking == "smith":
        return _shipped()
    cache_key = key("stretched", masking)
    cached = load(cache_key)
    if cached is None:
        cached = dict(zip(("albedos", "means"), compute_levels(masking), strict=True))
        store(cache_key, cached)
    return cached["albedos"], cached["means"]


@lru_cache(maxsize=1)
def _shipped() -> tuple[np.ndarray, np.ndarray]:
    with np.load(resource_folder("assets") / "dfg_ggx_smith_stretched.npz", allow_pickle=False) as found:
        return found["albedos"], found["means"]


def compute_levels(masking: str, nodes: int = 32) -> tuple[np.ndarray, np.ndarray]:
    """What `stretched_levels` returns, by `nodes` squared visible normals for each value."""
    axis = np.maximum(np.linspace(0, 1, SIZE) ** 2, LEAST)
    NoV, across, along = (kind.ravel() for kind in np.meshgrid(axis, axis, axis, indexing="ij"))
    found = np.stack([correlated_albedo(masking, along, across, rho, NoV, nodes) for rho in _CORRELATIONS])
    found /= np.maximum(found.sum(axis=2, keepdims=True), 1)  # without masking more than all is reflected
    s = influence(_CORRELATIONS[:, None] ** 2, across, NoV)[..., None]
    slope = ((s - s.mean(axis=0)) * found).sum(axis=0) / ((s - s.mean(axis=0)) ** 2).sum(axis=0)  # least squares
    lacking = found.mean(axis=0) - s.mean(axis=0) * slope - isotropic(masking, along, NoV)[:, :2]
    cube = np.concatenate([lacking, slope], axis=1).reshape(SIZE, SIZE, SIZE, 4)
    tiles = cube.reshape(SIZE // _TILES, _TILES, SIZE, SIZE, 4).swapaxes(1, 2)
    return tiles.reshape(-1, _TILES * SIZE, 4).astype(np.float32), _means(masking, cube).astype(np.float32)


def influence(rho2: np.ndarray, across: np.ndarray, NoV: np.ndarray) -> np.ndarray:
    c = np.minimum(1.3 * across**2 * (1 - NoV), 1)
    return rho2 * (1 - c + c * rho2)


def seen_slopes(alpha_t: np.ndarray, alpha_b: np.ndarray,
                azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`along`, `across` and rho for arrays that broadcast."""
    x, y = np.cos(azimuth), np.sin(azimuth)
    along, across = np.hypot(alpha_t * x, alpha_b * y), np.hypot(alpha_t * y, alpha_b * x)
    return along, across, x * y * (alpha_t**2 - alpha_b**2) / (along * across)


def correlated_albedo(masking: str, along: np.ndarray, across: np.ndarray, rho: np.ndarray | float, NoV: np.ndarray,
                      nodes: int) -> np.ndarray:
    """a and b, (N, 2) float64, of GGX facets with these widths of slopes, (N,) in (0, 1]."""
    along, across, rho, NoV = np.broadcast_arrays(along, across, rho, NoV)
    steps = range(0, len(NoV), 512)  # 512 views at a time keep the memory small
    return np.concatenate([
        _albedo(masking, nodes, *(kind[first:first + 512, None, None] for kind in (along, across, rho, NoV)))
        for first in steps])


def _albedo(masking: str, nodes: int, along: np.ndarray, across: np.ndarray, rho: np.ndarray,
            z: np.ndarray) -> np.ndarray:
    x, weight = np.polynomial.legendre.leggauss(nodes)
    phi = (np.arange(nodes) + 0.5) * (2 * np.pi / nodes)
    sine, apart = np.sqrt(np.maximum(1 - z * z, 0)), np.sqrt(1 - rho * rho)
    t_o = np.hypot(along * sine, z)
    height = 1 - ((x + 1) / 2)[:, None] * (1 + z / t_o)  # in the cap about the stretched view
    radius = np.sqrt(np.maximum(1 - height**2, 0))
    u, w = radius * np.cos(phi) + along * sine / t_o, radius * np.sin(phi)
    h = along * u, across * (rho * u + apart * w), np.maximum(height + z / t_o, 0)
    length = np.sqrt(h[0] ** 2 + h[1] ** 2 + h[2] ** 2)
    VoH, NoH = (sine * h[0] + z * h[2]) / length, h[2] / length
    NoL = np.maximum(2 * VoH * NoH - z, 0)
    out = 2 * VoH * h[0] / length - sine, 2 * VoH * h[1] / length
    t_i = np.sqrt((along * out[0] + across * rho * out[1]) ** 2 + (across * apart * out[1]) ** 2 + NoL**2)
    g1 = 2 * z / (z + t_o)
    masked = {  # G2
        "smith": lambda: 2 * z * NoL / np.maximum(t_o * NoL + t_i * z, 1e-30),
        "smith-separable": lambda: g1 * 2 * NoL / np.maximum(NoL + t_i, 1e-30),
        "v-cavity": lambda: np.minimum(1, 2 * NoH * np.minimum(z, NoL) / np.maximum(VoH, 1e-30)),
        "none": lambda: 1.0 * (NoL > 0),
    }[masking]()
    seen = masked / g1 * (weight / (2 * nodes))[:, None]
    grazing = (seen * np.clip(1 - VoH, 0, 1) ** 5).sum(axis=(1, 2))
    return np.stack([seen.sum(axis=(1, 2)) - grazing, grazing], axis=1)


def isotropic(masking: str, alpha: np.ndarray, NoV: np.ndarray) -> np.ndarray:
    """a, b and their means as shaders read them from the DFG table: (N, 4)."""
    return _lookup(dfg_albedos("ggx", masking)[:DFG_SIZE], NoV, alpha)


def interpolated(masking: str, cube: np.ndarray, along: np.ndarray, across: np.ndarray, rho: np.ndarray,
                 NoV: np.ndarray) -> np.ndarray:
    """a and b as shaders read them from `cube`, (NoV, across, along, 4): (N, 2)."""
    found = _lookup(cube, NoV, across, along)
    guess = isotropic(masking, along, NoV)[:, :2]
    return np.maximum(guess + found[:, :2] + influence(rho**2, across, NoV)[:, None] * found[:, 2:], 0)


def _lookup(table: np.ndarray, *places: np.ndarray) -> np.ndarray:
    """Linear between the values of the table, whose axes are square roots of the places, (N,)."""
    steps = [np.sqrt(np.clip(place, 0, 1)) * (count - 1) for place, count in zip(places, table.shape, strict=False)]
    low = [np.minimum(step.astype(int), count - 2) for step, count in zip(steps, table.shape, strict=False)]
    part = [(step - first)[:, None] for step, first in zip(steps, low, strict=True)]
    found = np.zeros((len(steps[0]), table.shape[-1]))
    for corner in np.ndindex(*(2 for _ in places)):
        share = np.prod([p if c else 1 - p for p, c in zip(part, corner, strict=True)], axis=0)
        found += share * table[tuple(first + c for first, c in zip(low, corner, strict=True))]
    return found


def _means(masking: str, cube: np.ndarray) -> np.ndarray:
    """2 int E mu dmu = int E 4 v^3 dv with v = sqrt(mu), and the mean over azimuths."""
    x, weight = np.polynomial.legendre.leggauss(4)
    v = ((np.arange(_PANELS)[:, None] + (x + 1) / 2) / _PANELS).ravel()
    weight = np.tile(weight / 2, _PANELS) / _PANELS * 4 * v**3
    azimuth = (np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS * np.pi / 2
    means = np.zeros((_ROWS, SIZE, 4))
    for row, alpha_b in enumerate(np.maximum(np.linspace(0, 1, _ROWS) ** 2, LEAST)):
        for column, alpha_t in enumerate(np.maximum(np.linspace(0, 1, SIZE) ** 2, LEAST)):
            along, across, rho = (np.repeat(kind, len(v)) for kind in seen_slopes(alpha_t, alpha_b, azimuth))
            found = interpolated(masking, cube, along, across, rho, np.tile(v**2, _AZIMUTHS))
            guess = isotropic(masking, np.hypot(alpha_t, alpha_b)[None] / np.sqrt(2), np.ones(1))[0, 2:]
            means[row, column, :2] = np.tile(weight, _AZIMUTHS) @ found / _AZIMUTHS - guess
    return means
