"""The desktop window."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from ..errors import UsageError
from ..quality import DRAFT, Quality

if TYPE_CHECKING:
    from ..interact.model_files import ModelFiles
    from ..interact.playback import Playback
    from ..scene.camera import Camera
    from ..scene.scene import Scene
    from ..settings import Settings


def open_window(scene: Scene, settings: Settings, camera: Camera | None = None, size: tuple[int, int] = (1280, 720),
                use_cache: bool = True, tell: Callable[[str], None] | None = None,
                playback: Playback | None = None, quality: Quality = DRAFT, files: ModelFiles | None = None,
                watch: bool = False, full_screen: bool = False) -> None:
    """Open a window of `size` (in screen coordinates) on `scene`, and return when it is closed.

    `playback` is where in which animation it begins, by default with the scene as it is. Without `camera` the scene is
    framed. `quality` is that of the picture at rest. `use_cache` allows the cache on disk to be used. `tell` gets a
    line about the device when the window is open, and one about the first picture. `files` has the file of the scene
    and those beside it. With `watch` it is loaded again when it changes, or what it refers to. Raises UsageError for a
    denoiser that is too slow for a window, and for a view of values in mode path; ContextError if no window can be
    opened, and the renderer's errors for a scene that cannot be drawn.
    """
    if settings.denoise == "oidn":
        raise UsageError("denoise oidn takes too long for a window; there are off, fast and raster")
    if settings.mode == "path" and settings.show != "shaded":
        raise UsageError(f"show={settings.show} has no effect in mode path, only in modes pbr and phong")
    from .window import ViewerWindow

    start = time.perf_counter()
    with ViewerWindow(scene, settings, camera, size, use_cache, playback, quality, files, watch, full_screen) as window:
        if tell is not None:
            tell(f"window: {window.readings.device}: {time.perf_counter() - start:.3f} s")
        while not window.is_closed:
            window.step()
            if tell is not None and window.readings.frame_ms:
                tell(f"first picture: {time.perf_counter() - start:.3f} s; {window.renderer.summary}")
                tell = None
