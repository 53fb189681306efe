"""Irradiance: the map at several sizes, and spherical harmonics of several degrees."""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np

from viewer.bake.irradiance import HEIGHT, cosine_spectrum
from viewer.bake.prefilter import irradiance_map

from .light import NAMES, map_texture, radiance, sphere_points, texels
from .piece import SHADERS, Case, Kernel, Piece, Variant, absolute

_WINDOW = 0.005
"""Weighs degree l by 1 / (1 + w l^2 (l + 1)^2) (Sloan 2008, "Stupid Spherical Harmonics Tricks", windowing)."""
_ROWS, _BLOCK = 256, 4


def irradiance_piece(sizes: tuple[int, ...] = (16, 32, HEIGHT, 128)) -> Piece:
    """p is a normal."""
    normals = sphere_points(1024).reshape(32, 32, 3)
    parameters = np.concatenate([normals, np.zeros((32, 32, 1))], axis=2).astype(np.float32)
    cases = []
    for name in NAMES:
        truth = _irradiance_over_pi(name, normals)
        cases.append(Case(parameters, absolute(truth, truth.mean())))
    variants = [_map(rows, dtype) for rows in sizes for dtype in (np.float16, np.float32)]
    variants += [_harmonics(degree, window) for degree in (1, 2, 4) for window in (0.0, _WINDOW)]
    over = f"all normals, in {' and '.join(NAMES)} without the sun"
    return Piece("irradiance", "Irradiance of the environment", over,
                 "shares of the mean", "the sum over all texels in float64", tuple(cases), tuple(variants),
                 "A look-up costs the same whatever the size; harmonics err ten times as much at four times the cost.")


def _irradiance_over_pi(name: str, normals: np.ndarray) -> np.ndarray:
    """The sum over blocks of texels, each by its first moment: exact for all that no horizon crosses."""
    directions, light, solid_angles = texels(name, _ROWS)
    moments = directions[:, :, None] * (light * solid_angles[:, None])[:, None, :]
    blocks = moments.reshape(_ROWS // _BLOCK, _BLOCK, 2 * _ROWS // _BLOCK, _BLOCK, 3, 3).sum(axis=(1, 3))
    blocks = blocks.reshape(-1, 3, 3)
    return np.stack([np.maximum(np.tensordot(row, blocks, (1, 1)), 0).sum(axis=1) for row in normals]) / np.pi


def _map(rows: int, dtype: type) -> Variant:
    started = time.process_time()
    maps: list[np.ndarray] = [irradiance_map(radiance(name), rows).astype(dtype) for name in NAMES]
    bake = (time.process_time() - started) / len(NAMES)
    kernels = tuple(Kernel("light/irradiance.glsl", "vec4(irradiance_over_pi(u_map, p.xyz), 0.0)",
                           {"u_map": map_texture(pixels)}) for pixels in maps)
    kind = "half" if dtype is np.float16 else "float"
    return Variant(f"map {2 * rows} x {rows}, {kind}", kernels, "exact convolution", maps[0].nbytes, bake,
                   rows == HEIGHT and dtype is np.float16)


def _harmonics(degree: int, window: float) -> Variant:
    kernels = []
    for name in NAMES:
        _, light, solid_angles = texels(name, _ROWS)
        basis, degrees = _basis(degree)
        weights = solid_angles @ basis**2
        spectrum = cosine_spectrum(degree)[degrees] / (1 + window * (degrees * (degrees + 1)) ** 2)
        coefficients = (basis * solid_angles[:, None]).T @ light * (spectrum / weights)[:, None]
        kernels.append(Kernel(SHADERS / "irradiance.glsl", "vec4(sh_irradiance_over_pi(p.xyz), 0.0)",
                              uniforms={"u_sh": coefficients}, defines={"DEGREE": degree}))
    terms = len(coefficients)
    return Variant(f"{terms} harmonics to degree {degree}{', windowed' if window else ''}", tuple(kernels),
                   "Ramamoorthi & Hanrahan 2001", 12 * terms)


@lru_cache(maxsize=3)
def _basis(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """The functions of irradiance.glsl at all texels, (N, terms), and their degrees."""
    x, y, z = texels(NAMES[0], _ROWS)[0].T
    functions = [1 + 0 * x, x, y, z]
    if degree >= 2:
        functions += [x * y, y * z, z * x, 3 * z**2 - 1, x**2 - y**2]
    if degree == 4:
        functions += [x * y * (x**2 - y**2), y * z * (3 * x**2 - y**2), x * y * (7 * z**2 - 1), y * z * (7 * z**2 - 3),
                      35 * z**4 - 30 * z**2 + 3, z * x * (7 * z**2 - 3), (x**2 - y**2) * (7 * z**2 - 1),
                      z * x * (x**2 - 3 * y**2), x**4 - 6 * x**2 * y**2 + y**4]
    degrees = np.array([0] + [1] * 3 + [2] * 5 + [4] * 9)[: len(functions)]
    return np.stack(functions, axis=-1), degrees
