"""The split sum: where the filtered environment is looked up, against the integral of lobe times light."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from viewer.bake.dfg import SIZE, dfg_table
from viewer.bake.lobe_samples import lobe_samples
from viewer.bake.lobes import lobe_spectrum
from viewer.bake.prefilter import level_of_roughness
from viewer.measure.check.reference import smith_lambda

from .light import NAMES, levels_texture, map_texture, seen, sphere_points
from .piece import SHADERS, Case, Kernel, Piece, Variant, logarithmic
from .prefilter import levels, wide_levels

_NOV = np.array([0.1, 0.25, 0.45, 0.7, 0.95])
_ROUGHNESS = np.array([0.25, 0.4, 0.55, 0.7, 0.85, 1.0])
_NORMALS, _SAMPLES = 12, 2048
_VIEW = "p.xyz, q.xyz, p.w, q.w"
_WAYS = (
    ("two lookups and the irradiance", f"reflected_by_lookups(u_map, u_dfg, u_irradiance, {_VIEW}, 2)",
     "viewer/bake/lookups.py"),
    ("one lookup and the irradiance", f"reflected_by_lookups(u_map, u_dfg, u_irradiance, {_VIEW}, 1)",
     "viewer/bake/lookups.py"),
    ("each part's mean direction", f"reflected_by_parts(u_map, u_dfg, u_means, {_VIEW})", "two look-ups"),
    ("the parts' common mean direction", f"reflected_by_whole(u_map, u_dfg, u_means, {_VIEW})", "one look-up"),
    ("Frostbite's fit of the peak", f"reflected_by_peak(u_map, u_dfg, {_VIEW})", "Lagarde & de Rousiers 2014"),
    ("mirror direction", f"reflected_by_mirror(u_map, u_dfg, {_VIEW})", "Karis 2013"),
)
_REASON = ("An oblique lobe is stretched in the plane of incidence, so it takes two narrower ones. The irradiance, "
           "which the surface needs anyhow, stands for the wide tails.")


def dielectric_piece() -> Piece:
    return _piece("split-sum-dielectric", "Reflection of the environment, dielectrics", 0.04)


def metal_piece() -> Piece:
    return _piece("split-sum-metal", "Reflection of the environment, metals", 0.9)


def _piece(name: str, title: str, f0: float) -> Piece:
    """p is the normal and a roughness, q the direction to the viewer and f0."""
    n, v, roughness = _views()
    parameters = np.concatenate([n, roughness[..., None], v, np.full((*roughness.shape, 1), f0)], axis=-1)
    parameters = parameters.reshape(len(n), -1, 8).astype(np.float32)
    cases, textures = [], []
    for environment in NAMES:
        truth = _integrals(environment, n, v, roughness, f0).reshape(len(n), -1, 3)
        cases.append(Case(parameters, logarithmic(truth)))
        textures.append({"u_map": levels_texture(levels(environment)), "u_dfg": map_texture(dfg_table()),
                         "u_irradiance": levels_texture(wide_levels(environment)),
                         "u_means": map_texture(_mean_directions())})
    size = sum(level.nbytes for level in levels(NAMES[0])) + dfg_table().nbytes
    variants = tuple(
        Variant(words, tuple(Kernel(SHADERS / "reflection.glsl", f"vec4({call}, 0.0)",
                                    {used: make for used, make in some.items() if used in call}) for some in textures),
                source, size, is_default=call == _WAYS[0][1])
        for words, call, source in _WAYS)
    over = f"NoV 0.1 to 0.95, roughness 0.25 to 1, f0 {f0:g}, in {' and '.join(NAMES)} without the sun"
    return Piece(name, title, over, "the radiance's logarithm", f"integral by {_SAMPLES} visible normals in float64",
                 tuple(cases), variants, _REASON)


@lru_cache(maxsize=1)
def _mean_directions() -> np.ndarray:
    """The first moment M = <l> / <1> of each part of the lobe, as a direction and a width, (SIZE, SIZE, 4) float32: t
    of mix(n, r, t) for the parts a and b, then the levels whose filter has lambda_1 = |M|. Rows and columns are those
    of `dfg_table`."""
    axis = np.arange(SIZE) / (SIZE - 1)
    NoV = np.maximum(axis**2, 1e-4)
    NoV[-1] = np.cos(1e-3)
    roughness = np.linspace(0.02, 1, 65)
    concentration = [lobe_spectrum("ggx", r * r, 1)[1] for r in roughness]
    table = np.empty((SIZE, SIZE, 4))
    for column, r in enumerate(axis):
        directions, parts = lobe_samples("ggx", "smith", NoV, max(r, 0.02) ** 2, 24)
        along_n, along_t = (np.einsum("jsp,js->pj", parts, directions[..., k]) for k in (0, 1))
        slope = np.sqrt(1 - NoV**2) * along_n + (1 - NoV) * along_t
        table[:, column, :2] = np.clip(along_t / np.maximum(slope, 1e-60), -0.5, 5).T
        length = np.hypot(along_n, along_t).T / parts.sum(axis=1)
        width = np.interp(-length, -np.array(concentration), roughness)
        table[:, column, 2:] = level_of_roughness(width)
    return table.astype(np.float32)


def _views() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Normals, views (M, NoV, roughness, 3) and roughnesses (M, NoV, roughness)."""
    normals = sphere_points(_NORMALS)
    shape = (_NORMALS, len(_NOV), len(_ROUGHNESS))
    tangents = _frame(normals)[0]
    n = np.broadcast_to(normals[:, None, None], (*shape, 3))
    v = _NOV[None, :, None, None] * n + np.sqrt(1 - _NOV**2)[None, :, None, None] * tangents[:, None, None]
    return n, v, np.broadcast_to(_ROUGHNESS, shape)


def _frame(n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    up = np.where(np.abs(n[..., 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    tangent = np.cross(up, n)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    return tangent, np.cross(n, tangent)


def _integrals(environment: str, n: np.ndarray, v: np.ndarray, roughness: np.ndarray, f0: float) -> np.ndarray:
    """int L f NoL dl by visible normals on a spherical cap (Dupuy & Benyoub 2023), weight F G2 / G1."""
    tangent, across = _frame(n)
    local_v = np.stack([(v * axis).sum(axis=-1) for axis in (tangent, across, n)], axis=-1)
    alpha = np.repeat(roughness[..., None] ** 2, 2, axis=-1)
    total = np.zeros(n.shape)
    for first in range(0, _SAMPLES, 256):
        k = np.arange(first, first + 256) + 0.5
        # The R2 sequence (Roberts 2018)
        u1, u2 = (k * 0.7548776662466927) % 1, (k * 0.5698402909980532) % 1
        wi, VoH = _reflected(local_v[..., None, :], alpha[..., None, :], u1, u2)
        F = f0 + (1 - f0) * (1 - VoH) ** 5
        of_v, of_l = smith_lambda(local_v, alpha)[..., None], smith_lambda(wi, alpha[..., None, :])
        weight = np.where(wi[..., 2] > 0, F * (1 + of_v) / (1 + of_v + of_l), 0.0)
        world = sum(wi[..., axis, None] * vector[..., None, :] for axis, vector in enumerate((tangent, across, n)))
        total += (seen(environment, world) * weight[..., None]).sum(axis=-2)
    return total / _SAMPLES


def _reflected(v: np.ndarray, alpha: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    stretched = np.concatenate([v[..., :2] * alpha, v[..., 2:]], axis=-1)
    stretched /= np.linalg.norm(stretched, axis=-1, keepdims=True)
    z = (1 - u2) * (1 + stretched[..., 2]) - stretched[..., 2]
    sine, phi = np.sqrt(np.maximum(1 - z * z, 0)), 2 * np.pi * u1
    h = np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=-1) + stretched
    h = np.concatenate([h[..., :2] * alpha, np.maximum(h[..., 2:], 1e-9)], axis=-1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    VoH = np.clip((v * h).sum(axis=-1), 0, 1)
    return 2 * VoH[..., None] * h - v, VoH
