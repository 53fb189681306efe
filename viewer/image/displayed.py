"""Pictures of radiance that was worked out on the processor."""

from __future__ import annotations

import numpy as np

from ..gpu.context import Context
from ..gpu.programs import Programs
from ..settings import Settings
from .display import DisplayPass
from .image import Image


def displayed(context: Context, programs: Programs, linear: np.ndarray, settings: Settings) -> Image:
    """The picture of `linear`, radiance with associated alpha (H, W, 4), row 0 at the top: with the colour of the
    background of `settings`, and as displayed."""
    height, width = linear.shape[:2]
    context.make_current()
    display = DisplayPass(context.gl, programs)
    texture = context.gl.texture((width, height), 4, np.ascontiguousarray(linear[::-1], np.float32), dtype="f4")
    target = display.target((width, height))
    display.draw(texture, settings, target, 0)
    shown = np.frombuffer(target.read(components=4), np.uint8).reshape(height, width, 4)[::-1]
    context.gl.screen.use()
    for thing in (texture, display):
        thing.release()
    if isinstance(settings.background, tuple):
        linear = linear + (1 - linear[..., 3:]) * np.array([*settings.background, 1], np.float32)
    return Image(linear.astype(np.float32), np.ascontiguousarray(shown))
