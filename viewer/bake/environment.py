"""Everything the shaders need of an environment, baked once and kept."""

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
from .prefilter import HEIGHT, LEVEL_ROUGHNESS, WIDTH, irradiance_map, prefilter
from .sun import extract_sun

HALF_CEILING = 32768.0  # levels are scaled to peak below this: all of half's range, whatever the map's units


@dataclass(frozen=True, eq=False)
class BakedEnvironment:
    """An environment prepared for image-based light, before its rotation and intensity.

    `levels`: the mip chain of `prefiltered.glsl`'s texture, six arrays (512, 1024, 3) to (16, 32, 3) float16, top row
    first, wrap repeat in u and clamp in v; none where nobody asked for them. `irradiance`: over pi, (64, 128, 3)
    float16, laid out alike. Both are in units of `scale` (a power of two): multiply what the shader looks up by it,
    along with the intensity. `suns` are directional lights in true units that were taken out of the levels and the
    irradiance. `background` is the map as it is, suns and all: see `background_map`.
    """

    levels: tuple[np.ndarray, ...]
    irradiance: np.ndarray
    scale: float
    suns: tuple[Light, ...]
    background: np.ndarray | None


def bake_environment(
    environment: Environment, ndf: str = "ggx", cache: bool = True, levels: bool = True
) -> BakedEnvironment:
    """The environment filtered for the lobes of `ndf` (one of NDFS), from the cache where that has it.

    A cached bake does not touch the environment's pixels, so its file is not even decoded. `cache=False` neither reads
    nor writes the cache. Without `levels`, four fifths of the work, it serves for all but reflections.
    """
    if ndf not in NDFS:
        raise ValueError(f"no lobe {ndf!r}; there are {', '.join(NDFS)}")
    names = []
    if cache and disk.cache_folder() is not None:
        digest = environment.digest or _digest(environment.radiance)
        names = [disk.key("environment", digest, ndf)] + [disk.key("irradiance", digest)] * (not levels)
        for name in names:
            stored = disk.load(name)
            if stored is not None:
                return _from_arrays(stored)
    arrays = _bake(environment, ndf, levels)
    trim_heap()  # 40 MB that nothing else will want
    if names:
        disk.store(names[-1], arrays)
    return _from_arrays(arrays)


def is_baked(environment: Environment, ndf: str = "ggx") -> bool:
    """Whether the cache has all of it. Pixels are not touched for that: where only they tell, it has not."""
    return bool(environment.digest) and disk.has(disk.key("environment", environment.digest, ndf))


def background_map(radiance: np.ndarray) -> np.ndarray:
    """The map in half floats where they reach; one with a sun above their range keeps its single ones."""
    return radiance.astype(np.float16) if radiance.max() < 65504 else radiance


def _bake(environment: Environment, ndf: str, with_levels: bool) -> dict[str, np.ndarray]:
    radiance = environment.radiance
    arrays = {"background": background_map(radiance)}
    # A map far larger than the levels is shrunk first: the sun is compact in those, too, and found much sooner.
    rest, suns = extract_sun(replace(environment, source=shrink(radiance, HEIGHT, WIDTH)))
    del radiance
    levels, irradiance = prefilter(rest.radiance, ndf) if with_levels else ([], irradiance_map(rest.radiance))
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
        levels=tuple(arrays[f"level{k}"] for k in range(len(LEVEL_ROUGHNESS)) if f"level{k}" in arrays),
        irradiance=arrays["irradiance"].copy(),  # a view of it would keep all that was read with it
        scale=float(arrays["scale"][0]),
        suns=tuple(Light("directional", tuple(r[3:6]), r[6], direction=tuple(r[:3]), angular_radius=r[7], name="sun")
                   for r in suns),
        background=arrays["background"],
    )


def _digest(radiance: np.ndarray) -> str:
    return hashlib.blake2b(np.ascontiguousarray(radiance).data, digest_size=20).hexdigest() + str(radiance.shape)
