"""The passes of a frame, in their order."""

from __future__ import annotations

import moderngl

from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.programs import Programs
from ..plan.model import SOLID, THIN_WALLED, Plan
from ..scene.frame import Frame
from ..settings import Settings
from .baked_vertices import BakedVertices
from .curves import CurvePass
from .deferred import DeferredSurfaces
from .depth import Depth
from .frame_uniforms import FrameUniforms
from .gbuffer import GBuffer
from .grid import GridPass
from .ground import GroundPass
from .layers import LayerPass
from .media import MediaPass
from .overdraw import Overdraw
from .prepared import Prepared
from .shadows import Casters, KeptShadowMaps
from .stopwatch import Stopwatch
from .subsurface import SubsurfacePass
from .surface_casters import SurfaceCasters
from .target import Target
from .traced.reflections import TracedReflections
from .traced.refraction import TracedRefraction
from .transmission import Backdrop
from .units import UNIT_RADIANCE, UNIT_SEEN_POSITIONS
from .visibility import MOST_POINTS, VisibilityPass
from .walls import Wall, layers_of
from .wireframe import Wireframe


class Passes:
    """Draws the frames of a prepared scene into targets. Each pass has its own programs and targets."""

    def __init__(self, context: Context, programs: Programs, depth: Depth, prepared: Prepared,
                 watch: Stopwatch) -> None:
        gl = context.gl
        self._context, self._gl, self._programs, self._depth = context, gl, programs, depth
        self._prepared, self._watch = prepared, watch
        self.curves = CurvePass(context, programs, depth)
        meshes = SurfaceCasters(programs, prepared.surfaces)
        self._casters = Casters(meshes.prepare, meshes.prepare_tint, self.curves.draw_depth)
        self._shadows = KeptShadowMaps(gl, self._casters)
        self._uniforms = FrameUniforms(gl, prepared, self._shadows)
        self._gbuffers: dict[tuple[int, int], GBuffer] = {}
        self._visibility = VisibilityPass(context, programs, prepared.use_cache)
        self.reflections = TracedReflections(context, programs)
        self._media = MediaPass(context, programs)
        self._subsurface = SubsurfacePass(context, programs, depth)
        self._backdrop: Reusable[Backdrop] = Reusable()
        self.refraction = TracedRefraction(context, programs, depth)
        self._overdraw = Overdraw(context, programs, depth)
        self._wireframe = Wireframe(context, programs)
        self._grid = GridPass(context, programs, depth)
        self._vertices = BakedVertices(context, programs, prepared.surfaces.baked, watch)
        self._ground = GroundPass(context, programs, depth, self._casters, prepared.use_cache)
        self.layers = LayerPass(gl, depth, prepared, self.curves, self._uniforms, watch)
        self._deferred = DeferredSurfaces(context, programs, depth, prepared.surfaces)
        self._generation = prepared.generation

    def prepare(self, pixels: Frame, settings: Settings, plan: Plan) -> None:
        """Make what the passes of `plan` need of the whole scene, unless an earlier frame has left it. `pixels` is the
        view at one sample a pixel."""
        scene = pixels.scene
        environment, mean = self._prepared.environment, self._prepared.surfaces.textures.mean
        if self._generation != self._prepared.generation:
            self._generation = self._prepared.generation
            self._shadows.release()
            self._visibility.forget_scene(plan)
            self._ground.release()
        with self._watch.preparing("curves"):
            self.curves.prepare(scene, settings, plan, environment)
        if plan.shadow_layer_count:
            with self._watch.preparing("shadows"):
                self._shadows.show(scene, plan)
        if plan.media is not None:
            with self._watch.preparing("media"):
                self._media.prepare(scene, settings, plan, environment, self._shadows.of(plan), self._casters, mean)
        if plan.environment_shadows and plan.has_visibility:
            with self._watch.preparing("environment shadows"):
                self._visibility.prepare(pixels, plan, environment, self._media.light_in_fog(plan), self._casters, mean)
        if plan.ground is not None:
            with self._watch.preparing("ground"):
                self._ground.prepare(scene, plan, environment)
        if plan.has_traced_reflections:
            with self._watch.preparing("reflections"):
                self.reflections.prepare(scene, settings)
        if plan.has_traced_refraction:
            with self._watch.preparing("refraction"):
                self.refraction.prepare(scene)
        self._vertices.prepare(scene, settings, plan)

    def draw(self, plan: Plan, frame: Frame, pixels: Frame, target: Target, settings: Settings, still: bool) -> None:
        """Draw the frame into `target`, with `pixels` the same view at one sample a pixel. `still` is for a picture
        that is kept."""
        uniforms = self._uniforms.fill(plan, frame, settings)
        with self._depth.test():
            uniforms |= self._draw_before_surfaces(plan, frame, pixels, uniforms, still)
            media = self._march_media(plan, frame, target, settings, uniforms, still)
            uniforms |= media
            if plan.spreads_subsurface:
                with self._watch.drawing("subsurface"):
                    uniforms |= self._subsurface.find(
                        frame, lambda: self._prepared.surfaces.draw_gathered(frame, plan, uniforms), still)
            if plan.counts:
                self._count(plan, frame, target, settings, uniforms)
                return
            target.behind = None
            if not plan.has_deferred:
                target.framebuffer.use()
                target.framebuffer.clear(depth=self._depth.far)  # alpha 0: the display pass adds the background colour
            self._draw_surfaces(plan, frame, pixels, target, settings, uniforms, media)

    def _draw_before_surfaces(self, plan: Plan, frame: Frame, pixels: Frame, uniforms: dict[str, object],
                              still: bool) -> dict[str, object]:
        """Find what surfaces look up for each pixel. Under supersampling visibility is found once a pixel or
        less, reflections at each point that is shaded."""
        found: dict[str, object] = {}
        seen = _seen(plan, pixels)
        views = [seen] * (plan.has_visibility or plan.has_gaps) + [frame] * plan.has_traced_reflections
        if views:
            with self._watch.drawing("G-buffer"):
                gbuffers = self._drawn_gbuffers({view.size: view for view in views}, plan, uniforms)
        if plan.uses_visibility(has_gaps=False):
            with self._watch.drawing("visibility"):
                found |= self._visibility.find(seen, plan, gbuffers[seen.size])
        if plan.has_traced_reflections:
            with self._watch.drawing("reflections"):
                found |= self.reflections.find(frame, gbuffers[frame.size], uniforms | found, still)
        return found

    def _march_media(self, plan: Plan, frame: Frame, target: Target, settings: Settings, uniforms: dict[str, object],
                     still: bool) -> dict[str, object]:
        if plan.media is None:
            return {}
        with self._watch.drawing("media"):
            return self._media.march(frame, settings, plan, self._prepared.environment, uniforms, target.size, still)

    def _draw_surfaces(self, plan: Plan, frame: Frame, pixels: Frame, target: Target, settings: Settings,
                       uniforms: dict[str, object], media: dict[str, object]) -> None:
        """Draw what is seen, each pass over what those before have left in `target`."""
        surfaces, drawing = self._prepared.surfaces, self._watch.drawing

        def draw_behind() -> None:
            if plan.background:
                with drawing("background"):
                    self._draw_background(frame, target, plan, media)
            elif plan.media is not None:
                with drawing("media without background"):
                    self._media.draw_sky(self._depth, media, target.half)
            if plan.ground is not None:
                with drawing("ground"):
                    self._ground.draw(frame, plan, uniforms)

        if plan.has_deferred:
            with drawing("deferred surfaces"):
                target.behind = self._deferred.draw(frame, plan, target, uniforms, draw_behind)
            target.framebuffer.use()
        if plan.has_surfaces:
            with drawing("surfaces"):
                surfaces.draw_opaque(frame, plan, uniforms)
        if plan.curves is not None:
            with drawing("curves"):
                self.curves.draw(frame, settings, plan, target.samples, uniforms)
        if plan.has_solid_transmission:  # before the background: they refract the environment themselves
            with drawing("solid transmission"):
                self._draw_transmissive(SOLID, plan, frame, target, uniforms)
        if not plan.is_over_layers:
            draw_behind()
        if plan.grid:  # behind thin panes and what blends
            with drawing("grid"):
                self._grid.draw_ground(frame, target, settings)
        if plan.has_thin_transmission:
            with drawing("thin-walled transmission"):
                self._draw_transmissive(THIN_WALLED, plan, frame, target, uniforms)
        if plan.has_blended:
            if plan.has_gaps:
                uniforms |= self._draw_before_cloth(plan, _seen(plan, pixels), target, uniforms)
            with drawing("blend"):
                surfaces.draw_blended(frame, plan, uniforms)
        if plan.wireframe:
            with drawing("wireframe"):
                self._wireframe.draw(frame, target)
        if plan.grid:
            self._grid.draw_axes(frame, target, settings)

    def _draw_transmissive(self, kind: int, plan: Plan, frame: Frame, target: Target,
                           uniforms: dict[str, object]) -> None:
        """Draw the THIN_WALLED or SOLID surfaces (`kind`), each layer over a copy of what is behind it. Where paths are
        traced through solids, these find each other."""
        surfaces = self._prepared.surfaces
        draws = surfaces.transmissive(kind, frame, plan)
        is_traced = kind == SOLID and plan.has_traced_refraction
        for layer in [[Wall(draw) for draw in draws]] if is_traced else layers_of(draws, frame):
            uniforms |= self._take_backdrop(target)
            if is_traced:
                uniforms |= self.refraction.find(
                    frame, plan, lambda rays: surfaces.draw_refraction_rays(frame, plan, rays), uniforms)
                target.framebuffer.use()
            surfaces.draw_walls(layer, frame, uniforms)

    def _draw_background(self, frame: Frame, target: Target, plan: Plan, media: dict[str, object]) -> None:
        self._prepared.environment.draw_background(self._programs, self._depth, frame, target.half, plan, media)

    def _count(self, plan: Plan, frame: Frame, target: Target, settings: Settings, uniforms: dict[str, object]) -> None:
        """Draw how many fragments there are in each pixel."""
        def draw_all() -> None:
            self._prepared.surfaces.draw_counted(frame, plan, uniforms)
            self.curves.draw(frame, settings, plan, target.samples, uniforms, moderngl.BLEND)

        with self._watch.drawing("overdraw"):
            self._overdraw.draw(target, draw_all)

    def _drawn_gbuffers(
        self, views: dict[tuple[int, int], Frame], plan: Plan, uniforms: dict[str, object]
    ) -> dict[tuple[int, int], GBuffer]:
        """Draw a G-buffer for each of these sizes; those of other sizes are released."""
        free(self._gl, *(self._gbuffers.pop(size) for size in self._gbuffers.keys() - views.keys()))
        for size, view in views.items():
            if size not in self._gbuffers:
                self._gbuffers[size] = GBuffer(self._gl, self._depth, size)
            self._gbuffers[size].draw(lambda view=view: self._prepared.surfaces.draw_gbuffer(
                view, plan, uniforms, has_gaps=False))
        return self._gbuffers

    def _draw_before_cloth(self, plan: Plan, seen: Frame, target: Target,
                           uniforms: dict[str, object]) -> dict[str, object]:
        """Find what cloth with gaps looks up: which of it is the nearest, and its visibility. It is found anew, since
        what shows in the gaps needs its own. Leaves the target's framebuffer in use."""
        gbuffer = self._gbuffers[seen.size]
        with self._watch.drawing("G-buffer"):
            gbuffer.draw(lambda: self._prepared.surfaces.draw_gbuffer(seen, plan, uniforms, has_gaps=True))
        if plan.uses_visibility(has_gaps=True):
            with self._watch.drawing("visibility"):
                found = self._visibility.find(seen, plan, gbuffer)
        else:
            gbuffer.positions.use(UNIT_SEEN_POSITIONS)
            found = {"u_positions": UNIT_SEEN_POSITIONS}
        target.framebuffer.use()
        return found

    def _take_backdrop(self, target: Target) -> dict[str, object]:
        """Copy the picture so far, for transmissive surfaces. Leaves the target's framebuffer in use."""
        self._gl.clear_samplers()
        backdrop = self._backdrop.get(lambda held: held.fits(target), lambda: Backdrop(self._context, target))
        uniforms = backdrop.take(self._programs, target, UNIT_RADIANCE)
        target.framebuffer.use()
        return uniforms

    def release(self) -> None:
        free(self._gl, self._backdrop, self._visibility, self.reflections, self.refraction, self._media,
             self._subsurface, self._deferred, *self._gbuffers.values(), self._overdraw, self._wireframe, self._grid,
             self.curves, self._shadows, self._uniforms, self.layers, self._ground)


def _seen(plan: Plan, pixels: Frame) -> Frame:
    """The points at which the visibility of the environment is found."""
    return pixels.within(MOST_POINTS) if plan.environment_shadows else pixels
