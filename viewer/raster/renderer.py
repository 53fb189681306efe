"""The real-time renderer: a scene, a camera and settings in; radiance or a displayed picture out."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace

import moderngl
import numpy as np

from ..base.heap import trim_heap
from ..errors import UsageError
from ..gpu.buffer_texture import most_texels
from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.llvmpipe import free_looked_up, let_others_run
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..image.image import Image
from ..plan.curves import draws_curves
from ..plan.deferral import MOST_TEXELS
from ..plan.legend import legend
from ..plan.model import Plan
from ..plan.views import view_settings
from ..scene.camera import Camera
from ..scene.decoding import Decoder
from ..scene.frame import Frame
from ..scene.refined import refined
from ..scene.scene import Scene
from ..scene.woven import woven
from ..scene.yarn.spun import as_yarns
from ..settings import Settings
from .caustics import Caustics
from .depth import Depth
from .layers import Following
from .passes import Passes
from .prepared import Prepared
from .stopwatch import Stopwatch
from .target import Target
from .units import UNIT_RADIANCE


class Renderer:
    """Draws scenes with one OpenGL context.

    It keeps the textures and buffers of the last scene, and all programs. Meshes, images and environments are compared
    by identity: derive a changed scene with `dataclasses.replace`, and what the two share is neither decoded nor
    uploaded again. `use_cache` allows to keep baked environments on disk; `measure` waits for each pass to finish and
    stores its time in `pass_ms`.
    """

    def __init__(self, context: Context, use_cache: bool = True, measure: bool = False) -> None:
        self.context = context
        self.plan: Plan | None = None
        """The plan of the last frame."""
        self.programs = Programs(context)
        self._gl = context.gl
        self._watch = Stopwatch(context.gl, measure)
        self.times = self._watch.times
        """Seconds spent on preparing, by part, since the renderer was made."""
        self.pass_ms = self._watch.pass_ms
        """Milliseconds of each pass of the last frame, by the wall clock, where `measure` is set."""
        self._depth = Depth(context)
        self._use_cache = use_cache
        self._display = DisplayPass(self._gl, self.programs)
        self._hold_nothing()

    def _hold_nothing(self) -> None:
        """Begin without a scene. What was held of one before is freed with its last reference."""
        self.plan = None
        self._prepared = Prepared(self.context, self.programs, self._watch, self._use_cache)
        self._passes = Passes(self.context, self.programs, self._depth, self._prepared, self._watch)
        self._caustics = Caustics(self.context, self.programs)
        self._has_caustics = False
        self._target: Target | None = None
        self._given: Scene | None = None

    def expect(self, ahead: Decoder) -> None:
        """Take a decoder, from `decode_ahead`, that has begun with the images of the next scene."""
        self._prepared.expect(ahead)

    def forget(self) -> None:
        """Free what only the last scene needs."""
        self.context.make_current()
        self.plan = self._given = None
        self._prepared.take(Scene("nothing"))
        free_looked_up(self._gl)
        trim_heap()

    def holds(self, scene: Scene) -> bool:
        """Whether the last frame showed this scene, perhaps under other lights."""
        return self._given is not None and self._given.has_surfaces_of(scene)

    def render(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> Image:
        """The picture in full precision: linear radiance in single floats, and as displayed."""
        self.draw(scene, camera, settings, size, half=False, still=True)
        linear = self.read_radiance()
        if isinstance(settings.background, tuple):
            linear += (1 - linear[..., 3:]) * np.array([*settings.background, 1], np.float32)
        return Image(linear, self.read_display(settings), {
            "plan": self.plan.to_json(), **_legend(scene, camera, settings), **self.caustic_stats()})

    def display(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> Image:
        """The picture as displayed, for a PNG. `linear` is then its sRGB decoding."""
        self.draw(scene, camera, settings, size, still=True)
        return Image.from_srgb(self.read_display(settings))

    def layers(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int], names: Collection[str],
               following: Following | None = None) -> dict[str, np.ndarray]:
        """The layers `names` of `viewer.settings.SURFACE_LAYERS`: what surface each pixel shows at its centre.

        They are the same in all modes, also in mode path, and need no picture drawn before. `following` are scene and
        camera at the next time, to which motion leads. docs/layers.md says what they hold. Raises as `draw`.
        """
        self.context.make_current()
        frame = Frame(_shown(scene, settings), camera, size, self._depth.is_reversed)
        following = following and (_shown(following[0], settings), following[1])
        return self._passes.layers.find(frame, settings, names, following)

    @property
    def summary(self) -> str:
        """What preparing took, and the plan of the last frame in words, in one line."""
        times = ", ".join(f"{name} {seconds:.3f} s" for name, seconds in self.times.items())
        return "; ".join([f"preparing: {times}", "plan: " + "; ".join(self.plan.used if self.plan else ())])

    @property
    def texture_bytes(self) -> int:
        """About what the scene's textures take on the GPU."""
        return self._prepared.surfaces.textures.bytes

    @property
    def texture_seconds(self) -> float:
        """Spent on textures since the renderer was made, a part of "compile and upload" in `times`."""
        return self._prepared.surfaces.textures.seconds

    def read_radiance(self) -> np.ndarray:
        """The frame drawn last, (H, W, 4) float32 of the target's precision, with nothing laid behind it."""
        width, height = self._target.size
        if self._has_caustics:
            pixels = np.frombuffer(self._caustics.over(self._target.radiance).read(), np.float32)
        else:
            pixels = np.frombuffer(self._target.read(), np.float16 if self._target.half else np.float32)
        return pixels.reshape(height, width, 4)[::-1].astype(np.float32)

    def read_display(self, settings: Settings) -> np.ndarray:
        """The frame drawn last, as displayed, (H, W, 4) uint8."""
        width, height = self._target.size
        framebuffer = self._display.target((width, height))
        self.present(settings, framebuffer)
        let_others_run(self._gl)
        pixels = np.frombuffer(framebuffer.read(components=4), np.uint8).reshape(height, width, 4)
        return np.ascontiguousarray(pixels[::-1])

    def present(self, settings: Settings, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the frame drawn last into `framebuffer`, as displayed."""
        with self._watch.drawing("display"):
            radiance = self._target.radiance
            radiance = self._caustics.over(radiance) if self._has_caustics else radiance
            self._display.draw(radiance, settings, framebuffer, UNIT_RADIANCE)

    def draw(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        size: tuple[int, int],
        half: bool = True,
        still: bool = False,
        part: tuple[int, int, int, int] | None = None,
        keeps_photons: bool = False,
    ) -> None:
        """Draw radiance into the renderer's target, one of half floats where `half` is set.

        `still` is for a picture that is kept, which may take more samples than a frame of a moving camera.
        `part` (x, y, width, height), from the lower left in pixels, is all that is drawn of the picture then; the rest
        of the target stays as it was.

        A still picture of mode pbr with `caustics=photons` that is drawn whole has its photons, too. With
        `keeps_photons` it has those that it had before, and `add_photons` brings more.
        """
        self.context.make_current()
        self.pass_ms.clear()
        try:
            self._draw(scene, camera, settings, size, half, still, part, keeps_photons)
        except BaseException:  # Ctrl-C in a notebook, for example: what is held may be half made
            self._gl.clear_samplers()
            self._hold_nothing()
            raise

    def _draw(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int], half: bool, still: bool,
              part: tuple[int, int, int, int] | None, keeps_photons: bool) -> None:
        given, settings = scene, view_settings(settings)
        self._given = given
        scene = _shown(scene, settings)
        if still and settings.antialias == "auto" and self.context.is_software:
            # Mesa shades hidden fragments of a multisampled target to their end, and strips have many of them. Of woven
            # cloth it shades all places in a pixel for each triangle there; under supersampling points share them.
            # Beside light that is baked for seconds, four shaded points a pixel cost little.
            is_woven = any(material.weave is not None for material in scene.materials)
            if draws_curves(scene, settings) or (settings.mode == "pbr" and (is_woven or settings.indirect == "baked")):
                settings = replace(settings, antialias="ssaa-4")
        samples = settings.samples(self.context.is_software, still)
        target = self._sized_target(size, samples, half, settings.supersampling)
        deferred = (settings.defers(self.context.is_software, still, size)
                    and most_texels(self.context) >= MOST_TEXELS)
        plan = self.plan = self._prepared.prepare(scene, settings, target, camera.height is not None, deferred)
        pixels = Frame(scene, camera, size, self._depth.is_reversed)
        self._passes.prepare(pixels, settings, plan)
        target.set_part(part)
        frame = Frame(scene, camera, target.drawn_size, self._depth.is_reversed)
        self._passes.draw(plan, frame, pixels, target, settings, still)
        self._gl.clear_samplers()
        with self._watch.drawing("resolve"):
            let_others_run(self._gl)
            target.resolve(self.programs, UNIT_RADIANCE)
        self._has_caustics = still and part is None and settings.mode == "pbr" and settings.caustics == "photons"
        if self._has_caustics:
            with self._watch.drawing("photons"):
                unshadowed = [light for light, layer in zip(plan.lights, plan.shadow_layers, strict=True) if layer < 0]
                self._caustics.follow(given, camera, settings, size, unshadowed, keeps_photons)
                self.plan = self._caustics.explained(plan)
                if not keeps_photons:
                    self._caustics.step(math.inf, settings.photons)

    def add_photons(self, seconds: float, each: float) -> bool:
        """Add photons to the frame drawn last, for about so long, until it has `each` a pixel. Returns whether it has
        new ones."""
        return self._has_caustics and self._caustics.step(seconds, each)

    @property
    def photons_each(self) -> float:
        """Photons a pixel of the frame drawn last; infinite if it has none to trace."""
        return self._caustics.each if self._has_caustics else math.inf

    def caustic_stats(self) -> dict[str, object]:
        """For JSON, of the photons of the frame drawn last; empty if it has none."""
        return self._caustics.stats() if self._has_caustics else {}

    def _sized_target(self, size: tuple[int, int], samples: int, half: bool, supersampling: int) -> Target:
        samples = max(min(samples, self._gl.max_samples, self._gl.info["GL_MAX_COLOR_TEXTURE_SAMPLES"]), 1)
        last = self._target
        if last is None or not last.fits(size, samples, half, supersampling):
            radiance = None
            self._target = None  # should the next one fail
            if last is not None and (last.size, last.half) == (size, half):  # sides of a split may differ
                self._gl.screen.use()
                last.release_samples()
                radiance = last.radiance
            else:
                free(self._gl, last)
            try:
                self._target = Target(self._gl, self._depth, size, samples, half, supersampling, radiance)
            except UsageError:
                free(self._gl, radiance)
                raise
        return self._target

    def release(self) -> None:
        """Free what the renderer holds; the context stays."""
        self.context.make_current()
        free(self._gl, self._display, self._caustics, self._target, self._passes, self._prepared)
        self.programs.release()


def _shown(scene: Scene, settings: Settings) -> Scene:
    """The scene with its curves and its materials as the settings show them, and triangles small enough for what is
    baked at vertices: the same object each time."""
    shown = woven(as_yarns(scene.with_curve_radius(settings.curve_radius), settings), settings)
    bakes_light = settings.mode == "pbr" and settings.show == "shaded" and settings.indirect == "baked"
    return refined(shown) if bakes_light else shown


def _legend(scene: Scene, camera: Camera, settings: Settings) -> dict[str, object]:
    """For the statistics: what the colours of a view mean."""
    lines = legend(scene, camera, settings)
    return {"legend": list(lines)} if lines else {}
