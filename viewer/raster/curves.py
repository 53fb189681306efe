"""Curves: strips that face the viewer, expanded in the vertex shader from a texture of points."""

from __future__ import annotations

import math
from contextlib import nullcontext

import moderngl
import numpy as np

from ..bake.fibre import fibre_table
from ..bake.hair_light import HairMedium
from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.curves import POINTS_WIDTH, VERTEX, CurvePlan, has_colors
from ..plan.model import Plan, Program
from ..scene.curves import Curves
from ..scene.fibre import Fibre, color_fit, hair_fibre, longitudinal_variance
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..scene.yarn.kind import YarnKind
from ..scene.yarn.spun import yarn_kind
from ..settings import Settings
from .curve_buffers import UNIT_TABLE, CurveBuffers, placed
from .depth import Depth
from .environment import EnvironmentLight
from .hair_light import HairLight, hair_medium, light_key, medium_key
from .surfaces import bind_blocks
from .units import UNIT_DFG
from .yarns import TUBES, YarnBuffers

THIN, THICK = 3, 7
"""Pairs of vertices across a strip. The tube about a curve of up to THIN_PIXELS needs no more than its middle."""
THIN_PIXELS = 4.0
NEAR_PIXELS = 1.5
"""As in shaders/raster/curve_light.glsl: where no curve is wider, none shows what is across it."""
ROUND = 2
ALL, BESIDE = (0,), (1, ROUND)
"""Values of the switch ROUND (shaders/raster/curve_blunt.glsl): strips alone; strips, and the blunt segments beside
them."""
ROUND_PIXELS = 3.0
"""As LEAST_ROUND in shaders/raster/curve_blunt.glsl."""
NUDGE = 1e-5
"""Share by which shaded fragments that write their depth are nearer than those drawn before."""
SHADOW_WIDTH = 1.0
"""The least width of a strip in shadow maps, in texels."""


class CurvePass:
    """Draws the curves of a scene. It keeps the buffers of those that the next scene shares."""

    def __init__(self, context: Context, programs: Programs, depth: Depth) -> None:
        self._gl, self._programs, self._depth = context.gl, programs, depth
        self._buffers: dict[tuple[Curves, float | None, YarnKind | None], CurveBuffers | YarnBuffers] = {}
        self._drawn: list[CurveBuffers | YarnBuffers] = []
        self._tables: dict[tuple[float, float], moderngl.Texture] = {}
        self._medium: tuple[tuple[object, ...], HairMedium] | None = None
        self._light: Reusable[HairLight] = Reusable()
        self._generation = programs.generation

    def take(self, scene: Scene, settings: Settings, plan: Plan) -> None:
        """Upload what `plan` draws, unless an earlier frame has left it."""
        if self._generation != self._programs.generation:  # vertex arrays belong to programs
            self.release()
            self._generation = self._programs.generation
        keys: list[tuple[Curves, float | None, YarnKind | None]] = []
        kind = yarn_kind(settings) if settings.yarn != "off" else None
        for curves in scene.curves if plan.curves is not None else ():
            beta_n = (curves.fibre or hair_fibre(settings)).beta_n
            keys.append((curves, beta_n if has_colors(curves, settings) else None, kind))
        for key in self._buffers.keys() - set(keys):
            self._buffers.pop(key).release()
        for key in keys:
            if key not in self._buffers:
                curves, colored, _ = key
                self._buffers[key] = CurveBuffers(self._gl, curves, colored) if kind is None else YarnBuffers(
                    self._gl, curves, colored, kind)
        self._drawn = [self._buffers[key] for key in keys]

    def prepare(self, scene: Scene, settings: Settings, plan: Plan, environment: EnvironmentLight | None) -> None:
        """As `take`; and bake the light that fibres scatter to each other, unless an earlier frame has left it."""
        self.take(scene, settings, plan)
        if plan.curves is None or not plan.curves.scatters_again:
            self._light.release()
            self._medium = None
            return
        key = medium_key(scene, settings)
        if self._medium is None or self._medium[0] != key:
            self._medium = key, hair_medium(scene, settings)
        medium, sky = self._medium[1], environment if plan.environment else None
        lit = light_key(plan, sky)
        self._light.get(lambda held: held.medium is medium and held.key == lit,
                        lambda: HairLight(self._gl, medium, plan, sky))

    def draw(self, frame: Frame, settings: Settings, plan: Plan, samples: int, uniforms: dict[str, object],
             also: int = moderngl.NOTHING) -> None:
        """Draw all curves into the framebuffer in use, within `Depth.test()`: first their depth, then their light.

        `also` are flags of the context that are on for their light."""
        if plan.curves is None:
            return
        gl, target = self._gl, self._gl.fbo
        self._clear_samplers()
        gl.enable_only(moderngl.DEPTH_TEST)
        target.color_mask = False, False, False, False
        target.use()
        for buffers in self._drawn:
            for part in self._parts(buffers, frame):
                self._draw_one(buffers, plan.curves.depth, part, frame, samples, {})
        target.color_mask = True, True, True, True
        target.use()
        gl.enable_only(moderngl.DEPTH_TEST | also)
        for curves, buffers, program in zip(frame.scene.curves, self._drawn, plan.curves.shade, strict=True):
            if self._light.held is not None:
                uniforms = uniforms | self._light.held.bind(frame)
            values = uniforms | self._of_fibre(curves.fibre or hair_fibre(settings), settings.mode)
            if plan.curves.are_yarns and self._medium is not None:
                mean = self._medium[1].fibre
                values["u_mean_fibre"] = (*mean.sigma_a, color_fit(mean.beta_n))
            for part in self._parts(buffers, frame):
                # What fragments write as their depth need not be the same to the last bit in two programs.
                with nullcontext() if part == ROUND else self._depth.equal():
                    self._draw_one(buffers, program, part, frame, samples, values | {"u_nudge": NUDGE})

    def draw_layers(self, frame: Frame, plan: CurvePlan, settings: Settings, uniforms: dict[str, object],
                    following: Frame) -> None:
        """Draw what curves are, as numbers: shaders/raster/curve_layers.frag. `following` shows them at the next time.
        Within `Depth.test()`."""
        self._clear_samplers()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        scene = frame.scene
        still = following.shows_as(frame)
        for k, (curves, buffers, program) in enumerate(zip(scene.curves, self._drawn, plan.shade, strict=True)):
            fibre = curves.fibre or hair_fibre(settings)
            ids = len(scene.instances) + k + 1, len(scene.materials) + k + 1
            values = uniforms | {"u_ids": halves(*ids), "u_sigma_a": fibre.sigma_a,
                                 "u_fibre": (fibre.beta_m, fibre.beta_n, fibre.tilt, fibre.ior)}
            moved = None
            if program["HAS_MOTION"] and isinstance(buffers, CurveBuffers):
                others = following.scene.curves[k]
                moved = CurveBuffers(self._gl, others, None) if others is not curves else None
                values |= (moved or buffers).bind_next(following)
            values["u_moves"] = 0.0 if still and moved is None else 1.0
            for part in self._parts(buffers, frame):
                self._draw_one(buffers, program, part, frame, 1, values | {"u_nudge": 0.0})
            if moved is not None:
                moved.release()

    def draw_depth(self, world_to_clip: np.ndarray, size: int) -> None:
        """Draw all curves into a tile of `size` texels of a shadow map."""
        self._clear_samplers()
        for buffers in self._drawn:
            is_blunt = 2 * buffers.blunt_radius * _texels_per_unit(world_to_clip, size) >= ROUND_PIXELS
            for part in BESIDE if is_blunt else ALL:
                program = self._programs.get(VERTEX, "raster/curve_depth.frag", {
                    "HAS_COLORS": 0, "POINTS_WIDTH": POINTS_WIDTH, "ROUND": part,
                    "YARN": int(isinstance(buffers, YarnBuffers))})
                _set_view(program, buffers, world_to_clip, np.eye(4), (size, size), is_reversed=False,
                          least=SHADOW_WIDTH)
                if isinstance(buffers, YarnBuffers):  # what a yarn's own fibres hide follows from their depth in it
                    buffers.draw(program, np.minimum(buffers.levels(world_to_clip, (size, size)), TUBES))
                else:
                    buffers.draw(program, THIN)

    def _clear_samplers(self) -> None:
        """Those of surfaces' maps read mip levels, which the textures of curves have none of: all of it would be 0."""
        self._gl.clear_samplers(0, UNIT_DFG)

    def _draw_one(self, buffers: CurveBuffers | YarnBuffers, wanted: Program, part: int, frame: Frame, samples: int,
                  uniforms: dict[str, object]) -> None:
        switches, widest = dict(wanted.switches) | {"ROUND": part}, 2 * buffers.radius * _pixels_per_unit(frame)
        if widest >= NEAR_PIXELS and "NEAR" in switches:
            switches["NEAR"] = 1
        program = self._programs.get(VERTEX, wanted.fragment, switches)
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        bind_blocks(program)
        to_eye = frame.model(np.eye(4))
        _set_view(program, buffers, frame.view_projection @ to_eye, to_eye, frame.size,
                  self._depth.is_reversed, 1.0 / samples)
        if isinstance(buffers, YarnBuffers):
            buffers.draw(program, buffers.levels(frame.view_projection @ to_eye, frame.size))
            return
        buffers.draw(program, THIN if widest < THIN_PIXELS else THICK)

    def _parts(self, buffers: CurveBuffers | YarnBuffers, frame: Frame) -> tuple[int, ...]:
        """The values of ROUND that are drawn: two where segments may be wide, and blunt or near."""
        is_near = frame.camera.height is None and (
            buffers.radius > 0.15 * max(frame.depth_range[0], 1e-6) * frame.unit)
        is_blunt = 2 * buffers.blunt_radius * _pixels_per_unit(frame) >= ROUND_PIXELS
        return BESIDE if is_near or is_blunt else ALL

    def _of_fibre(self, fibre: Fibre, mode: str) -> dict[str, object]:
        """The uniforms of shaders/raster/curve.frag or curve_phong.frag; binds the table."""
        if mode == "phong":
            return {"u_sigma_a": fibre.sigma_a,
                    "u_fibre": (color_fit(fibre.beta_n), 1 / longitudinal_variance(fibre.beta_m), fibre.ior)}
        self._table(fibre.beta_n, fibre.ior).use(UNIT_TABLE)
        return {"u_fibre_table": UNIT_TABLE, "u_sigma_a": fibre.sigma_a,
                "u_fibre": (fibre.beta_m, fibre.beta_n, fibre.tilt, fibre.ior)}

    def _table(self, beta_n: float, ior: float) -> moderngl.Texture:
        key = beta_n, ior
        if key not in self._tables:
            table = fibre_table(beta_n, ior).astype(np.float16)
            texture = self._gl.texture3d(table.shape[2::-1], 4, np.ascontiguousarray(table), dtype="f2")
            texture.filter = moderngl.LINEAR, moderngl.LINEAR
            texture.repeat_x = texture.repeat_y = texture.repeat_z = False
            self._tables = {key: texture} if len(self._tables) > 8 else self._tables | {key: texture}
        return self._tables[key]

    def release(self) -> None:
        self._light.release()
        for thing in (*self._buffers.values(), *self._tables.values()):
            thing.release()
        self._buffers, self._drawn, self._tables = {}, [], {}


def _pixels_per_unit(frame: Frame) -> float:
    """How many pixels a unit of length takes where the scene is nearest to the camera."""
    if frame.camera.height is not None:
        return frame.size[1] / frame.camera.height
    return 1.0 / (frame.pixel_angle * max(frame.depth_range[0], 1e-6) * frame.unit)


def _texels_per_unit(world_to_clip: np.ndarray, size: int) -> float:
    """How many texels of a shadow map a unit of length takes at most; any number where it is seen in perspective."""
    if world_to_clip[3, :3].any():
        return math.inf
    return float(np.linalg.norm(world_to_clip[:2, :3], axis=1).max()) * size / 2 / float(world_to_clip[3, 3])


def _set_view(program: moderngl.Program, buffers: CurveBuffers | YarnBuffers, to_clip: np.ndarray,
              to_eye: np.ndarray, size: tuple[int, int], is_reversed: bool, least: float) -> None:
    """`to_clip` and `to_eye` take world space to clip space and to eye-relative space."""
    from_points = placed(buffers.unit, buffers.center)
    set_uniform(program, "u_to_clip", matrix_uniform(to_clip @ from_points))
    if "u_from_clip" in program:
        set_uniform(program, "u_from_clip", matrix_uniform(np.linalg.inv(to_clip @ from_points)))
    set_uniform(program, "u_to_eye", matrix_uniform(to_eye @ from_points))
    set_uniform(program, "u_half_size", (size[0] / 2, size[1] / 2))
    set_uniform(program, "u_least_width", least)
    set_uniform(program, "u_nearer", 1.0 if is_reversed else -1.0)


def halves(*numbers: int) -> tuple[float, ...]:
    """The lower 16 bits of each number, and the rest: both are whole in a float32, however large the number is."""
    return tuple(float(half) for number in numbers for half in (number & 0xFFFF, number >> 16))
