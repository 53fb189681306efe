"""Light that a medium scatters many times, by the diffusion equation on a grid.

    -div(D grad phi) + sigma_a phi = sigma_s phi_0,    D = 1 / (3 (sigma_a + (1 - g) sigma_s))

phi_0 is the fluence of light that has not been scattered yet, and phi that of light that has (Ishimaru 1978, chapter
9). Nothing scattered comes in through the faces of the grid: D dphi/dn = -phi / 2 there (Marshak's condition).

Diffusion is an approximation where a medium is thin. But its error is known for one case: in a medium that absorbs
nothing, under light of radiance 1 from everywhere, all radiance is 1, so that phi = 4 pi - phi_0. We solve this case,
too, and the ratio of its solutions corrects the others.
"""

from __future__ import annotations

import numpy as np

MAX_ITERATIONS, TOLERANCE = 300, 1e-3
_MOST_CORRECTED = 1e3
_THICKEST = 1e6
"""The optical depth of a cell from which on a medium is no thicker for the solver."""


def scattered_fluence(extinction: np.ndarray, unscattered: np.ndarray, hidden: np.ndarray, cell: float,
                      albedo: tuple[float, float, float], g: float) -> np.ndarray:
    """The fluence of light that has been scattered at least once, (n, n, n, 3) float32.

    `extinction` (n, n, n) per unit of length; `cell` is the length of a cell. `unscattered` (n, n, n, 4) is the mean
    fluence in a cell of light before its first collision, and in the last channel that of light that has the fluence 1
    outside, the same from everywhere. `hidden` (n, n, n) is the mean opacity towards the outside over all directions.
    """
    sigma_t = np.clip(extinction, 0, _THICKEST / cell).astype(np.float32) * np.float32(cell)
    albedos = np.array([*albedo, 1.0], np.float32)[:, None, None, None]
    hidden = np.clip(hidden, 0, 1)
    light = np.moveaxis(unscattered, -1, 0).astype(np.float64)
    scale = np.maximum(light.max(axis=(1, 2, 3), keepdims=True), 1e-300)
    source = (sigma_t * albedos * (light / scale)).astype(np.float32)
    phi = _solve(sigma_t, albedos, g, source) * scale
    correction = hidden / np.maximum(phi[3], 1e-30)
    phi = phi[:3] * np.minimum(correction, _MOST_CORRECTED)
    return np.ascontiguousarray(np.moveaxis(np.maximum(phi, 0), 0, -1), np.float32)


def _solve(sigma_t: np.ndarray, albedos: np.ndarray, g: float, source: np.ndarray) -> np.ndarray:
    """Conjugate gradients, preconditioned by the diagonal, for unit cells and each albedo (k, 1, 1, 1)."""
    vacuum = np.float32(1 / len(sigma_t))  # a mean free path is no longer than the grid
    reduced = sigma_t * (1 - albedos * np.float32(g)) + vacuum
    resistance = 1.5 * reduced  # of half a cell: 1 / (2 D)
    faces = [1 / (_before(resistance, axis) + _after(resistance, axis)) for axis in (1, 2, 3)]
    diagonal = sigma_t * (1 - albedos)
    for axis, face in zip((1, 2, 3), faces, strict=True):
        _before(diagonal, axis)[...] += face
        _after(diagonal, axis)[...] += face
        for end in (0, -1):
            at = [slice(None)] * 4
            at[axis] = end  # type: ignore[call-overload]
            diagonal[tuple(at)] += 1 / (resistance[tuple(at)] + 2)

    def apply(phi: np.ndarray) -> np.ndarray:
        result = diagonal * phi
        for axis, face in zip((1, 2, 3), faces, strict=True):
            _before(result, axis)[...] -= face * _after(phi, axis)
            _after(result, axis)[...] -= face * _before(phi, axis)
        return result

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
    return np.moveaxis(np.moveaxis(values, axis, 0)[:-1], 0, axis)


def _after(values: np.ndarray, axis: int) -> np.ndarray:
    return np.moveaxis(np.moveaxis(values, axis, 0)[1:], 0, axis)
