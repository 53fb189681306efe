"""The desktop window."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from ..errors import ContextError, UsageError

if TYPE_CHECKING:
    from ..scene.camera import Camera
    from ..scene.scene import Scene
    from ..settings import Settings


def open_window(scene: Scene, settings: Settings, camera: Camera | None = None, size: tuple[int, int] = (1280, 720),
                use_cache: bool = True) -> None:
    """`viewer.app.window.run`. Raises ContextError also where the panel's library is missing, and UsageError for a
    denoiser that is too slow for a window."""
    if find_spec("imgui_bundle") is None:
        raise ContextError("the window needs imgui-bundle, which is made for Python 3.11 and newer: "
                           "run this with such a Python; pictures can be rendered with any")
    if settings.denoise == "oidn":
        raise UsageError("denoise oidn takes too long for a window; there are off and fast")
    from .window import run

    run(scene, settings, camera, size, use_cache)
