"""Light that a medium scatters many times, by the diffusion equation on a grid.

    -div(D grad phi) + sigma_a phi = sigma_s phi_0 - div(3 D g sigma_s F_0),    D = 1 / (3 (sigma_a + (1 - g) sigma_s))

phi_0 and F_0 are the fluence and the flux of light that has not been scattered yet, and phi is the fluence of light
that has (Ishimaru 1978, chapter 9). A phase function with a narrow peak has to lose it first (`similarity.py`). Nothing
scattered comes in through the faces of the grid: D dphi/dn = -phi / 2 there (Marshak's condition).

Diffusion is an approximation where a medium is thin. But its error is known for one case: in a medium that absorbs
nothing, under light of radiance 1 from everywhere, all radiance is 1, so that phi = 4 pi - phi_0. We solve this case,
too, and the ratio of its solutions corrects the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

MAX_ITERATIONS, TOLERANCE = 300, 1e-3
MOST_CORRECTED = 1e3
_AXES = 3, 2, 1
"""Of arrays (k, n, n, n), those along x, y and z."""
_THICKEST = 1e3
"""The optical depth of a cell from which on a medium is no thicker for the solver."""


@dataclass(frozen=True, eq=False)
class Scattered:
    """Light that has been scattered at least once, at the centres of cells.

    `fluence` is (n, n, n, 3) float32. Its radiance from a direction d is greater by 1 + v . d than light from where the
    outside is hidden would be, with v `origin` (n, n, n, 3) float32: all of it in the furnace, where v is 0.
    """

    fluence: np.ndarray
    origin: np.ndarray


def scattered_light(extinction: np.ndarray, unscattered: np.ndarray, flux: np.ndarray, hidden: np.ndarray, cell: float,
                    albedo: tuple[float, float, float], g: float) -> Scattered:
    """`extinction` (n, n, n) is per unit of length; `cell` is the length of a cell. `unscattered` (n, n, n, 4) is the
    mean fluence in a cell of light before its first collision, and in the last channel that of light that has the
    fluence 1 outside, the same from everywhere. `flux` (3, n, n, n, 4) is the flux of this light along x, y and z.
    `hidden` (n, n, n) is the mean opacity towards the outside over all directions.
    """
    depth = np.clip(extinction, 0, 1e30) * np.float64(cell)
    sigma_t = thinned(depth)
    albedos = np.array([*albedo, 1.0], np.float32)[:, None, None, None]
    hidden = np.clip(hidden, 0, 1)
    light = np.moveaxis(unscattered, -1, 0).astype(np.float64)
    scale = np.maximum(light.max(axis=(1, 2, 3), keepdims=True), 1e-300)
    source = (depth * albedos * (light / scale)).astype(np.float32)
    # 3 D g sigma_s F_0 at faces: light that is scattered once tends to go on as it went
    forward = (np.moveaxis(flux, -1, 1) / scale) * (albedos * g * sigma_t / _reduced(sigma_t, albedos, g))
    carried = [((_before(along, axis) + _after(along, axis)) / 2).astype(np.float32)
               for along, axis in zip(forward, _AXES, strict=True)]
    for face, axis in zip(carried, _AXES, strict=True):
        _before(source, axis)[...] -= face
        _after(source, axis)[...] += face
    phi = solve(sigma_t, albedos, _reduced(sigma_t, albedos, g), source)
    flow = [part * scale for part in diffuse_flux(phi, 1.5 * _reduced(sigma_t, albedos, g), carried)]
    lit, furnace = (origin_of((phi * scale)[channels], [part[channels] for part in flow])
                    for channels in (slice(3), slice(3, 4)))
    origin = (lit - furnace) * hidden[..., None]
    correction = np.minimum(hidden / np.maximum(phi[3] * scale[3], 1e-30), MOST_CORRECTED)
    fluence = np.maximum(phi[:3] * scale[:3] * correction, 0)
    return Scattered(np.ascontiguousarray(np.moveaxis(fluence, 0, -1), np.float32), origin.astype(np.float32))


def diffuse_flux(phi: np.ndarray, resistance: np.ndarray,
                 carried: Sequence[ArrayLike] = (0.0, 0.0, 0.0)) -> list[np.ndarray]:
    """-D grad phi + 3 D g sigma_s F_0 along x, y and z at the centres, as means of the faces."""
    result = []
    for forward, axis in zip(carried, _AXES, strict=True):
        between = _before(resistance, axis) + _after(resistance, axis)
        face = forward + (_before(phi, axis) - _after(phi, axis)) / between
        along = np.zeros_like(phi)
        _before(along, axis)[...] += face / 2
        _after(along, axis)[...] += face / 2
        result.append(along)
    return result


def origin_of(phi: np.ndarray, flux: Sequence[np.ndarray]) -> np.ndarray:
    """Diffuse light of flux J has the radiance (phi - 3 J . d) / 4 pi from the direction d. -3 J / phi of all channels
    together, (n, n, n, 3), no more than at a surface (Marshak's)."""
    total = np.maximum(phi.sum(axis=0), 1e-30)
    along = np.stack([part.sum(axis=0) / total for part in flux], axis=-1)
    return np.clip(-3 * along, -1.5, 1.5)


def _reduced(sigma_t: np.ndarray, albedos: np.ndarray, g: float) -> np.ndarray:
    """1 / 3 D of unit cells; a mean free path is taken to be no longer than the grid."""
    return sigma_t * (1 - albedos * np.float32(g)) + np.float32(1 / len(sigma_t))


def thinned(depth: np.ndarray) -> np.ndarray:
    """`depth`, the optical depth of cells, as thick as `solve` can take it."""
    return np.minimum(depth, _THICKEST).astype(np.float32)


def solve(sigma_t: np.ndarray, albedos: np.ndarray, reduced: np.ndarray, source: np.ndarray) -> np.ndarray:
    """The fluence (k, n, n, n) of k media at once, in cells of side 1, by conjugate gradients that are preconditioned
    by the diagonal. `sigma_t` (n, n, n) or (k, n, n, n) and `albedos` (k, 1, 1, 1) or (k, n, n, n) are those of the
    media; `reduced` and `source` (k, n, n, n) float32 are 1 / 3 D and the right side of the equation."""
    resistance = 1.5 * reduced  # of half a cell: 1 / (2 D)
    diagonal = sigma_t * (1 - albedos)
    faces = []  # by the cells before them, and 0 for the last, which has none
    for axis in (1, 2, 3):
        face = np.zeros_like(resistance)
        _before(face, axis)[...] = 1 / (_before(resistance, axis) + _after(resistance, axis))
        _before(diagonal, axis)[...] += _before(face, axis)
        _after(diagonal, axis)[...] += _before(face, axis)
        faces.append(face.ravel())
        for end in (0, -1):
            at = (slice(None),) * axis + (end,)
            diagonal[at] += 1 / (resistance[at] + 2)
    _, _, height, width = diagonal.shape
    strides = [height * width, width, 1]  # from a cell to the next one along z, y and x
    flow = np.empty(diagonal.size, diagonal.dtype)

    def apply(phi: np.ndarray) -> np.ndarray:
        result, phi = (diagonal * phi).ravel(), phi.ravel()
        for face, stride in zip(faces, strides, strict=True):  # in whole arrays, which are longer than rows of a grid
            result[:-stride] -= np.multiply(face[:-stride], phi[stride:], out=flow[:-stride])
            result[stride:] -= np.multiply(face[:-stride], phi[:-stride], out=flow[:-stride])
        return result.reshape(diagonal.shape)

    def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.einsum("kzyx,kzyx->k", a, b, dtype=np.float64)[:, None, None, None]

    phi = np.zeros_like(source)
    residual = source.copy()
    scaled = residual / diagonal
    direction, rho = scaled.copy(), dot(residual, scaled)
    target = rho * TOLERANCE**2
    for _ in range(MAX_ITERATIONS):
        if (rho <= target).all():
            break
        applied = apply(direction)
        step = rho / np.maximum(dot(direction, applied), 1e-300)
        phi += step.astype(np.float32) * direction
        residual -= step.astype(np.float32) * applied
        scaled = residual / diagonal
        before, rho = rho, dot(residual, scaled)
        direction = scaled + (rho / np.maximum(before, 1e-300)).astype(np.float32) * direction
    return phi


def _before(values: np.ndarray, axis: int) -> np.ndarray:
    """A view of the cells that have another behind them along an axis."""
    return values[(slice(None),) * axis + (slice(-1),)]


def _after(values: np.ndarray, axis: int) -> np.ndarray:
    return values[(slice(None),) * axis + (slice(1, None),)]
