"""The radiance that the renderer of a file's tests draws."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings


@pytest.fixture
def radiance(renderer: Renderer) -> Iterator[Callable[..., np.ndarray]]:
    """`radiance(scene, camera, size, **settings)`: linear RGBA, (H, W, 4) float64, one sample a pixel.

    Fails on a pixel that is not finite, and on an OpenGL error."""

    def draw(scene: Scene, camera: Camera, size: tuple[int, int] = (32, 32), **settings: object) -> np.ndarray:
        settings = {"antialias": "none"} | settings
        pixels = renderer.render(scene, camera, Settings.of(**settings), size).linear
        assert np.isfinite(pixels).all()
        return pixels.astype(np.float64)

    yield draw
    assert renderer.context.gl.error == "GL_NO_ERROR"
