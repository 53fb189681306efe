"""The desktop window."""

from __future__ import annotations

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
    """`viewer.app.window.run`. Raises UsageError also for a denoiser that is too slow for a window."""
    if settings.denoise == "oidn":
        raise UsageError("denoise oidn takes too long for a window; there are off, fast and raster")
    if settings.mode == "path" and settings.show != "shaded":
        raise UsageError(f"show={settings.show} has no effect in mode path, only in modes pbr and phong")
    from .window import run

    run(scene, settings, camera, size, use_cache, tell, playback, quality, files, watch, full_screen)
