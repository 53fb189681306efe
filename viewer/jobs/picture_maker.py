"""What makes a render job's pictures: the request and the interface that every picture maker has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ..base.progress import Progress
from ..image.image import Image
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings

if TYPE_CHECKING:
    from ..gpu.context import Context


@dataclass
class RenderRequest:
    """What all pictures of a job have in common; `open` opens the OpenGL context, once."""

    open: Opener
    settings: Settings
    size: tuple[int, int]
    layers: Sequence[str]
    use_cache: bool
    measure: bool
    quiet: bool = True
    chooses: bool = False
    """The method is chosen for each picture by its time budget or error; `settings.mode` is ignored."""


class Opener(Protocol):
    def __call__(self) -> Context: ...


class PictureMaker(ABC):
    """Makes pictures with one OpenGL context, opened with the first."""

    def __init__(self, request: RenderRequest) -> None:
        self._request = request
        self.stats: dict[str, object] = {}
        """What `--stats` says of the last picture."""
        self.summary = ""
        """What `-v` says of the last picture, in one line."""
        self.texture_bytes = 0
        """About how much memory the scene's textures take on the GPU."""
        self.stopped: int | None = None
        """The number of the signal that stopped the last picture early; None: it is complete."""

    @abstractmethod
    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """The picture that goes to `path`. `progress` has been told of the model.

        Raises ContextError, InputError, UsageError.
        """
