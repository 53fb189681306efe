"""Renders a scene by any method of the ladder, and times it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import moderngl
import numpy as np

from ...errors import UsageError
from ...estimate.mixture import draw_guide
from ...gpu.context import Context
from ...gpu.programs import Programs
from ...image.display import DisplayPass
from ...image.image import Image
from ...plan.media import has_media
from ...raster.renderer import Renderer
from ...scene.camera import Camera
from ...scene.scene import Scene
from ...settings import Settings
from ...trace.paths.path_render import PathRender
from ...trace.paths.run import run
from ...trace.tracer import Tracer
from .ladder import Method
from .store import Record
from .timing import Timing, frame_effort, measure, picture_effort

COVERAGE_SPP = 16
Report = Callable[[float], None]
"""Called with the share of a picture that is done, 0 to 1."""


class Bench:
    """One scene, camera and size. `settings` are those that the methods change; their background is not a colour.

    A colour would become part of the radiance, although it is not displayed by the model's tone curve. Raises
    UsageError for a size that this OpenGL has no buffers for.
    """

    def __init__(self, context: Context, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
                 use_cache: bool = True, limit: float = 150.0) -> None:
        self.limit = limit
        """Seconds that all measuring may take; the more there are, the more often each method is run."""
        self.context, self.scene, self.camera, self.settings, self.size = context, scene, camera, settings, size
        self._gl = context.gl
        self._renderer = Renderer(context, use_cache)
        self._tracer = Tracer(context, use_cache)
        self._programs = Programs(context)
        self._display = DisplayPass(self._gl, self._programs)
        try:
            self._shown = self._gl.framebuffer([self._gl.renderbuffer(size, 4)])
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} is more than this OpenGL can hold ({error})") from error
        self._warm: set[str] = set()
        self._background: np.ndarray | None = None

    def measure(self, method: Method) -> Record:
        """The method's picture, and in `facts` its `time_ms` (see `Timing`), `prepare_s` and what the renderer reports.

        The time of a raster frame includes drawing, display, and waiting for the device. That of a path-traced picture
        includes all samples, denoising and display. The scene is prepared before: `prepare_s` is what that took
        (decoding, baking, compiling, uploading, building the BVH), as far as no earlier method had done it.
        """
        started = time.perf_counter()
        picture, timing, facts = (self._trace if method.is_traced else self._draw)(method)
        seconds = time.perf_counter() - started
        return Record(picture, {"time_ms": timing.to_json(), **facts}, seconds)

    def _draw(self, method: Method) -> tuple[np.ndarray, Timing, dict[str, object]]:
        scene, settings, renderer = method.scene(self.scene), method.settings(self.settings), self._renderer

        def frame() -> None:
            renderer.draw(scene, self.camera, settings, self.size, still=True)
            renderer.present(settings, self._shown)
            self._gl.finish()

        started = time.perf_counter()
        frame()
        first = time.perf_counter() - started
        frame()
        timing = measure(frame, frame_effort(self.limit))
        picture = renderer.read_radiance()
        if method.lights is not None and settings.background == "env" and self.scene.environment is not None:
            picture = picture + (1 - picture[..., 3:]) * self._empty_picture()
        return picture, timing, {"prepare_s": max(first - timing.median / 1e3, 0.0)}

    def _empty_picture(self) -> np.ndarray:
        """The background alone: it shows in pixels that the model covers in part, whatever lights the model."""
        if self._background is None:
            empty = replace(self.scene, instances=())
            renderer = Renderer(self.context)
            self._background = renderer.render(empty, self.camera, self.settings, self.size).linear
            renderer.release()
        return self._background

    def _trace(self, method: Method) -> tuple[np.ndarray, Timing, dict[str, object]]:
        settings = method.settings(self.settings)
        prepare = self._warm_up(settings)
        last: list[PathRender] = []

        def picture() -> None:
            started = time.perf_counter()
            path_render = self._begin(settings)
            last.append(path_render)
            run(path_render, started)
            path_render.present(self._shown)
            self._gl.finish()

        def tidy() -> None:
            for path_render in last[:-1]:
                path_render.release()
            del last[:-1]

        timing = measure(picture, picture_effort(self.limit), tidy)
        image, error = last[-1].image(), last[-1].error
        last[-1].release()
        facts = {name: image.stats[name] for name in ("spp", "rays", "bad_samples", "intersector")}
        facts["estimated_error"] = error if math.isfinite(error) else None
        return image.linear, timing, {"prepare_s": prepare, **facts}

    def _warm_up(self, settings: Settings) -> float:
        """Prepare the scene and compile the programs; returns the seconds it took, 0 if that was done before."""
        if settings.denoise in self._warm:
            return 0.0
        started = time.perf_counter()
        self.trace(replace(settings, spp=1, error=None))
        self._warm.add(settings.denoise)
        return time.perf_counter() - started

    def trace(self, settings: Settings, report: Report | None = None) -> np.ndarray:
        """A path-traced picture's linear radiance, (H, W, 4)."""
        path_render = self._begin(settings)
        try:
            run(path_render, time.perf_counter(), None if report is None else lambda fraction, _: report(fraction))
            return path_render.image().linear
        finally:
            path_render.release()

    def _begin(self, settings: Settings) -> PathRender:
        guide = draw_guide(self._renderer, self.scene, self.camera, settings, self.size)
        return self._tracer.begin(self.scene, self.camera, settings, self.size, guide=guide)

    def coverage(self) -> np.ndarray:
        """The pixels, (H, W) bool, in which some camera ray hits the model or collides in a medium."""
        settings = replace(self.settings, mode="path", spp=COVERAGE_SPP)
        if has_media(self.scene, settings):  # a path that has met something has alpha
            return self.trace(replace(settings, background="none"))[..., 3] > 0
        layers = self._tracer.render(self.scene, self.camera, settings, self.size, ["distance"]).layers
        return np.isfinite(layers["distance"])

    def release(self) -> None:
        """Free what it holds; the context stays."""
        self.context.make_current()
        self._renderer.release()
        self._tracer.release()
        self._display.release()
        self._programs.release()
        self._shown.color_attachments[0].release()
        self._shown.release()

    def displayed(self, linear: np.ndarray) -> Image:
        """Linear radiance (H, W, 4) as a picture of these settings."""
        self.context.make_current()
        flipped = np.ascontiguousarray(linear[::-1], np.float32)
        texture = self._gl.texture(self.size, 4, flipped, dtype="f4")
        self._display.draw(texture, self.settings, self._shown, 0)
        shown = np.frombuffer(self._shown.read(components=4), np.uint8).reshape(linear.shape)[::-1]
        texture.release()
        return Image(np.asarray(linear, np.float32), np.ascontiguousarray(shown))
