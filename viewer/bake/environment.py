"""Bakes an environment for image-based lighting, with a cache on disk."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np

from ..base.heap import trim_heap
from ..scene.environment import Environment
from ..scene.equirect import shrink
from ..scene.light import Light
from ..settings import NDFS
from . import cache as disk
from .background import background_map
from .prefilter import HEIGHT, LEVELS, WIDTH, irradiance_map, prefilter
from .sun import extract_sun

HALF_CEILING = 32768.0  # levels are scaled so that their maximum is below it and fits a half float, in any units


@dataclass(frozen=True, eq=False)
class BakedEnvironment:
    """An environment baked for image-based lighting, without its rotation and intensity.

    `levels` is the prefiltered mip chain (shaders/light/prefiltered.glsl), six arrays (512, 1024, 3) to (16, 32, 3)
    float16, top row first, for wrap modes repeat in u and clamp in v, and then the widest level, (32, 64, 3). It is
    empty if it was not requested. `irradiance` is irradiance / pi, (64, 128, 3) float16, with the same layout; the
    widest level is the next level of its mip chain. All are divided by `scale` (a power of two), so shaders multiply
    what they read by it. `suns` are directional lights, in units of the environment, that were removed
    from the levels and the irradiance. `background` is the map with its suns, see `background_map`.
    """

    levels: tuple[np.ndarray, ...]
    irradiance: np.ndarray
    scale: float
    suns: tuple[Light, ...]
    background: np.ndarray | None


def bake_environment(
    environment: Environment, ndf: str = "ggx", cache: bool = True, levels: bool = True
) -> BakedEnvironment:
    """The environment prefiltered for the lobes of the distribution `ndf` (one of NDFS), from the cache if possible.

    A cached bake does not access the environment's pixels, so its file is not decoded. `cache=False` neither reads nor
    writes the cache. Without `levels`, which take four fifths of the time, the result serves everything except
    reflections. Raises InputError for an environment file that cannot be decoded.
    """
    if ndf not in NDFS:
        raise ValueError(f"there is no distribution {ndf!r}; choose one of {', '.join(NDFS)}")
    names = []
    if cache and disk.cache_folder() is not None:
        digest = environment.digest or _digest(environment.radiance)
        names = [disk.key("environment", digest, ndf)] + [disk.key("irradiance", digest)] * (not levels)
        for name in names:
            stored = disk.load(name)
            if stored is not None:
                return _from_arrays(stored)
    arrays = _bake(environment, ndf, levels)
    trim_heap()  # baking leaves 40 MB of free memory that nothing else uses
    if names:
        disk.store(names[-1], arrays)
    return _from_arrays(arrays)


def _bake(environment: Environment, ndf: str, with_levels: bool) -> dict[str, np.ndarray]:
    radiance = environment.radiance
    arrays = {"background": background_map(radiance)}
    # A map much larger than the levels is reduced first. A sun is still compact then, and found much faster.
    sunless, suns = extract_sun(replace(environment, source=shrink(radiance, HEIGHT, WIDTH)))
    del radiance
    levels, irradiance = prefilter(sunless.radiance, ndf) if with_levels else ([], irradiance_map(sunless.radiance))
    peak = max(float(level.max()) for level in [*levels, irradiance])
    scale = 2.0 ** np.ceil(np.log2(peak / HALF_CEILING)) if peak > 0 else 1.0
    arrays |= {f"level{k}": (level * np.float32(1 / scale)).astype(np.float16) for k, level in enumerate(levels)}
    arrays["irradiance"] = (irradiance * np.float32(1 / scale)).astype(np.float16)
    arrays["scale"] = np.array([scale])
    arrays["suns"] = np.array(
        [[*sun.direction, *sun.color, sun.intensity, sun.angular_radius] for sun in suns], np.float64).reshape(-1, 8)
    return arrays


def _from_arrays(arrays: dict[str, np.ndarray]) -> BakedEnvironment:
    suns = (row.tolist() for row in arrays["suns"])
    return BakedEnvironment(
        levels=tuple(arrays[f"level{k}"] for k in range(LEVELS) if f"level{k}" in arrays),
        irradiance=arrays["irradiance"].copy(),  # a view would keep the whole cache entry in memory
        scale=float(arrays["scale"][0]),
        suns=tuple(Light("directional", tuple(r[3:6]), r[6], direction=tuple(r[:3]), angular_radius=r[7], name="sun")
                   for r in suns),
        background=arrays["background"],
    )


def _digest(radiance: np.ndarray) -> str:
    return hashlib.blake2b(np.ascontiguousarray(radiance).data, digest_size=20).hexdigest() + str(radiance.shape)
