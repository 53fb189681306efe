"""What `viewer.show` shows in a cell of a notebook."""

from __future__ import annotations

import sys
from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING

from ..base.messages import say
from ..quality import Quality
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings

if TYPE_CHECKING:
    from .notebook import NotebookView


def in_notebook() -> bool:
    """Whether this runs in a Jupyter kernel. IPython in a terminal does not."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


def view_in_cell(scene: Scene, settings: Settings, camera: Camera | None, size: tuple[int, int],
                 quality: Quality) -> NotebookView | None:
    """A view of at most `size` pixels; None, with a line that says why, without the package that it needs. Raises
    ContextError, and UsageError for a denoiser that is too slow."""
    if find_spec("anywidget") is None:
        _say_what_turns()
        return None
    from ..gpu.context import open_context
    from .notebook import NotebookView
    from .view import RemoteView

    return NotebookView(RemoteView(open_context, scene, settings, camera, size, quality=quality))


@cache
def _say_what_turns() -> None:
    """Once."""
    say("This picture stands still. pip install 'pbr-viewer[notebook]' makes it one that turns.")
