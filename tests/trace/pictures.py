"""Path-traced pictures for tests. They have all their samples, and all numbers in them are finite."""

from __future__ import annotations

import numpy as np

from viewer.measure.compare.relmse import Halves
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer


def picture(tracer: Tracer, scene: Scene, camera: Camera, size: tuple[int, int] = (32, 32), *, spp: int = 16,
            **settings: object) -> np.ndarray:
    """Linear RGBA, (H, W, 4) float64."""
    path_render = tracer.begin(scene, camera, Settings.of(mode="path", spp=spp, **settings), size)
    while not path_render.is_done:
        path_render.step(0.25)
    assert path_render.bad_samples == 0
    pixels = path_render.image().linear
    path_render.release()
    assert np.isfinite(pixels).all()
    return pixels.astype(np.float64)


def halves(tracer: Tracer, scene: Scene, camera: Camera, size: tuple[int, int] = (32, 32), *, spp: int = 16,
           **settings: object) -> Halves:
    """Radiance of two pictures with different seeds and spp / 2 samples each."""
    return Halves(*(picture(tracer, scene, camera, size, spp=spp // 2, seed=seed, **settings)[..., :3]
                    for seed in (11, 12)))
