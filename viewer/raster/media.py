"""Fog and volumes between the eye and what is seen: rays are marched once a frame, and surfaces look up what lies
before them.

shaders/raster/media_march.frag stores, for each of a grid of rays and at the ends of SLICE_COUNT slices along them, the
light that has come together and what of the light behind has been lost: the froxels of Wronski 2014 and Hillaire 2015.
As the textures depend on no surface, opaque, transmissive and blended surfaces and each sample of a pixel find their
own share by their distance.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..plan.media import MAX_VOLUMES, SLICE_COUNT, travelled
from ..plan.model import Draw, Plan
from ..scene.camera import Camera
from ..scene.fog import REACH, fog_medium, fog_of
from ..scene.frame import Frame
from ..scene.medium import VACUUM, Medium
from ..scene.phase import mean_cosine
from ..scene.scene import Scene
from ..scene.volume import volume_medium
from ..settings import Settings
from .depth import Depth
from .environment import EnvironmentLight
from .lights import pack_lights
from .media_light import DEPTH_SIDE, SIDE, Grid, MediaLight
from .media_slices import MediaSlices
from .shadows import Casters, ShadowMaps
from .sky_shadows import SkyShadows, mean_surface
from .units import UNIT_MEDIA, UNIT_MEDIA_LIGHT, UNIT_SHADOW, UNIT_SKY_SHADOWS, UNIT_VOLUME_DEPTH
from .volume_textures import VolumeTextures

_KEPT = 2
"""How many bakes of light are kept: a window that is split between two modes draws with two in turn."""
_PIXELS = {"all": 1, "quarter": 2, "ninth": 3, "sixteenth": 4}
"""The side of the square of pixels that has a ray."""
_GRID_MARGIN = 0.25
"""Of the grid about the volumes, in lengths of their box at each side: surfaces close by are in their light, too."""
_NEAR = 3.0
"""How far, in cells of the grid of optical depths, dense volumes are looked at themselves towards a light."""


class MediaPass:
    """The passes of the media of a scene, and what they keep from frame to frame."""

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context, self._gl, self._programs = context, context.gl, programs
        self._slices: MediaSlices | None = None
        self._lights: list[tuple[tuple[object, ...], MediaLight]] = []
        self._volumes: VolumeTextures | None = None
        self._scene: Scene | None = None

    def prepare(self, scene: Scene, settings: Settings, plan: Plan, environment: EnvironmentLight | None,
                shadows: ShadowMaps | None, casters: Casters, mean: Callable[[Draw, str], np.ndarray]) -> None:
        """Upload volumes and bake the light in the media, unless an earlier frame has left them. Binds uniform blocks
        of its own. `casters` draw what stands before the environment, and `mean` gives that of a material's map."""
        self._take_volumes(scene)
        sky = environment.environment if environment is not None else None
        key = (fog_of(scene, settings), volume_medium(settings), plan.media.bake, plan.media.scatters_again,
               plan.lights, plan.ambient, sky and (environment, sky.rotation, sky.intensity))
        if self._scene is None or not scene.has_surfaces_of(self._scene):
            self._drop_lights(0)
        self._scene = scene
        held = next((light for k, light in self._lights if k == key), None)
        if held is not None:
            self._lights = [(key, held), *(pair for pair in self._lights if pair[1] is not held)]
            return
        middle = np.eye(4)
        middle[:3, 3] = scene.center
        frame = Frame(scene, Camera(middle), (1, 1))
        uniforms = self._uniforms(frame, settings)
        blocks = [pack_lights(plan, frame)] if plan.lights else []
        if shadows is not None:
            blocks.append(shadows.pack(frame))
            shadows.texture.use(UNIT_SHADOW)
            uniforms |= {"u_shadow_map": UNIT_SHADOW, "u_shadow_tile_size": float(shadows.tile_size)}
        buffers = [self._gl.buffer(np.ascontiguousarray(block)) for block in blocks]
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_uniform_block(binding)
        grids = [grid for grid in _grids(frame, settings) if grid is not None]
        self._drop_lights(_KEPT - 1)
        from_sky = environment.sky_lights(plan) if environment is not None else None
        around_meshes, sky_shadows = [], None
        if plan.media.parts_past_meshes:
            around_meshes = [_scene_grid(frame, grids[0].medium)] * plan.media.has_fog
            reflectance = mean_surface(scene, plan.draws, mean).reflectance
            uniforms["u_reflectance"] = tuple(reflectance)
            if plan.media.has_sky_shadows and from_sky is not None:
                sky_shadows = SkyShadows(self._gl, scene, plan, from_sky, casters, reflectance)
                uniforms |= sky_shadows.uniforms
                sky_shadows.texture.use(UNIT_SKY_SHADOWS)
        parts = (3 * len(grids) + plan.media.parts_past_meshes * (len(grids) + len(around_meshes))
                 + (plan.media.glow is not None))
        light = MediaLight(self._gl, parts, len(plan.lights) if scene.volumes else 0)
        light.bake(self._programs, plan.media, grids, around_meshes, from_sky, shadows, uniforms)
        self._lights.insert(0, (key, light))
        for thing in (*buffers, sky_shadows):
            if thing is not None:
                thing.release()

    def light_in_fog(self, plan: Plan) -> MediaLight | None:
        """The light that was prepared last, if there is fog all around the scene."""
        return self._lights[0][1] if plan.media is not None and plan.media.has_fog else None

    def _drop_lights(self, count: int) -> None:
        """All but the `count` that were used last."""
        for _, light in self._lights[count:]:
            light.release()
        self._lights = self._lights[:count]

    def _take_volumes(self, scene: Scene) -> None:
        held = self._volumes.volumes if self._volumes is not None else ()
        wanted = scene.volumes[:MAX_VOLUMES]
        if len(held) == len(wanted) and all(a is b for a, b in zip(held, wanted)):
            return
        if self._volumes is not None:
            self._volumes.release()
        self._volumes = VolumeTextures(self._gl, wanted) if wanted else None

    def march(self, frame: Frame, settings: Settings, plan: Plan, environment: EnvironmentLight | None,
              frame_uniforms: dict[str, object], size: tuple[int, int], still: bool) -> dict[str, object]:
        """March the rays of one frame, one for a square of pixels of a picture of `size`; as many and with as many
        steps as a picture that is kept has, if it is `still`. Returns the uniforms of surfaces. Leaves a framebuffer of
        its own in use."""
        rays, steps = settings.media_rays_and_steps(self._context.is_software, still)
        side = _PIXELS[rays]
        columns = -(-size[0] // side), -(-size[1] // side)
        if self._slices is None or self._slices.size != columns:
            if self._slices is not None:
                self._slices.release()
            self._slices = MediaSlices(self._context, columns)
        light = self._lights[0][1]
        light.texture.use(UNIT_MEDIA_LIGHT)
        if light.depths is not None:
            light.depths.use(UNIT_VOLUME_DEPTH)
        media = self._uniforms(frame, settings)
        uniforms = frame_uniforms | media | {"u_steps": steps // SLICE_COUNT}
        if environment is not None:
            uniforms |= environment.scattered_sky(plan, *(travelled(medium(settings), settings)
                                                          for medium in (fog_medium, volume_medium)))
        starts, counts = _parts(frame, settings)
        self._slices.march(self._programs, plan.media.march, frame, _ends(starts, counts), uniforms)
        self._slices.texture.use(UNIT_MEDIA)
        return media | {
            "u_media": UNIT_MEDIA,
            "u_media_starts": tuple(starts),
            "u_media_counts": tuple(counts),
            "u_media_axis": (*frame.camera.forward, float(frame.camera.height is not None)),
            "u_media_pixel": (1 / frame.size[0], 1 / frame.size[1]),
        }

    def draw_sky(self, depth: Depth, uniforms: dict[str, object], half_target: bool) -> None:
        """Draw the media where no surface stands and no background is drawn, into the framebuffer in use."""
        program = self._programs.get("display/fullscreen.vert", "raster/media_sky.frag",
                                     {"HALF_TARGET": int(half_target)})
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        self._gl.enable_only(moderngl.DEPTH_TEST)
        with depth.behind_surfaces():
            fullscreen(self._gl, program).render(vertices=3)

    def _uniforms(self, frame: Frame, settings: Settings) -> dict[str, object]:
        """Of shaders/raster/lit_media.glsl, in_scattered.glsl and volumes.glsl."""
        values: dict[str, object] = {"u_media_light": UNIT_MEDIA_LIGHT, "u_volume_depth": UNIT_VOLUME_DEPTH}
        grids = _grids(frame, settings)
        for name, grid in zip(("u_fog_grid", "u_volume_grid"), grids, strict=True):
            if grid is not None:
                values[name] = grid.uniform
        values["u_scene_grid"] = _scene_grid(frame, VACUUM).uniform
        fog = fog_of(frame.scene, settings)
        if fog is not None:
            values |= {
                "u_fog_ball": (*frame.position(fog.center), fog.radius / frame.unit),
                "u_fog_extinction": min(travelled(fog.medium, settings).sigma_t[0] * frame.unit, 1e18),
                **_scattering("fog", fog.medium, settings),
            }
            if math.isfinite(fog.scale_height):
                base = (fog.base - frame.camera.eye[1]) / frame.unit
                values["u_fog_height"] = (base, min(frame.unit / fog.scale_height, 1e12))
        if self._volumes is not None and grids[1] is not None:
            medium = volume_medium(settings)
            # A volume that only shines is given an extinction that cannot be seen.
            densest = max(volume.maximum for volume in self._volumes.volumes)
            least = 1e-4 / (2 * max(densest, 1e-30)) if any(medium.emission) else 0.0
            extinction = min(max(travelled(medium, settings).sigma_t[0] * frame.unit, least), 1e18)
            emission = np.clip(np.array(medium.emission) * frame.unit / max(extinction, 1e-30), 0, 1e30)
            values |= self._volumes.uniforms(frame) | {
                "u_volume_extinction": extinction,
                "u_volume_near": _NEAR * grids[1].length / DEPTH_SIDE,
                "u_volume_cell": grids[1].length / SIDE * (settings.media_scattering == "multiple"),
                **_scattering("volume", medium, settings),
                "u_volume_emission": tuple(emission.tolist()),
            }
        return values

    def release(self) -> None:
        self._drop_lights(0)
        for thing in (self._slices, self._volumes):
            if thing is not None:
                thing.release()


def _scattering(name: str, medium: Medium, settings: Settings) -> dict[str, object]:
    """How it scatters, for each unit of the optical depth that light is taken to meet. What comes from lights is
    scattered for the first time by the whole phase function (Nakajima & Tanaka 1988)."""
    there = travelled(medium, settings)
    share = medium.sigma_t[0] / there.sigma_t[0] if there.sigma_t[0] > 0 else 1.0
    return {f"u_{name}_scattering": (*there.albedo, mean_cosine(there)),
            f"u_{name}_of_lights": (*(share * albedo for albedo in medium.albedo), medium.phase)}


def _grids(frame: Frame, settings: Settings) -> tuple[Grid | None, Grid | None]:
    """The cubes about fog and volumes in eye-relative space."""
    scene, fog, volumes = frame.scene, fog_of(frame.scene, settings), None
    around_fog = None
    if fog is not None:
        radius = fog.radius / frame.unit
        around_fog = Grid(_corner(frame.position(fog.center), radius), 2 * radius, travelled(fog.medium, settings))
    if scene.volumes:
        low, high = scene.volume_corners.min(axis=0), scene.volume_corners.max(axis=0)
        half = float((high - low).max()) / frame.unit * (0.5 + _GRID_MARGIN)
        medium = travelled(volume_medium(settings), settings)
        volumes = Grid(_corner(frame.position((low + high) / 2), half), 2 * half, medium)
    return around_fog, volumes


def _scene_grid(frame: Frame, medium: Medium) -> Grid:
    """The cube about the scene's ball."""
    return Grid(_corner(frame.position(frame.scene.center), 1.0), 2.0, medium)


def _corner(center: np.ndarray, half: float) -> tuple[float, float, float]:
    x, y, z = (center - half).tolist()
    return x, y, z


def _parts(frame: Frame, settings: Settings) -> tuple[list[float], list[int]]:
    """Where the parts of a ray start, with the end of the last, in eye-relative units, and how many slices each has.

    In a fog they are before the scene, in it, where shadows and volumes are, and behind it; else all slices are about
    the volumes."""
    scene, is_foggy = frame.scene, settings.fog > 0
    corners = scene.volume_corners
    bounds = scene.bounds if is_foggy else np.stack([corners.min(axis=0), corners.max(axis=0)])
    center = frame.position(bounds.mean(axis=0))
    radius = 1.0 if is_foggy else float(np.linalg.norm(bounds[1] - bounds[0])) / 2 / frame.unit
    if frame.camera.height is not None:
        middle, first = float(center @ frame.camera.forward), -math.inf
    else:
        middle, first = float(np.linalg.norm(center)), 0.0
    outer = REACH if is_foggy else radius
    starts = [max(middle + part, first) for part in (-outer, -radius, radius, outer)]
    lengths = np.diff(starts)
    weights = lengths * (1, 4, 1)
    counts = np.maximum(np.round(SLICE_COUNT * weights / max(weights.sum(), 1e-30)), lengths > 0).astype(int)
    counts[counts.argmax()] += SLICE_COUNT - counts.sum()
    for k in range(3):  # a part may have no length
        starts[k + 1] = max(starts[k + 1], starts[k] + 1e-6 * max(abs(starts[k]), 1.0))
    return starts, counts.tolist()


def _ends(starts: list[float], counts: list[int]) -> list[float]:
    """Where each slice starts, and where the last one ends."""
    ends = [starts[0]]
    for k, count in enumerate(counts):
        ends += [starts[k] + (starts[k + 1] - starts[k]) * (j + 1) / count for j in range(count)]
    return ends
