"""The filtered environment: the size and format of its levels, and samples in their place."""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np

from viewer.bake.prefilter import HEIGHT, LEVEL_ROUGHNESS, irradiance_map, prefilter
from viewer.scene.mip_levels import mip_levels

from .light import NAMES, levels_texture, radiance, sphere_points, texels
from .piece import SHADERS, Case, Kernel, Piece, Variant, relative

_ROUGHNESS = (0.22, 0.3, 0.45, 0.58, 0.75, 1.0)
_OVER = f"directions all around, roughness 0.22 to 1, in {' and '.join(NAMES)} without the sun"
_TRUTH = "the sum over all texels in float64"
_SAMPLED = "sampled_reflection(u_map, p.xyz, p.w, {count})"


def lookup_piece(heights: tuple[int, ...] = (128, 256, HEIGHT, 1024)) -> Piece:
    """A frame's look-up; p is a direction and a roughness."""
    variants = [_map(height, np.float16) for height in heights]
    variants.append(_map(HEIGHT, np.float32))
    variants += [Variant(f"{count} samples in the shader", _sampling(count), "Krivanek & Colbert 2008",
                         sum(level.nbytes for level in _plain_levels(NAMES[0]))) for count in (4, 16, 64)]
    return Piece("prefilter", "The environment filtered for a rough surface", _OVER, "shares of the radiance", _TRUTH,
                 _cases(_ROUGHNESS), tuple(variants),
                 "What errs is the blend of two levels; more texels would only serve the mirror.")


def bake_piece() -> Piece:
    """The filtering itself, at roughnesses that a level is for, where between levels nothing is blended."""
    texel_count = sum((HEIGHT >> k) * (2 * HEIGHT >> k) for k in range(1, len(LEVEL_ROUGHNESS)))
    baked = _map(HEIGHT, np.float32)
    seconds = float(np.mean([_levels(name, HEIGHT)[1] for name in NAMES]))
    exact = Variant("spherical harmonics", baked.kernels, "exact convolution, on the processor", baked.size,
                    seconds, True, seconds / texel_count * 1e9)
    sampled = [Variant(f"{count} samples a texel", _sampling(count), "Karis 2013; Krivanek & Colbert 2008", baked.size)
               for count in (16, 32, 64, 256)]
    return Piece("prefilter-bake", "Filtering the environment, once", _OVER, "shares of the radiance", _TRUTH,
                 _cases(tuple(r for r in LEVEL_ROUGHNESS if r >= 0.2)), (exact, *sampled),
                 "Exact but for the rows of the smallest levels, without any graphics card, and kept in the cache.",
                 per="texel of the levels")


def _cases(roughness: tuple[float, ...]) -> tuple[Case, ...]:
    directions = sphere_points(64)
    parameters = np.empty((len(directions), len(roughness), 4), np.float32)
    parameters[..., :3], parameters[..., 3] = directions[:, None], roughness
    return tuple(Case(parameters, relative(_filtered(name, roughness))) for name in NAMES)


@lru_cache(maxsize=4)
def _filtered(name: str, roughness: tuple[float, ...]) -> np.ndarray:
    """The lobes D(theta / 2) cos(theta) of viewer/bake/lobes.py over a map of 256 x 512: (64, len(roughness), 3)."""
    directions, light, solid_angles = texels(name, 256)
    weighted = np.concatenate([light, np.ones((len(light), 1))], axis=1) * solid_angles[:, None]
    result = np.empty((64, len(roughness), 3))
    for row, direction in enumerate(sphere_points(64)):
        cosine = directions @ direction
        above = cosine > 0
        cosine, near = cosine[above], weighted[above]
        for column, r in enumerate(roughness):
            # D of GGX at half the angle, cos^2 = (1 + cos) / 2
            lobe = cosine / (1 + (float(r) ** 4 - 1) * (1 + cosine) / 2) ** 2
            sums = lobe @ near
            result[row, column] = sums[:3] / sums[3]
    return result


@lru_cache(maxsize=8)
def _levels(name: str, height: int) -> tuple[list[np.ndarray], float]:
    """The renderer's levels of a built-in environment, and the processor's seconds they take."""
    started = time.process_time()
    found, _ = prefilter(radiance(name), height=height)
    return found, time.process_time() - started


def levels(name: str, height: int = HEIGHT, dtype: type = np.float16) -> list[np.ndarray]:
    """The mip chain of a built-in environment, by default as the renderer stores it."""
    return [level.astype(dtype) for level in _levels(name, height)[0][:-1]]


def wide_levels(name: str) -> list[np.ndarray]:
    """Irradiance / pi and the widest level, as the renderer stores them."""
    return [level.astype(np.float16) for level in (irradiance_map(radiance(name)), _levels(name, HEIGHT)[0][-1])]


def _map(height: int, dtype: type) -> Variant:
    baked = [levels(name, height, dtype) for name in NAMES]
    seconds = float(np.mean([_levels(name, height)[1] for name in NAMES]))
    call = "vec4(prefiltered_radiance(u_map, p.xyz, lod_of_roughness(p.w)), 0.0)"
    kernels = tuple(Kernel("light/prefiltered.glsl", call, {"u_map": levels_texture(found)}) for found in baked)
    kind = "half" if dtype is np.float16 else "float"
    return Variant(f"levels from {2 * height} x {height}, {kind}", kernels, "exact convolution",
                   sum(level.nbytes for level in baked[0]), seconds, height == HEIGHT and dtype is np.float16)


def _sampling(count: int) -> tuple[Kernel, ...]:
    call = f"vec4({_SAMPLED.format(count=count)}, 0.0)"
    return tuple(Kernel(SHADERS / "reflection.glsl", call, {"u_map": levels_texture(_plain_levels(name))})
                 for name in NAMES)


@lru_cache(maxsize=2)
def _plain_levels(name: str) -> list[np.ndarray]:
    return mip_levels(radiance(name).astype(np.float16))
