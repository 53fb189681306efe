"""`--denoise raster`: path-traced pictures, mixed with one of the raster where that is nearer to the truth."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..image.displayed import displayed
from ..image.image import Image
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings, ignored
from ..trace.paths.run import Report, run
from .neighbourhood import mixture

if TYPE_CHECKING:
    from ..raster.renderer import Renderer
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

_CHOSEN: dict[str, Any] = {"antialias": "ssaa-4", "environment_shadows": "64", "caustics": "off"}
"""What a picture of the raster gains most by, at the price of few samples."""
_SEED = 0x80000000
"""Between the seeds of the two halves."""


@dataclass(frozen=True, eq=False)
class _Half:
    """Sums over samples, (H, W, 4) with alpha, their numbers, (H, W, 1), and what tracing them took."""

    total: np.ndarray
    count: np.ndarray
    stats: dict[str, Any]

    @classmethod
    def of(cls, path_render: PathRender) -> _Half:
        total, squares = path_render.film.read_sums()
        return cls(np.concatenate([total[..., :3], squares[..., 3:]], axis=-1), total[..., 3:], path_render.stats())


def render_mixture(tracer: Tracer, renderer: Renderer, scene: Scene, camera: Camera, settings: Settings,
                   size: tuple[int, int], report: Report | None = None,
                   wants_to_stop: Callable[[], bool] = lambda: False) -> Image:
    """The picture of mode path with `settings`, mixed with one that the raster draws.

    Half of the samples each are traced with seeds of their own, since only independent halves tell the noise: within
    one they are stratified, and their spread is larger than their noise. If `wants_to_stop` was true before both
    halves had a sample of every pixel, the samples are left as they are. Raises as `Tracer.begin` and `Renderer.draw`.
    """
    started = time.perf_counter()
    renderer.draw(scene, camera, raster_settings(settings), size, half=False, still=True)
    raster = np.nan_to_num(renderer.read_radiance()[..., :3], nan=0.0, posinf=0.0, neginf=0.0)
    prepared = 0.0
    halves: list[_Half] = []
    for k, own in enumerate(half_settings(settings)):
        path_render = tracer.begin(scene, camera, own, size)
        elapsed = time.perf_counter() - started
        prepared = prepared or elapsed
        later = 0.0 if k == 1 or settings.time_budget is None else max(settings.time_budget - elapsed, 0.0) / 2
        told = None if report is None else (lambda fraction, seconds, k=k: report((k + fraction) / 2, seconds))
        try:
            run(path_render, started, told, wants_to_stop, later)
            halves.append(_Half.of(path_render))
        finally:
            path_render.release()
    first, second = halves
    count = first.count + second.count
    linear = (first.total + second.total) / np.maximum(count, 1)
    is_mixed = bool(min(first.count.min(), second.count.min()) > 0)
    if is_mixed:
        apart = (first.total / first.count - second.total / second.count)[..., :3]
        linear[..., :3] = mixture(raster, linear[..., :3], first.count * second.count / count**2 * apart**2)
    stats = _stats(first.stats, second.stats) | {"denoised": "raster" if is_mixed else "off"}
    attributes = {"samples": f"{stats['spp']:g} a pixel"} | ({"denoised": "raster"} if is_mixed else {})
    image = displayed(tracer.context, tracer.programs, linear, settings)
    return replace(image, stats={"prepare_s": {"scene": prepared}, **stats}, attributes=attributes)


def raster_settings(settings: Settings) -> Settings:
    """The settings of the raster's picture for one of mode path, with no colour behind it."""
    others: dict[str, Any] = {f.name: f.default for f in fields(Settings) if f.name in ignored("pbr")}
    if isinstance(settings.background, tuple):
        others["background"] = "none"
    return replace(settings, **others | _CHOSEN, mode="pbr")


def half_settings(settings: Settings) -> tuple[Settings, Settings]:
    """Those of the two halves. The error of their mean is that of each over the root of two."""
    error = None if settings.error is None else min(settings.error * math.sqrt(2), 1.0)
    least = settings.most_spp // 2
    return (replace(settings, denoise="off", error=error, spp=settings.most_spp - least),
            replace(settings, denoise="off", error=error, spp=max(least, 1), seed=settings.seed ^ _SEED))


def _stats(first: dict[str, Any], second: dict[str, Any]) -> dict[str, Any]:
    """Those of both halves together."""
    added = {name: first[name] + second[name] for name in ("spp", "samples", "bad_samples", "rays", "trace_s")}
    errors = first["estimated_error"], second["estimated_error"]
    error = None if None in errors else math.hypot(*errors) / 2
    if "photons" in first:
        photons = [half["photons"] for half in (first, second)]
        added |= {"photons": sum(photons) if all(photons) else 0,
                  "bad_splats": first["bad_splats"] + second["bad_splats"]}
    return first | added | {"estimated_error": error, "rays_per_s": added["rays"] / max(added["trace_s"], 1e-9)}
