"""The real-time renderer: a scene, a camera and settings in; radiance or a displayed picture out."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np

from ..bake.dfg import dfg_albedos, dfg_table
from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.float_texture import float_texture
from ..gpu.programs import Programs, matrix_uniform
from ..image.display import DisplayPass
from ..image.image import Image
from ..plan.curves import draws_curves
from ..plan.media import has_media
from ..plan.model import SOLID, THIN_WALLED, Plan
from ..plan.planner import environment_use, plan_scene
from ..scene.camera import Camera
from ..scene.decoding import Decoder
from ..scene.environment import Environment
from ..scene.frame import Frame
from ..scene.light import Light
from ..scene.scene import Scene
from ..scene.woven import woven
from ..scene.yarn.spun import as_yarns
from ..settings import Settings
from .caustics import Caustics
from .curves import CurvePass
from .depth import Depth
from .environment import EnvironmentLight
from .gbuffer import GBuffer
from .interiors import Interiors
from .lights import pack_lights
from .media import MediaPass
from .shadows import Casters, ShadowMaps
from .subsurface import SubsurfacePass
from .surfaces import UNIT_DFG, UNIT_RADIANCE, UNIT_SHADOW, Surfaces
from .target import Target
from .traced.reflections import TracedReflections
from .traced.refraction import TracedRefraction
from .transmission import Backdrop
from .visibility import VisibilityPass

_KEPT = 2
"""How many plans and shadow maps are kept: a window that is split between two modes draws with two in turn."""
_BLACK = Environment("black", np.zeros((512, 1024, 3), np.float32))


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
        self.times: dict[str, float] = {}
        """Seconds spent on preparing, by part, since the renderer was made."""
        self.pass_ms: dict[str, float] = {}
        """Milliseconds of each pass of the last frame, by the wall clock, where `measure` is set."""
        self.programs = Programs(context)
        self._measure = measure
        self._gl = context.gl
        self._use_cache = use_cache
        self._depth = Depth(context)
        self._display = DisplayPass(self._gl, self.programs)
        self._target: Target | None = None
        self._backdrop: Reusable[Backdrop] = Reusable()
        self._gbuffers: dict[tuple[int, int], GBuffer] = {}
        self._visibility = VisibilityPass(self._gl, self.programs)
        self._reflections = TracedReflections(context, self.programs)
        self._refraction = TracedRefraction(context, self.programs, self._depth)
        self._media = MediaPass(context, self.programs)
        self._subsurface = SubsurfacePass(context, self.programs, self._depth)
        self._surfaces = Surfaces(context, self.programs)
        self._curves = CurvePass(context, self.programs, self._depth)
        self._caustics = Caustics(context, self.programs)
        self._has_caustics = False
        self._casters = Casters(self._surfaces.draw_depth, self._curves.draw_depth)
        self._indirect_key: tuple[object, ...] | None = None
        self._interiors = Interiors(context)
        self._measured: Scene | None = None
        self._environment: EnvironmentLight | None = None
        self._ahead: Decoder | None = None
        self._generation = self.programs.generation
        self._shadows: list[ShadowMaps] = []
        self._plans: list[tuple[tuple[object, ...], Plan]] = []
        self._blocks: list[moderngl.Buffer] = []
        self._dfg: dict[tuple[str, str, bool], moderngl.Texture] = {}

    def expect(self, ahead: Decoder) -> None:
        """Take a decoder, from `decode_ahead`, that has begun with the images of the next scene."""
        if self._ahead is not None:
            self._ahead.cancel()
        self._ahead = ahead

    def holds(self, scene: Scene) -> bool:
        """Whether the last frame showed this scene, perhaps under other lights."""
        return self._surfaces.scene.has_surfaces_of(scene)

    def render(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> Image:
        """The picture in full precision: linear radiance in single floats, and as displayed."""
        self.draw(scene, camera, settings, size, half=False, still=True)
        linear = self.read_radiance()
        if isinstance(settings.background, tuple):
            linear += (1 - linear[..., 3:]) * np.array([*settings.background, 1], np.float32)
        return Image(linear, self.read_display(settings), {"plan": self.plan.to_json(), **self.caustic_stats()})

    def display(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> Image:
        """The picture as displayed, for a PNG. `linear` is then its sRGB decoding."""
        self.draw(scene, camera, settings, size, still=True)
        return Image.from_srgb(self.read_display(settings))

    @property
    def summary(self) -> str:
        """What preparing took, and the plan of the last frame in words, in one line."""
        times = ", ".join(f"{name} {seconds:.3f} s" for name, seconds in self.times.items())
        return "; ".join([f"preparing: {times}", "plan: " + "; ".join(self.plan.used if self.plan else ())])

    @property
    def texture_bytes(self) -> int:
        """About what the scene's textures take on the GPU."""
        return self._surfaces.textures.bytes

    @property
    def texture_seconds(self) -> float:
        """Spent on textures since the renderer was made, a part of "compile and upload" in `times`."""
        return self._surfaces.textures.seconds

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
        pixels = np.frombuffer(framebuffer.read(components=4), np.uint8).reshape(height, width, 4)
        return np.ascontiguousarray(pixels[::-1])

    def present(self, settings: Settings, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the frame drawn last into `framebuffer`, as displayed."""
        with self._pass("display"):
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
        given = scene
        scene = woven(as_yarns(scene.with_curve_radius(settings.curve_radius), settings), settings)
        if still and settings.antialias == "auto" and self.context.is_software and draws_curves(scene, settings):
            # Mesa shades hidden fragments of a multisampled target to their end, and strips have many of them.
            settings = replace(settings, antialias="ssaa-4")
        samples = settings.samples(self.context.is_software, still)
        target = self._sized_target(size, samples, half, settings.supersampling)
        plan = self._prepare(scene, settings, target, camera.height is not None)
        frame = Frame(scene, camera, target.drawn_size, self._depth.is_reversed)
        pixels = Frame(scene, camera, size, self._depth.is_reversed)
        uniforms = self._frame_uniforms(plan, frame, settings)
        target.set_part(part)
        with self._depth.test():
            self._draw_passes(plan, frame, pixels, target, uniforms, settings, still)
        self._gl.clear_samplers()
        with self._pass("resolve"):
            target.resolve(self.programs, UNIT_RADIANCE)
        self._has_caustics = still and part is None and settings.mode == "pbr" and settings.caustics == "photons"
        if self._has_caustics:
            with self._pass("photons"):
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

    def _draw_passes(self, plan: Plan, frame: Frame, pixels: Frame, target: Target,
                     uniforms: dict[str, object], settings: Settings, still: bool) -> None:
        """Draw the frame into `target`, with `pixels` the same view at one sample a pixel."""
        # Under supersampling visibility is found once a pixel, reflections at each point that is shaded.
        views = [pixels] * plan.has_visibility + [frame] * plan.has_traced_reflections
        if views:
            with self._pass("G-buffer"):
                gbuffers = self._drawn_gbuffers({view.size: view for view in views}, plan, uniforms)
        if plan.has_visibility:
            with self._pass("visibility"):
                uniforms |= self._visibility.find(pixels, plan, gbuffers[pixels.size])
        if plan.has_traced_reflections:
            with self._pass("reflections"):
                uniforms |= self._reflections.find(frame, gbuffers[frame.size], uniforms)
        media: dict[str, object] = {}
        if plan.media is not None:
            with self._pass("media"):
                media = self._media.march(frame, settings, plan, self._environment, uniforms, target.size, still)
                uniforms |= media
        if plan.spreads_subsurface:
            with self._pass("subsurface"):
                uniforms |= self._subsurface.find(
                    frame, lambda: self._surfaces.draw_gathered(frame, plan, uniforms), still)
        target.framebuffer.use()
        target.framebuffer.clear(depth=self._depth.far)  # alpha 0: the display pass adds the background colour
        with self._pass("surfaces"):
            self._surfaces.draw_opaque(frame, plan, uniforms)
        if plan.curves is not None:
            with self._pass("curves"):
                self._curves.draw(frame, settings, plan, target.samples, uniforms)
        if plan.has_solid_transmission:  # before the background: they refract the environment themselves
            with self._pass("solid transmission"):
                uniforms |= self._take_backdrop(target)
                if plan.has_traced_refraction:
                    uniforms |= self._refraction.find(
                        frame, plan, lambda u: self._surfaces.draw_refraction_rays(frame, plan, u), uniforms)
                    target.framebuffer.use()
                self._surfaces.draw_transmissive(SOLID, frame, plan, uniforms)
        if plan.background:
            with self._pass("background"):
                self._environment.draw_background(self.programs, self._depth, frame, target.half, plan, media)
        elif plan.media is not None:
            with self._pass("media behind which nothing stands"):
                self._media.draw_sky(self._depth, media, target.half)
        if plan.has_thin_transmission:
            with self._pass("thin-walled transmission"):
                uniforms |= self._take_backdrop(target)
                self._surfaces.draw_transmissive(THIN_WALLED, frame, plan, uniforms)
        if plan.has_blended:
            with self._pass("blend"):
                self._surfaces.draw_blended(frame, plan, uniforms)

    def _sized_target(self, size: tuple[int, int], samples: int, half: bool, supersampling: int) -> Target:
        samples = max(min(samples, self._gl.max_samples, self._gl.info["GL_MAX_COLOR_TEXTURE_SAMPLES"]), 1)
        if self._target is None or not self._target.fits(size, samples, half, supersampling):
            self._release(self._target)
            self._target = None  # should the next one fail
            self._target = Target(self._gl, self._depth, size, samples, half, supersampling)
        return self._target

    def _drawn_gbuffers(
        self, views: dict[tuple[int, int], Frame], plan: Plan, uniforms: dict[str, object]
    ) -> dict[tuple[int, int], GBuffer]:
        """Draw a G-buffer for each of these sizes; those of other sizes are released."""
        self._release(*(self._gbuffers.pop(size) for size in self._gbuffers.keys() - views.keys()))
        for size, view in views.items():
            if size not in self._gbuffers:
                self._gbuffers[size] = GBuffer(self._gl, self._depth, size)
            self._gbuffers[size].draw(lambda view=view: self._surfaces.draw_gbuffer(view, plan, uniforms))
        return self._gbuffers

    def _take_backdrop(self, target: Target) -> dict[str, object]:
        """Copy the picture so far, for transmissive surfaces. Leaves the target's framebuffer in use."""
        self._gl.clear_samplers()
        target.resolve(self.programs, UNIT_RADIANCE)
        backdrop = self._backdrop.get(lambda held: held.fits(target), lambda: Backdrop(self.context, target))
        uniforms = backdrop.take(self.programs, target.radiance, UNIT_RADIANCE)
        target.framebuffer.use()
        return uniforms

    def _prepare(self, scene: Scene, settings: Settings, target: Target, orthographic: bool) -> Plan:
        """Make everything that does not depend on the camera, unless an earlier frame has left it."""
        with self._timed("environment"):
            self._prepare_environment(scene, settings)
        self._prepare_surfaces(scene)
        background = settings.background if settings.background == "env" else "none"
        shading = replace(settings, exposure=0.0, tonemap="none", background=background)
        shape = scene if settings.indirect == "baked" else None  # which is left out of what is convex
        key = (scene.layout, scene.lights, scene.environment, shape, shading, target.samples, target.half, orthographic)
        self.plan = next((plan for k, plan in self._plans if k == key), None) or self._make_plan(scene, key)
        with self._timed("curves"):
            self._curves.prepare(scene, settings, self.plan, self._environment)
        if self.plan.shadow_layer_count:
            with self._timed("shadows"):
                self._prepare_shadows(scene, self.plan)
        if self.plan.media is not None:
            with self._timed("media"):
                self._media.prepare(scene, settings, self.plan, self._environment, self._shadows_of(self.plan),
                                    self._casters, self._surfaces.textures.mean)
        if self.plan.environment_shadows and self.plan.has_visibility:
            with self._timed("environment shadows"):
                self._visibility.prepare(scene, self.plan, self._environment, self._casters,
                                         self._surfaces.textures.mean)
        if self.plan.has_traced_reflections:
            with self._timed("reflections"):
                self._reflections.prepare(scene, settings)
        if self.plan.has_traced_refraction:
            with self._timed("refraction"):
                self._refraction.prepare(scene)
        if self._measured is not scene and (self.plan.has_subsurface or self._measured is not None):
            with self._timed("thickness of solids"):
                self._prepare_interiors(scene, self.plan)
        if self.plan.has_indirect:
            with self._timed("indirect light"):
                self._prepare_indirect(scene, settings, self.plan)
        return self.plan

    def _prepare_indirect(self, scene: Scene, settings: Settings, plan: Plan) -> None:
        """Bake indirect light at the vertices, anew under other lights."""
        key = (scene.lights, scene.environment, settings.ndf, settings.masking, settings.fresnel, settings.multiscatter,
               plan.has_subsurface)
        if self._indirect_key != key:
            from ..trace.chords import light_behind
            from ..trace.vertex_light import bake_incoming

            light = bake_incoming(self.context, scene, settings, programs=self.programs)
            solids = [draw.instance for draw in plan.draws if draw.has_subsurface]
            self._surfaces.light_vertices(light, light_behind(self.context, scene, solids, light) if solids else {})
            self._indirect_key = key

    def _prepare_interiors(self, scene: Scene, plan: Plan) -> None:
        """Take the thickness of the solids that scatter light, which is measured if it has changed."""
        solids = [draw.instance for draw in plan.draws if draw.has_subsurface]
        thickness = self._interiors.take(scene, solids)
        if thickness is not None:
            self._surfaces.set_interiors(thickness)
        self._measured = scene if solids else None

    def _prepare_surfaces(self, scene: Scene) -> None:
        """Take what is drawn. A pose of the scene before keeps its plan, and maps that are drawn anew."""
        is_alike = self._generation == self.programs.generation
        if not self.holds(scene):
            is_alike &= scene.layout == self._surfaces.scene.layout
            self._surfaces.take(scene, self._ahead)
            self._ahead = self._indirect_key = None
        if not is_alike:
            self._release(*self._shadows)
            self._visibility.drop_shadows()
            self._generation, self._shadows, self._plans = self.programs.generation, [], []
        self._surfaces.scene = scene

    def _make_plan(self, scene: Scene, key: tuple[Any, ...]) -> Plan:
        settings, samples, half, orthographic = key[-4:]
        is_lit, is_reflected = environment_use(scene, settings)
        if is_lit:
            with self._timed("environment"):
                self._environment.bake(is_reflected or (settings.mode == "pbr" and has_media(scene, settings)))
        plan = plan_scene(scene, settings, self._lights(scene, settings), samples=samples, half_target=half,
                          orthographic=orthographic)
        self._surfaces.textures.prefetch(plan)
        with self._timed("compile and upload"):
            self._surfaces.prepare(plan)
        self._plans = [(key, plan), *self._plans][:_KEPT]
        return plan

    def _prepare_environment(self, scene: Scene, settings: Settings) -> None:
        environment = scene.environment or (_BLACK if settings.plan == "everything" else None)
        if environment is None:
            self._release(self._environment)
            self._environment = None
        elif self._environment is None or not self._environment.holds(environment, settings):
            self._release(self._environment)
            self._environment = None  # should the next one fail
            self._plans = []  # what they need of the environment is baked when they are made
            self._environment = EnvironmentLight(self.context, environment, settings, self._use_cache)
        if self._environment is not None:
            self._environment.environment = environment

    def _lights(self, scene: Scene, settings: Settings) -> list[Light]:
        from_environment = self._environment.lights(settings) if self._environment is not None else []
        return [*scene.lights, *from_environment]

    def _prepare_shadows(self, scene: Scene, plan: Plan) -> None:
        maps = self._shadows_of(plan)
        if maps is None:
            self._shadows, dropped = self._shadows[:_KEPT - 1], self._shadows[_KEPT - 1:]
            self._release(*dropped)
            maps = ShadowMaps(self._gl, plan, self._casters)
            self._shadows.insert(0, maps)
        maps.show(scene, plan)

    def _shadows_of(self, plan: Plan) -> ShadowMaps | None:
        return next((maps for maps in self._shadows if maps.holds(plan)), None)

    def _frame_uniforms(self, plan: Plan, frame: Frame, settings: Settings) -> dict[str, object]:
        """The uniforms that all surfaces share; fills the uniform blocks and binds the shared textures."""
        values: dict[str, object] = {
            "u_view_projection": matrix_uniform(frame.view_projection),
            "u_view_direction": tuple(-frame.camera.forward),
            "u_drawn_size": frame.size,
            "u_point_size": max(1.0, frame.size[1] / 200),
        }
        if self._environment is not None:
            values |= self._environment.uniforms(plan)
        if plan.dfg:
            self._dfg_texture(settings, plan.reflections).use(UNIT_DFG)
            values["u_dfg"] = UNIT_DFG
        if plan.is_everything:  # the programs of opaque surfaces have code for glass, too
            self._surfaces.textures.bind_blank("base_color", UNIT_RADIANCE)
            values["u_backdrop"] = UNIT_RADIANCE
        blocks = [pack_lights(plan, frame)] if plan.lights else []
        shadows = self._shadows_of(plan)
        if shadows is not None:
            blocks.append(shadows.pack(frame))
            shadows.texture.use(UNIT_SHADOW)
            values |= {"u_shadow_map": UNIT_SHADOW, "u_shadow_tile_size": float(shadows.tile_size)}
        self._release(*self._blocks)
        self._blocks = [self._gl.buffer(np.ascontiguousarray(block)) for block in blocks]
        for binding, block in enumerate(self._blocks):
            block.bind_to_uniform_block(binding)
        return values

    def _dfg_texture(self, settings: Settings, looks_up: bool) -> moderngl.Texture:
        """With the lookups of an environment if there is one that is reflected."""
        key = (settings.ndf, settings.masking, looks_up)
        if key not in self._dfg:
            table = (dfg_table if looks_up else dfg_albedos)(settings.ndf, settings.masking)
            self._dfg[key] = float_texture(self._gl, table)
        return self._dfg[key]

    @contextmanager
    def _timed(self, name: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.times[name] = self.times.get(name, 0.0) + time.perf_counter() - start

    @contextmanager
    def _pass(self, name: str) -> Iterator[None]:
        """Time a pass. Timer queries do not count the work of a software rasteriser, so we wait and read the clock."""
        if not self._measure:
            yield
            return
        self._gl.finish()
        start = time.perf_counter()
        yield
        self._gl.finish()
        self.pass_ms[name] = (time.perf_counter() - start) * 1e3

    def _release(self, *things) -> None:
        """Free these; no framebuffer is in use afterwards."""
        self._gl.screen.use()  # moderngl goes back to the framebuffer last used, be it gone
        for thing in things:
            if thing is not None:
                thing.release()

    def release(self) -> None:
        """Free what the renderer holds; the context stays."""
        self.context.make_current()
        self._release(self._display, self._caustics, self._target, self._backdrop, self._visibility, self._reflections,
                      self._refraction, self._media, self._subsurface, *self._gbuffers.values(), self._surfaces,
                      self._curves, self._environment, *self._shadows, *self._blocks, *self._dfg.values())
        self.programs.release()
