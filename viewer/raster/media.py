"""Fog between the eye and what is seen: rays are marched once a frame, and surfaces look up what lies before them.

shaders/raster/media_march.frag stores, for each of a grid of rays and at the ends of SLICE_COUNT slices along them, the
light that has come together and what of the light behind has been lost: the froxels of Wronski 2014 and Hillaire 2015.
As the textures depend on no surface, opaque, transmissive and blended surfaces and each sample of a pixel find their
own share by their distance.
"""

from __future__ import annotations

import math

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..plan.media import SLICE_COUNT
from ..plan.model import Plan
from ..scene.camera import Camera
from ..scene.fog import REACH, Fog, fog_of
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..settings import Settings
from .depth import Depth
from .environment import EnvironmentLight
from .lights import pack_lights
from .media_light import MediaLight
from .media_slices import MediaSlices
from .shadows import ShadowMaps
from .surfaces import UNIT_MEDIA, UNIT_MEDIA_LIGHT, UNIT_SHADOW


class MediaPass:
    """The passes of the media of a scene, and what they keep from frame to frame."""

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context, self._gl, self._programs = context, context.gl, programs
        self._slices: MediaSlices | None = None
        self._light: MediaLight | None = None
        self._lit: tuple[object, ...] = ()
        self._scene: Scene | None = None

    def prepare(self, scene: Scene, settings: Settings, plan: Plan, environment: EnvironmentLight | None,
                shadows: ShadowMaps | None) -> None:
        """Bake the light in the media, unless an earlier frame has left it. Binds uniform blocks of its own."""
        fog = _fog(scene, settings)
        sky = environment.environment if environment is not None else None
        lit = (fog, plan.media, plan.lights, sky and (id(sky.source), sky.rotation, sky.intensity), plan.ambient)
        if self._scene is not None and scene.has_surfaces_of(self._scene) and lit == self._lit:
            return
        if self._light is None:
            self._light = MediaLight(self._gl)
        middle = np.eye(4)
        middle[:3, 3] = scene.center
        frame = Frame(scene, Camera(middle), (1, 1))
        uniforms = self._uniforms(frame, fog)
        blocks = [pack_lights(plan, frame)] if plan.lights else []
        if shadows is not None:
            blocks.append(shadows.pack(frame))
            shadows.texture.use(UNIT_SHADOW)
            uniforms |= {"u_shadow_map": UNIT_SHADOW, "u_shadow_tile_size": float(shadows.tile_size)}
        buffers = [self._gl.buffer(np.ascontiguousarray(block)) for block in blocks]
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_uniform_block(binding)
        lights = environment.sky_lights(plan) if environment is not None else None
        self._light.bake(self._programs, plan.media, fog.medium, 2 * REACH, lights, uniforms)
        for buffer in buffers:
            buffer.release()
        self._scene, self._lit = scene, lit

    def march(self, frame: Frame, settings: Settings, plan: Plan, environment: EnvironmentLight | None,
              frame_uniforms: dict[str, object], size: tuple[int, int]) -> dict[str, object]:
        """March the rays of one frame, one for a square of pixels of a picture of `size`. Returns the uniforms of
        surfaces. Leaves a framebuffer of its own in use."""
        side = math.isqrt(int(settings.media_rays))
        columns = -(-size[0] // side), -(-size[1] // side)
        if self._slices is None or self._slices.size != columns:
            if self._slices is not None:
                self._slices.release()
            self._slices = MediaSlices(self._context, columns)
        fog = _fog(frame.scene, settings)
        self._light.texture.use(UNIT_MEDIA_LIGHT)
        uniforms = frame_uniforms | self._uniforms(frame, fog)
        if environment is not None:
            uniforms |= environment.scattered_sky(plan, fog.medium.g)
        starts, counts = _parts(frame)
        self._slices.march(self._programs, plan.media.march, frame, _ends(starts, counts), uniforms)
        self._slices.texture.use(UNIT_MEDIA)
        is_orthographic = frame.camera.height is not None
        return self._uniforms(frame, fog) | {
            "u_media": UNIT_MEDIA,
            "u_media_starts": tuple(starts),
            "u_media_counts": tuple(counts),
            "u_media_axis": (*frame.camera.forward, float(is_orthographic)),
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

    def _uniforms(self, frame: Frame, fog: Fog) -> dict[str, object]:
        """Of shaders/raster/lit_media.glsl."""
        center, radius = frame.position(fog.center), fog.radius / frame.unit
        values: dict[str, object] = {
            "u_media_light": UNIT_MEDIA_LIGHT,
            "u_media_grid": (*(center - radius), 1 / (2 * radius)),
            "u_fog_ball": (*center, radius),
            "u_fog_extinction": min(fog.medium.sigma_t[0] * frame.unit, 1e18),
            "u_fog_scattering": (*fog.medium.albedo, fog.medium.g),
        }
        if math.isfinite(fog.scale_height):
            base = (fog.base - frame.camera.eye[1]) / frame.unit
            values["u_fog_height"] = (base, min(frame.unit / fog.scale_height, 1e12))
        return values

    def release(self) -> None:
        for thing in (self._slices, self._light):
            if thing is not None:
                thing.release()


def _fog(scene: Scene, settings: Settings) -> Fog:
    fog = fog_of(scene, settings)
    assert fog is not None, "a plan with media has fog"
    return fog


def _parts(frame: Frame) -> tuple[list[float], list[int]]:
    """Where the parts of a ray start, with the end of the last, in eye-relative units, and how many slices each has:
    before the scene, in it, where shadows are, and behind it."""
    center = frame.position(frame.scene.center)
    if frame.camera.height is not None:
        middle, first = float(center @ frame.camera.forward), -math.inf
    else:
        middle, first = float(np.linalg.norm(center)), 0.0
    reach = (-REACH, -1.0, 1.0, REACH)
    starts = [max(middle + part, first) for part in reach]
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
