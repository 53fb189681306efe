"""What the benchmarks of plans and of growth share: first and later frames of a scene, and the bytes behind them."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings

_FULLY_COMPILED = ("MESA_SHADER_CACHE_DISABLE", "MESA_GLSL_CACHE_DISABLE")


def compile_anew() -> None:
    """Have Mesa forget between runs what it compiled; to be called before there is a context."""
    os.environ.update(dict.fromkeys(_FULLY_COMPILED, "true"))


@dataclass
class Frames:
    """First: wall and processor seconds; later ones: milliseconds each; MB of textures and buffers; the plan as JSON"""

    first_s: float
    first_cpu_s: float
    megabytes: float
    plan: dict[str, object]
    later_ms: list[float] = field(default_factory=list)
    later_cpu_ms: list[float] = field(default_factory=list)

    def to_json(self) -> dict[str, float]:
        return {"first": self.first_s, "first_cpu": self.first_cpu_s, "mb": self.megabytes,
                "programs": len(self.plan["programs"]),
                **({"later": statistics.median(self.later_ms), "later_cpu": statistics.median(self.later_cpu_ms)}
                   if self.later_ms else {})}


class Viewer:
    """A renderer of its own, whose first frame has everything to prepare; nothing is kept on disk."""

    def __init__(self, context: Context, scene: Scene, settings: Settings, size: tuple[int, int]) -> None:
        self._context, self._scene, self._settings, self._size = context, scene, settings, size
        with counted_bytes() as counted:
            wall, cpu = time.perf_counter(), time.process_time()
            self._renderer = Renderer(context, use_cache=False)
            self.picture = self._frame(0)
            self.frames = Frames(time.perf_counter() - wall, time.process_time() - cpu, counted[0] / 1e6,
                                 self._renderer.plan.to_json())

    def draw(self, number: int) -> None:
        """A frame of a camera that has moved."""
        wall, cpu = time.perf_counter(), time.process_time()
        self._frame(number)
        self.frames.later_ms.append((time.perf_counter() - wall) * 1e3)
        self.frames.later_cpu_ms.append((time.process_time() - cpu) * 1e3)

    def _frame(self, number: int) -> np.ndarray:
        scene, aspect = self._scene, self._size[0] / self._size[1]
        camera = Camera.framing(scene.center, scene.radius, aspect, azimuth=0.6 + 0.1 * number)
        self._renderer.draw(scene, camera, self._settings, self._size)
        return self._renderer.read_display(self._settings)

    def release(self) -> None:
        self._renderer.release()


@contextmanager
def counted_bytes() -> Iterator[list[float]]:
    """Bytes of the textures, depth maps and buffers that are made meanwhile, in the list's one entry."""
    total = [0.0]
    makers = {name: getattr(moderngl.Context, name) for name in ("texture", "depth_texture", "buffer")}
    function = Context.function

    def texture(self, size, components, *args, dtype="f1", samples=0, **kwargs):
        total[0] += size[0] * size[1] * components * max(int(dtype[-1]), 1) * max(samples, 1)
        return makers["texture"](self, size, components, *args, dtype=dtype, samples=samples, **kwargs)

    def depth_texture(self, size, *args, **kwargs):
        total[0] += size[0] * size[1] * 4
        return makers["depth_texture"](self, size, *args, **kwargs)

    def buffer(self, *args, **kwargs):
        made = makers["buffer"](self, *args, **kwargs)
        total[0] += made.size
        return made

    def counting(self, name, *arguments):
        call = function(self, name, *arguments)
        if name != "glTexImage2D":
            return call

        def image(target, level, internal, width, height, border, form, kind, data):
            total[0] += width * height * _COMPONENTS[form] * _SIZES[kind]
            return call(target, level, internal, width, height, border, form, kind, data)

        return image

    moderngl.Context.texture, moderngl.Context.depth_texture, moderngl.Context.buffer = texture, depth_texture, buffer
    Context.function = counting
    try:
        yield total
    finally:
        for name, maker in makers.items():
            setattr(moderngl.Context, name, maker)
        Context.function = function


_COMPONENTS = {0x1903: 1, 0x8227: 2, 0x1907: 3, 0x1908: 4}
_SIZES = {0x1401: 1, 0x1403: 2, 0x140B: 2, 0x1406: 4}
