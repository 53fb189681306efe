"""The path tracer: renders a scene, a camera and settings to a picture that converges to the correct one."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from ..bake.dfg import dfg_albedos
from ..bake.rough_glass import with_rough_glass
from ..bake.stretched import stretched_levels
from ..base.heap import trim_heap
from ..errors import UsageError
from ..gpu.context import Context
from ..gpu.float_texture import float_texture
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..image.image import Image
from ..scene.camera import Camera
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..scene.woven import woven
from ..scene.yarn.spun import spun
from ..settings import MAX_SPP, Settings
from .denoise.denoiser import Denoiser, make_denoiser
from .layout import TILE
from .paths.camera_rays import camera_uniforms
from .paths.coverage import LastCoverage
from .paths.film import Film
from .paths.layers import FIRST_HIT_LAYERS
from .paths.passes import Passes
from .paths.path_render import PathRender
from .paths.photon_passes import PhotonPasses
from .paths.photon_render import PhotonRender
from .paths.photon_sums import PhotonSums
from .paths.run import run
from .paths.schedule import Schedule
from .paths.sky import UNIT_SKY, Sky, points_of
from .paths.surface_rays import UNITS as RAY_UNITS
from .paths.surface_rays import SurfaceRays
from .paths.wavefront import UNIT_BLOCKS
from .paths.wavefront_maker import WavefrontMaker
from .plan import TracePlan, plan_trace
from .scene.photons import Photons
from .scene.traced_scene import TracedScene

UNIT_DFG = UNIT_BLOCKS + 1


@dataclass(frozen=True)
class _View:
    """Camera rays: their uniforms, the angle of a pixel, the place of a perspective camera in tracer space, and what
    `coverage` needs to know, or None if all pixels are traced."""

    uniforms: Mapping[str, object]
    pixel_angle: float
    eye: NDArray | None
    seen: tuple[Scene, Camera, tuple[int, int], int] | None

    @classmethod
    def of(cls, scene: Scene, camera: Camera, size: tuple[int, int], every: int = 1) -> _View:
        return cls(camera_uniforms(scene, camera, size, every), Frame(scene, camera, size).pixel_angle,
                   (camera.eye - scene.center) / scene.radius if camera.height is None else None,
                   (scene, camera, size, every))


@dataclass(frozen=True)
class _SetUp:
    """What a picture needs before its passes: `use_textures` binds all its textures, `uniforms` are the picture's, and
    `covered` and `sky_points` those of its `Sky`, if it has one."""

    traced: TracedScene
    plan: TracePlan
    use_textures: Callable[[], None]
    uniforms: Mapping[str, object]
    denoiser: Denoiser | None
    has_layers: bool
    covered: NDArray[np.bool_] | None
    sky_points: int


class Tracer:
    """Traces scenes with one OpenGL context.

    It keeps the data and the intersector of the last scene, and all programs. Scenes are compared by identity; what a
    scene shares with the last one is not prepared again. `intersector` is auto, embree or bvh.
    """

    def __init__(self, context: Context, use_cache: bool = True, intersector: str = "auto",
                 programs: Programs | None = None) -> None:
        self.context = context
        self.programs = programs if programs is not None else Programs(context)
        self._owns_programs = programs is None
        self._use_cache = use_cache
        self._intersector = intersector
        self._display = DisplayPass(context.gl, self.programs)
        self._scene: TracedScene | None = None
        self._dfg: dict[tuple[str, str, bool, bool], moderngl.Texture] = {}
        self._denoisers: dict[str, Denoiser] = {}
        self._shown: tuple[Scene, Scene] | None = None
        self._coverage = LastCoverage()

    def render(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
               layers: Collection[str] = (), guide: NDArray | None = None, started: float | None = None) -> Image:
        """The picture with all its samples, or with those that the time budget allows, which began at `started`, by
        time.perf_counter, or begins now. Raises as `begin`."""
        started = time.perf_counter() if started is None else started
        path_render = self.begin(scene, camera, settings, size, layers, guide=guide)
        try:
            prepared = time.perf_counter() - started
            run(path_render, started)
            image = path_render.image()
            return replace(image, stats={"prepare_s": {"scene": prepared}, **image.stats})
        finally:
            path_render.release()

    def begin(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
              layers: Collection[str] = (), every: int = 1, guide: NDArray | None = None, first: int = 0,
              is_interactive: bool = False) -> PathRender:
        """A progressive render that has no samples yet. Its samples are numbered from `first` on, so that the sums of
        several are those of one picture.

        With `every` of 2 or more the picture is of each so many'th pixel along both axes, size // every of them.
        `layers` are names of `viewer.trace.paths.layers.read_layers`. `denoise="raster"` needs a `guide`: what the
        raster draws of the same, linear radiance (H, W, 3) (`viewer.estimate.mixture.draw_guide`). Raises UsageError
        for a size that this OpenGL cannot draw, a denoiser that is not installed or without its guide, InputError for a
        scene that does not fit. The render can be continued until another scene is begun. `is_interactive` is for views
        that handle input between two steps: they take less time, with slightly fewer rays a second.
        """
        if settings.denoise == "raster" and guide is None:
            raise UsageError("denoise raster is for pictures of render: here the raster draws nothing")
        scene = self._with_curves(scene, settings)
        return self._begin(scene, settings, (size[0] // every, size[1] // every), layers,
                           view=_View.of(scene, camera, size, every), guide=guide, first=first,
                           is_interactive=is_interactive)

    def begin_photons(self, scene: Scene, camera: Camera, settings: Settings,
                      size: tuple[int, int]) -> PhotonRender | None:
        """What photons alone bring to a picture, without any yet; None if there is nothing, of which `photons` says
        why. They have all light of lamps that comes through smooth glass, also that which in mode path shadow rays
        bring straight through panes. Raises as `begin`."""
        scene = self._with_curves(scene, settings)
        view = replace(_View.of(scene, camera, size), seen=None)
        setup = self._set_up(scene, settings, size, (), view=view, is_for_photons=True)
        plan, traced = setup.plan, setup.traced
        if not plan.photons:
            return None
        passes = self._photon_passes(setup, lamps_pass_panes=False)
        try:
            sums = PhotonSums(self.context.gl, self.programs, size)
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} is more than this OpenGL can hold ({error})") from error
        maker = WavefrontMaker(self.context, plan, MAX_SPP)
        return PhotonRender(passes, traced.intersector, sums, maker)

    def begin_at(self, scene: Scene, rays: SurfaceRays, settings: Settings) -> PathRender:
        """As `begin`, with one pixel for each ray of the list. Alpha is the fraction of rays that hit something."""
        scene = self._with_curves(scene, settings)
        settings = replace(settings, background="none", caustics="off")
        return self._begin(scene, settings, rays.size, (), rays)

    def _begin(self, scene: Scene, settings: Settings, size: tuple[int, int], layers: Collection[str],
               rays: SurfaceRays | None = None, view: _View | None = None, guide: NDArray | None = None,
               first: int = 0, is_interactive: bool = False) -> PathRender:
        """The rays begin at `rays` or at the camera of `view`."""
        setup = self._set_up(scene, settings, size, layers, rays, view)
        plan = setup.plan
        film = Film(self.context.gl, self.programs, size, setup.has_layers, bool(plan.photons),
                    has_parts=settings.denoise in ("fast", "raster"))
        sky, use_textures = None, setup.use_textures
        if setup.covered is not None:
            sky = Sky(self.context, setup.covered, setup.sky_points, bool(plan.programs["sky"]["BACKGROUND"]))

            def use_textures() -> None:
                setup.use_textures()
                sky.texture.use(UNIT_SKY)

        passes = Passes(self.context, self.programs, plan, use_textures, setup.traced.set_uniforms,
                        {**setup.uniforms, "u_sky": UNIT_SKY})
        photons = self._photon_passes(setup, lamps_pass_panes=True) if plan.photons else None
        traced = np.full(film.tiles[::-1], TILE**2)
        if sky is not None:
            traced = sky.covered.sum(axis=(2, 3)) if plan.is_sorted else TILE**2 * ~sky.is_bare
        schedule = Schedule(film, settings, first, None if plan.photons else traced)  # photons come after small rounds
        return PathRender(passes, setup.traced.intersector, plan, film, schedule, settings,
                          self._display, layers, setup.denoiser, photons, guide, sky, is_interactive, first)

    def _set_up(self, scene: Scene, settings: Settings, size: tuple[int, int], layers: Collection[str],
                rays: SurfaceRays | None = None, view: _View | None = None, is_for_photons: bool = False) -> _SetUp:
        """As `_begin`: the scene and the plan, and what binds their data to programs."""
        self.context.make_current()
        scene = woven(scene, settings)
        denoiser = self._denoiser(settings.denoise)
        traced = self._prepare(scene, settings, is_for_photons)
        has_layers = bool(FIRST_HIT_LAYERS & set(layers)) or denoiser is not None or traced.is_everything
        angle = view.pixel_angle if view is not None else 0.0
        covered = self._coverage(traced.geometry, *view.seen) if view is not None and view.seen is not None else None
        plan = plan_trace(scene, settings, traced.geometry, traced.switches, intersector=traced.intersector.name,
                          has_layers=has_layers, left_out=traced.left_out, rays=rays.kind if rays else 0,
                          is_background_smooth=traced.is_background_smooth(angle), photons=traced.photons,
                          has_sky=covered is not None,
                          is_sorted=self.context.is_software and traced.intersector.tells_classes)
        uniforms = {
            **(view.uniforms if view is not None else {}),
            **traced.media_uniforms(view.eye if view is not None else None),
            "u_size": size, "u_seed": settings.seed, "u_bounces": settings.bounces, "u_clamp": settings.clamp or 3e38,
            "u_dfg": UNIT_DFG, **RAY_UNITS,
        }
        dfg = self._dfg_texture(settings, plan)

        def use_textures() -> None:
            traced.use_textures()
            dfg.use(UNIT_DFG)
            if rays is not None:
                rays.use_textures()

        points = points_of(traced.background_rows, angle)
        return _SetUp(traced, plan, use_textures, uniforms, denoiser, has_layers, covered, points)

    def _photon_passes(self, setup: _SetUp, lamps_pass_panes: bool) -> PhotonPasses:
        uniforms = {**setup.uniforms, "u_lamps_pass_panes": lamps_pass_panes}
        return PhotonPasses(self.context, self.programs, setup.plan, setup.use_textures, setup.traced.set_uniforms,
                            uniforms)

    def holds(self, scene: Scene) -> bool:
        """Whether the last picture was of this scene; its lights may differ."""
        shown = scene if self._shown is None or self._shown[0] is not scene else self._shown[1]
        return self._scene is not None and self._scene.holds(shown)

    @property
    def photons(self) -> Photons | None:
        """What photons of the last scene are aimed at."""
        return None if self._scene is None else self._scene.photons

    @property
    def texture_bytes(self) -> int:
        """About the size of the last scene's textures on the GPU."""
        return self._scene.texture_bytes if self._scene is not None else 0

    def _with_curves(self, scene: Scene, settings: Settings) -> Scene:
        """The scene with its curves as the settings show them: the same object as last time, if they are the same."""
        shown = spun(scene.with_curve_radius(settings.curve_radius), settings)
        known = self._shown
        if known is not None and known[0] is scene and all(a is b for a, b in zip(known[1].curves, shown.curves)):
            return known[1]
        self._shown = scene, shown
        return shown

    def _denoiser(self, kind: str) -> Denoiser | None:
        if kind == "off":
            return None
        kind = "fast" if kind == "raster" else kind  # which has a guide, too
        if kind not in self._denoisers:
            self._denoisers[kind] = make_denoiser(self.context, self.programs, kind)
        return self._denoisers[kind]

    def _prepare(self, scene: Scene, settings: Settings, is_for_photons: bool) -> TracedScene:
        held, kind = self._scene, (settings.plan == "everything", is_for_photons)
        if held is not None and (held.is_everything, held.is_for_photons) == kind:
            if held.holds(scene) and held.has_fog_of(scene, settings):
                held.relight(scene, settings)
                return held
            if held.move(scene, settings):
                return held
        if held is not None:
            held.release()
        self._scene = None  # in case that the next one fails
        self._scene = TracedScene(self.context, scene, settings, self._intersector, is_for_photons)
        return self._scene

    def _dfg_texture(self, settings: Settings, plan: TracePlan) -> moderngl.Texture:
        programs = plan.programs.values()
        stretches = any(program.get("ANISOTROPIC") for program in programs)
        roughens = any(program.get("HAS_ROUGH_GLASS") and program.get("MULTISCATTER") for program in programs)
        key = settings.ndf, settings.masking, stretches, roughens
        if key not in self._dfg:
            table = dfg_albedos(*key[:2])
            levels = stretched_levels(settings.masking) if stretches else ()
            self._dfg[key] = float_texture(
                self.context.gl, with_rough_glass(table, settings.masking) if roughens else table, *levels)
        return self._dfg[key]

    def forget(self) -> None:
        """Free what only the last scene needs."""
        self.context.make_current()
        if self._scene is not None:
            self._scene.release()
        self._scene, self._shown, self._coverage = None, None, LastCoverage()
        trim_heap()

    def release(self) -> None:
        """Free the resources of the tracer. The context stays, and so do programs that it was given."""
        self.context.make_current()
        if self._scene is not None:
            self._scene.release()
        for texture in self._dfg.values():
            texture.release()
        for denoiser in self._denoisers.values():
            denoiser.release()
        self._display.release()
        if self._owns_programs:
            self.programs.release()
