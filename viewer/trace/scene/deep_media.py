"""Media in which paths take long steps, since they would collide very often: shaders/media/deep_walk.glsl.

Many mean free paths from all surfaces and lamps the mean radiance phi of a homogeneous medium obeys

    nabla^2 phi = kappa^2 phi,    of which the mean over a sphere of radius R is phi(centre) sinh(kappa R) / (kappa R).

What the equation of transfer has besides decays as exp(-distance), in mean free paths (Case and Zweifel 1967, "Linear
Transport Theory"). kappa is 0 where nothing is absorbed. In a plane wave exp(kappa x) the radiance has a series of
Legendre polynomials P_l with the coefficients (2 l + 1) f_l, f_0 = 1, in units of the mean free path:

    (2 l + 1) (1 - albedo c_l) f_l = kappa ((l + 1) f_(l+1) + l f_(l-1)),    with c_l of the phase function.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...scene.medium import Medium
from ...scene.phase import spectrum
from ..layout import MEDIA_REACH
from .geometry import TraceGeometry

LEAST_ALBEDO = 0.995
"""Of one channel. Where all absorb more, a path has fewer than 200 collisions on average."""
MARGIN = 6.0
"""How far the spheres stay from surfaces and lamps, in mean free paths or, if it is longer, in the way over which light
forgets its direction."""
LEAST_DEPTH = 4.0
"""Half the side of the space that the medium fills, in margins."""
_TERMS = 128


def deep_media(geometry: TraceGeometry) -> dict[int, NDArray[np.float32]]:
    """The records, (2, 4) float32, of the media by their numbers: kappa of red, green and blue, and the margin; the
    mean and the half width of the first step along a direction; all in tracer units."""
    if geometry.curves is not None or (geometry.has_grids and geometry.fog is None):
        return {}  # the grid of `clearance` knows no curves, and volumes only as gaps of the fog
    records = {}
    for number, medium in enumerate(geometry.media):
        record = _record(medium, geometry.unit) if max(medium.albedo) >= LEAST_ALBEDO else None
        if record is not None and record[0, 3] * LEAST_DEPTH < _half_size(geometry, number):
            records[number] = record
    return records


def deep_texels(geometry: TraceGeometry) -> NDArray[np.float32]:
    """The section of the scene buffer: two texels for each medium, 0 where it has no record."""
    texels = np.zeros((len(geometry.media), 2, 4), np.float32)
    for number, record in deep_media(geometry).items():
        texels[number] = record
    return texels.reshape(-1, 4)


def decay(albedo: float, moments: NDArray[np.float64]) -> float:
    """kappa, in 1 / mean free path, of a medium whose phase function has these `moments` c_l: 1 / kappa is the greatest
    eigenvalue of the series above. At most 1."""
    if albedo >= 1:
        return 0.0
    order = np.arange(len(moments))
    weights = (2 * order + 1) * (1 - albedo * moments)
    sides = order[1:] / np.sqrt(weights[1:] * weights[:-1])
    return min(1.0 / float(np.linalg.eigvalsh(np.diag(sides, 1) + np.diag(sides, -1)).max()), 1.0)


def first_step(albedo: float, moments: NDArray[np.float64]) -> tuple[float, float]:
    """Mean and half width, in mean free paths, of a step along the direction of a path, from where on light counts as
    coming from all around: with it the terms l = 1 and 2 of the series stay."""
    absorbed, kappa = 1 - albedo, decay(albedo, moments)
    if absorbed < 1e-8:
        mean = 1 / (1 - moments[1])
        square = 2 * mean / (1 - moments[2])
    else:
        first = absorbed / kappa
        mean = 3 * first / kappa
        square = 15 * (3 * (1 - albedo * moments[1]) * first / kappa - 1) / (2 * kappa**2)
    return mean, math.sqrt(3 * max(square - mean**2, 0.0))


def _record(medium: Medium, unit: float) -> NDArray[np.float32] | None:
    """None for a medium that scatters unevenly, with another extinction in each channel."""
    moments = spectrum(medium, _TERMS)
    extinction = np.array(medium.sigma_t) * unit
    is_even = medium.phase == 0.0
    if not (extinction > 0).all() or not (is_even or np.ptp(extinction) == 0):
        return None
    path = 1 / extinction.min()
    mean, half = (0.0, 0.0) if is_even else first_step(max(medium.albedo), moments)
    kappa = np.array([decay(albedo, moments) for albedo in medium.albedo]) * extinction
    record = np.zeros((2, 4))
    record[0] = *kappa, MARGIN * path * max(1.0, mean)
    record[1, :2] = mean * path, half * path
    return record.astype(np.float32)


def _half_size(geometry: TraceGeometry, number: int) -> float:
    """Half the longest side of the largest solid that the medium fills, or the radius of the fog."""
    if number == 0:
        return MEDIA_REACH
    sizes = [np.abs(instance.transform[:, :3]).sum(axis=1).max() for instance in geometry.instances
             if instance.medium == number]
    return float(max(sizes, default=0.0))
