"""The Python API: load a scene, render it, show it."""

from __future__ import annotations

import threading
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING

from .scene.camera import Camera
from .scene.scene import Scene
from .settings import Settings

if TYPE_CHECKING:
    from .image import Image
    from .raster.renderer import Renderer

_local = threading.local()


def load(path: str | PathLike[str], environment: str | PathLike[str] | None = "studio") -> Scene:
    """A scene from a model file, under an environment.

    `environment` is an HDR or EXR file, the name of a built-in one (studio, sky, furnace) or None. Raises InputError.
    """
    from .scene.environment_files import load_environment
    from .scene.load import load_scene

    return replace(load_scene(path), environment=load_environment(environment))


def render(
    scene: Scene,
    size: tuple[int, int] = (1280, 720),
    camera: Camera | None = None,
    *,
    backend: str = "auto",
    **settings: object,
) -> Image:
    """A picture of `scene`, `size` = (width, height) pixels.

    Without `camera` the one that frames the scene. `settings` are the fields of `viewer.Settings`, for instance
    ``mode="phong", exposure=1.0, background="none"``. Raises UsageError for a setting that does not exist and
    ContextError where there is no OpenGL.
    """
    chosen = Settings.of(**settings)
    if camera is None:
        camera = Camera.framing(scene.center, scene.radius, size[0] / size[1])
    return shared_renderer(backend).render(scene, camera, chosen, size)


def show(scene: Scene, **settings: object) -> Image | None:
    """Open a window on `scene` until it is closed; in a notebook, return a picture of it to be shown."""
    if _in_notebook():
        return render(scene, **settings)
    from .app.window import run

    run(scene, Settings.of(**settings))
    return None


def shared_renderer(backend: str = "auto") -> Renderer:
    """This thread's renderer for `backend`, made on first use."""
    from .gpu.context import open_context
    from .raster.renderer import Renderer

    renderers = _local.__dict__.setdefault("renderers", {})
    if backend not in renderers:
        renderers[backend] = Renderer(open_context(backend))
    return renderers[backend]


def _in_notebook() -> bool:
    try:
        from IPython import get_ipython
    except ImportError:
        return False
    shell = get_ipython()
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"
