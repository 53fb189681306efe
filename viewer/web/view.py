"""A view of a model that is drawn here and shown in browsers: the parts of the window that need no toolkit."""

from __future__ import annotations

import io
import math
import time
from collections.abc import Callable, Hashable

import numpy as np

from ..errors import UsageError
from ..gpu.context import Context
from ..interact.actions import Actions
from ..interact.keys import KEYS, MOUSE, action_of, label
from ..interact.orbit import OrbitController
from ..interact.picture import Picture
from ..interact.playback import Playback
from ..interact.pointer import Pointer
from ..interact.state import ViewState
from ..quality import DRAFT, Quality
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .messages import Message

REST_SECONDS = 0.3
"""A picture that has not changed for so long, and needs no refinement, is at rest."""
_JPEG = {"format": "JPEG", "quality": 88, "subsampling": 0}
_PNG = {"format": "PNG", "compress_level": 1}
_IN_BROWSER = {"help", "screenshot"}
"""Actions that the browser does by itself."""
_NOT_IN_BROWSER = ("Ctrl + wheel", "Drop a file")
"""Gestures that a browser keeps for itself, or that would need files of another machine."""


class RemoteView:
    """Draws `scene` with a context from `open`, in pictures that fit into `most` pixels.

    Several clients may look on and steer: they share one camera, and the picture has the shape that the one has who did
    something last. Everything is called on one thread. Raises UsageError for a denoiser that is too slow.
    """

    def __init__(self, open: Callable[[], Context], scene: Scene, settings: Settings, camera: Camera | None = None,
                 most: tuple[int, int] = (1280, 720), use_cache: bool = True, playback: Playback | None = None,
                 quality: Quality = DRAFT) -> None:
        if settings.denoise == "oidn":
            raise UsageError("denoise oidn takes too long for a view that moves; there are off, fast and raster")
        self._open, self._use_cache, self._most = open, use_cache, most
        self.size = most
        """Of the picture, in pixels."""
        self.state = ViewState(scene, settings, panel=False, playback=playback or Playback(), quality=quality)
        self.orbit = OrbitController(scene, self._aspect)
        self.actions = Actions(self.state, self.orbit, lambda: self._aspect)
        self._is_framed = camera is None
        """Whether the model shall fill the picture, because nobody has moved the camera yet."""
        if camera is not None:
            self.actions.follow(camera)
        self.version = 0
        """The number of the picture that `encoded` gives; it grows with each new one."""
        self._changed_at = -math.inf
        self._renderer: Renderer | None = None
        self._picture: Picture | None = None
        self._sizes: dict[Hashable, tuple[int, int]] = {}
        self._pointers: dict[Hashable, Pointer] = {}
        self._shown_sizes: dict[Hashable, tuple[int, int]] = {}
        self._has_input = True
        self._is_frame = False
        """Whether the last step has drawn the picture anew."""
        self._moved_at = time.monotonic()
        self._pixels: tuple[int, np.ndarray] | None = None
        self._encoded: dict[bool, tuple[int, bytes]] = {}

    @property
    def is_awake(self) -> bool:
        return self._picture is not None

    def wake(self) -> None:
        """Open OpenGL. `step` does it where it has not been done. Raises ContextError."""
        if self._picture is None:
            self._renderer = Renderer(self._open(), self._use_cache)
            self._picture = Picture(self._renderer, self.state, self.orbit)

    def sleep(self) -> None:
        """Free all that OpenGL holds. Camera and state stay, and `step` begins anew."""
        if self._picture is not None and self._renderer is not None:
            self._renderer.context.make_current()
            self._picture.release()
            self._renderer.release()
            self._renderer.context.release()
        self._picture = self._renderer = self._pixels = None
        self._has_input = True

    @property
    def seconds_until_work(self) -> float:
        """The seconds until `step` has something to do without input; infinite if it has nothing."""
        if self._picture is None or self._has_input or self.orbit.velocity.any() or self.state.playback.is_playing:
            return 0.0
        forgets = self.state.expires - time.monotonic() if self.state.message else math.inf
        return max(min(self._picture.seconds_until_work, forgets), 0.0)

    @property
    def seconds_until_rest(self) -> float:
        """When the picture is at rest, if nothing changes it; 0 once it is."""
        if self._picture is None or not self._picture.is_refined or self._picture.size != self.size:
            return REST_SECONDS
        return max(self._changed_at + REST_SECONDS - time.monotonic(), 0.0)

    def handle(self, client: Hashable, message: Message) -> None:
        """Do what the mouse or the keys of a client ask for."""
        if message.kind == "size":
            self._sizes[client] = round(message.width), round(message.height)
            self._take_shape_of(client)
            return
        if message.kind == "cancel":
            self._pointers.pop(client, None)
            return
        if message.kind == "key":
            action = action_of(*_parts(message.key))
            if action is None or not self.actions.do(action):
                return
            self._is_framed = action == "frame_all" or (self._is_framed and action != "next_camera")
        elif not self._point(client, message):
            return
        self._take_shape_of(client)
        self._has_input = True

    def forget(self, client: Hashable) -> None:
        """A client has gone."""
        self._sizes.pop(client, None)
        self._pointers.pop(client, None)
        self._shown_sizes.pop(client, None)

    def step(self) -> None:
        """Draw what is new, or go on to trace paths for a slice of time. Raises as `Picture.update`."""
        self.wake()
        assert self._picture is not None and self._renderer is not None
        self._renderer.context.make_current()
        now = time.monotonic()
        passed, self._moved_at = now - self._moved_at, now
        is_moving = self.orbit.coast(min(passed, 0.1)) | self.state.play(passed)
        has_input, self._has_input = self._has_input, False
        wants_frame = has_input or is_moving or self._picture.wants_refinement
        is_new = wants_frame and self._picture.update(self.size)
        self._is_frame = is_new
        if self._picture.converge() or is_new or has_input or self.state.forget_message():
            self.version += 1
            self._changed_at = time.monotonic()

    def still(self) -> bytes:
        """The picture of the raster at rest, as JPEG. Raises as `step`."""
        self.step()
        assert self._picture is not None
        while not self._picture.is_refined:
            time.sleep(max(self.seconds_until_work, 0.01))
            self.step()
        return self.encoded(lossless=False)

    def encoded(self, lossless: bool) -> bytes:
        """The current picture, as PNG or as JPEG."""
        from PIL import Image as Pillow

        version, content = self._encoded.get(lossless, (-1, b""))
        if version != self.version:
            file = io.BytesIO()
            Pillow.fromarray(self._shown()).save(file, **(_PNG if lossless else _JPEG))  # type: ignore[arg-type]
            content = file.getvalue()
            self._encoded[lossless] = self.version, content
            if self._is_frame and self._picture is not None:
                self._picture.was_shown()
        return content

    def words(self) -> dict[str, object]:
        """What is written over the picture, where its line is, and the size at which it is shown."""
        state = self.state
        status = self._picture.status() if self._picture is not None else ""
        return {"size": list(self.size), "name": state.scene.name, "status": status, "message": state.message,
                "isError": state.is_error, "split": state.split, "sides": list(state.sides)}

    def keys(self) -> list[str]:
        """The keys that do something in a browser, by the names of `viewer.interact.keys`."""
        actions = self.actions.names | _IN_BROWSER
        return [key for binding in KEYS if binding.action in actions for key in binding.keys]

    def help(self) -> list[tuple[str, list[tuple[str, str]]]]:
        """As `viewer.interact.keys.help_groups`, of what there is in a browser."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for binding in KEYS:
            if binding.action in self.actions.names:
                groups.setdefault(binding.group, []).append((", ".join(map(label, binding.keys)), binding.text))
        gestures = [(name, text) for name, text in MOUSE if name not in _NOT_IN_BROWSER]
        return [*groups.items(), ("Mouse, trackpad, fingers", [*gestures, ("Pinch", "Move closer, or away")]),
                ("Page", [("H, F1", "This help"), ("S", "Save the picture")])]

    def _shown(self) -> np.ndarray:
        assert self._picture is not None and self._renderer is not None
        if self._pixels is None or self._pixels[0] != self.version:
            self._renderer.context.make_current()
            self._pixels = self.version, self._picture.shown()
        return self._pixels[1]

    @property
    def _aspect(self) -> float:
        return self.size[0] / self.size[1]

    def _take_shape_of(self, client: Hashable) -> None:
        width, height = self._sizes.get(client, self.size)
        scale = min(1.0, self._most[0] / width, self._most[1] / height)
        size = max(round(width * scale), 1), max(round(height * scale), 1)
        if size != self.size:
            self.size, self._has_input = size, True
            if self._is_framed:
                self.actions.frame_all()

    def _point(self, client: Hashable, message: Message) -> bool:
        """Move or press the mouse of a client. Returns whether that may have changed the picture."""
        self._shown_sizes[client] = round(message.width), round(message.height)
        if client not in self._pointers:
            self._pointers[client] = Pointer(self.state, self.orbit, lambda: self._shown_sizes[client], lambda: 1.0)
        pointer = self._pointers[client]
        pointer.move(message.x, message.y)
        if message.kind == "press" and not pointer.is_dragging:
            pointer.press(message.is_left, message.shift)
        elif message.kind == "release" and pointer.is_dragging:
            pointer.release(message.is_left, message.shift)
        elif message.kind == "wheel":
            pointer.scroll(message.dx, message.dy, message.shift, control=False)
        elif not pointer.is_dragging:
            return False
        self._is_framed = False
        return True


def _parts(key: str) -> tuple[str, bool, bool]:
    """The key, and whether Shift and Ctrl are held with it: `Ctrl+Shift+X` is ("X", True, True)."""
    *modifiers, name = key.split("+")
    return name, "Shift" in modifiers, "Ctrl" in modifiers
