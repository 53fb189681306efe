"""The interface of picture makers, which make the pictures of a render job, and the request that they get."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ..base.messages import say
from ..base.progress import Progress
from ..image.image import Image
from ..quality import Quality
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings

if TYPE_CHECKING:
    from ..estimate.raster_error import RasterError
    from ..gpu.context import Context
    from ..raster.layers import Following
    from ..raster.renderer import Renderer
    from ..trace.tracer import Tracer


@dataclass
class RenderRequest:
    """What all pictures of a job have in common, and the `size` of the next one.

    `open` returns the OpenGL context, which the first call opens. `measure` requests the GPU time of each pass.
    """

    open: Opener
    settings: Settings
    size: tuple[int, int]
    layers: Sequence[str]
    use_cache: bool
    measure: bool
    quiet: bool = True
    tell: Callable[[str], None] = say
    """Gets what a picture maker has to tell the user, unless `quiet`."""
    chooses: bool = False
    """Whether the method is chosen for each picture by its time budget or error; `settings.mode` is ignored then."""
    tell_error: float | None = None
    """Seconds of path tracing for the error of each picture of the raster."""
    following: Callable[[Scene, Camera], Following] | None = None
    """What follows a scene that is shown by a camera, for the layer motion."""
    quality: Quality = Quality()
    """Of pictures of mode pbr, on top of `settings`."""


class Opener(Protocol):
    def __call__(self) -> Context: ...


class PictureMaker(ABC):
    """Makes pictures with one OpenGL context, which is opened for the first picture."""

    def __init__(self, request: RenderRequest) -> None:
        self._request = request
        self._renderer: Renderer | None = None
        self._tracer: Tracer | None = None
        self.stats: dict[str, object] = {}
        """The statistics of the last picture, for `--stats`."""
        self.summary = ""
        """A line about the last picture, for `-v`."""
        self.texture_bytes = 0
        """About how many bytes the scene's textures take on the GPU."""
        self.stopped: int | None = None
        """The number of the signal that stopped the last picture early; None if the picture is complete."""
        self.error: RasterError | None = None
        """The error of the last picture, where `RasterMaker.tell_error` has told it."""

    def forget(self) -> None:
        """Free what only the last scene needs, before the next one is taken."""
        if self._renderer is not None:
            self._renderer.forget()
        if self._tracer is not None:
            self._tracer.forget()

    @abstractmethod
    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """Make the picture for the file `path`, which is not written here. `progress` shows the model already.

        Raises ContextError, InputError, UsageError.
        """
