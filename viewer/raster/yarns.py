"""Yarns: tubes, plies or fibres by their width on the screen, made in the vertex shader of points along their axes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby, pairwise

import moderngl
import numpy as np

from ..gpu.programs import set_uniform
from ..plan.curves import FIBRE_PIXELS, PLY_PIXELS
from ..scene.curves import Curves
from ..scene.fibre import sigma_a_of_color
from ..scene.yarn.fibres import axis_of, fibre_angles, fibre_numbers, ply_angle
from ..scene.yarn.frames import Axis
from ..scene.yarn.kind import YarnKind
from .curve_buffers import space_of
from .curve_texture import curve_texture

TUBES, PLIES, FIBRES = range(3)
_CHUNK = 48
"""Points of a yarn that are shown or left out together, at one level."""
_COLUMNS = 3
"""Pairs of vertices across a strip. All strips are narrow."""
UNIT_AXIS, UNIT_COLORS, UNIT_FIBRES = 0, 1, 8


@dataclass(frozen=True)
class Run:
    """Points of the axis, from `first` to before `end`, that are drawn at one level."""

    first: int
    end: int
    level: int


class YarnBuffers:
    """The axes of one set of yarns on the GPU: 64 bytes a point, and 16 more where colours count.

    They are stored in `space_of` the curves, as `CurveBuffers` are.
    """

    radius = blunt_radius = 0.0
    """As those of `CurveBuffers`: tubes and plies are drawn where they are narrow, and fibres are thin."""

    def __init__(self, gl: moderngl.Context, curves: Curves, beta_n: float | None, kind: YarnKind) -> None:
        """`beta_n` is the azimuthal roughness, on which the absorption depends that colours mean; None: they do not
        count."""
        self.kind, self._depths = kind, optical_depths(kind)
        axis = axis_of(curves, kind, kind.plies * kind.fibres)  # refused where mode path refuses it
        self.center, self.unit = space_of(curves)
        order, is_last = _rows(axis)
        self.count = len(order)
        rows = np.zeros((self.count, 4, 4), np.float32)
        rows[:, 0, :3] = (axis.points[order] - self.center) / self.unit
        rows[:, 0, 3] = axis.radii[order] / self.unit
        rows[is_last, 0, 3] = np.copysign(rows[is_last, 0, 3], -1.0)
        about_ply, migrated = fibre_angles(axis, kind)
        for k, (vectors, angles) in enumerate(((axis.normals, ply_angle(axis, kind)), (axis.binormals, about_ply)), 1):
            rows[:, k, :3], rows[:, k, 3] = vectors[order], angles[order] % (2 * np.pi)
        rows[:, 3, 0], rows[:, 3, 1] = migrated[order] % (2 * np.pi), axis.yarn[order]
        numbers = fibre_numbers(axis, kind, np.random.default_rng(1)).swapaxes(0, 1)
        self._gl = gl
        self._axis = curve_texture(gl, rows.reshape(-1, 4))
        self._fibres = curve_texture(gl, numbers.reshape(-1, 4).astype(np.float32))
        self._colors = None
        if beta_n is not None and axis.colors is not None:
            absorbed = np.zeros((self.count, 4), np.float32)
            absorbed[:, :3] = sigma_a_of_color(axis.colors[order], beta_n)
            self._colors = curve_texture(gl, absorbed)
        self._vertex_arrays: dict[int, moderngl.VertexArray] = {}
        self._chunks = np.append(np.arange(0, max(self.count - 1, 1), _CHUNK), max(self.count - 1, 1))
        self._spheres = _spheres(axis.points[order], axis.radii[order], self._chunks)

    def levels(self, world_to_clip: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        """The level of each chunk, -1 of those out of sight. (chunks,)"""
        centers, radii, thickness = self._spheres
        clip = centers @ world_to_clip[:3, :3].T + world_to_clip[:3, 3]
        w = centers @ world_to_clip[3, :3] + world_to_clip[3, 3]
        lengths = np.linalg.norm(world_to_clip[:, :3], axis=1)
        nearest = np.maximum(w - radii * lengths[3], 1e-9 * np.abs(w).max())
        pixels = thickness * lengths[1] * size[1] / nearest  # the diameter: half the height is a unit of clip space
        level = np.where(pixels < PLY_PIXELS, TUBES, np.where(pixels < FIBRE_PIXELS, PLIES, FIBRES))
        if self.kind.plies == 1:
            level[level == PLIES] = TUBES
        reach = radii[:, None] * (lengths[:2] + lengths[3])
        seen = (np.abs(clip[:, :2]) <= np.maximum(w, 0)[:, None] + reach).all(axis=1) & (w > -radii * lengths[3])
        return np.where(seen, level, -1)

    def counts(self, world_to_clip: np.ndarray, size: tuple[int, int]) -> dict[str, int]:
        """The segments that are drawn of each level."""
        runs = list(self._runs(self.levels(world_to_clip, size)))
        return {name: sum(self._strands[level] * (run.end - run.first) for run in runs if run.level == level)
                for name, level in (("tubes", TUBES), ("plies", PLIES), ("fibres", FIBRES))}

    @property
    def _strands(self) -> tuple[int, int, int]:
        """Of each yarn at each level."""
        return 1, self.kind.plies, self.kind.plies * self.kind.fibres

    def draw(self, program: moderngl.Program, levels: np.ndarray) -> None:
        """Draw each chunk at its level."""
        kind = self.kind
        self._axis.use(UNIT_AXIS)
        self._fibres.use(UNIT_FIBRES)
        set_uniform(program, "u_axis", UNIT_AXIS)
        set_uniform(program, "u_fibres", UNIT_FIBRES)
        if self._colors is not None:
            self._colors.use(UNIT_COLORS)
            set_uniform(program, "u_colors", UNIT_COLORS)
        set_uniform(program, "u_plies", (float(kind.plies), kind.ply_offset, kind.ply_radius, kind.ply_width))
        set_uniform(program, "u_spun", (kind.radius, kind.lowest))
        set_uniform(program, "u_turns", tuple(2 * math.pi * turns for turns in kind.turns))
        if program.glo not in self._vertex_arrays:
            self._vertex_arrays[program.glo] = self._gl.vertex_array(program, [])
        for run in self._runs(levels):
            strands = self._strands[run.level]
            tube = (1.0, kind.ply_radius, 0.0)[run.level]
            set_uniform(program, "u_columns", _COLUMNS)
            set_uniform(program, "u_shown", (run.first, strands, run.level, kind.fibres))
            set_uniform(program, "u_tube", tube)
            set_uniform(program, "u_yarn_depths", (self._depths[0], self._depths[1 if run.level == TUBES else 2]))
            self._vertex_arrays[program.glo].render(moderngl.TRIANGLE_STRIP, vertices=2 * _COLUMNS,
                                                    instances=strands * (run.end - run.first))

    def _runs(self, levels: np.ndarray) -> Iterator[Run]:
        for level, group in groupby(range(len(levels)), lambda chunk: int(levels[chunk])):
            if level >= 0:
                chunks = list(group)
                yield Run(int(self._chunks[chunks[0]]), int(self._chunks[chunks[-1] + 1]), level)

    def release(self) -> None:
        for thing in (*self._vertex_arrays.values(), self._axis, self._fibres, self._colors):
            if thing is not None:
                thing.release()


def optical_depths(kind: YarnKind) -> tuple[float, float, float]:
    """Of a way of a yarn's radius across its fibres: in the yarn; in the tube that stands for it; in a ply.

    In the yarn and in a ply it is the widths of the fibres over the area. Between plies light gets through, so that the
    tube is so much thinner that it covers as much as plies do, in the mean over their turn about the yarn.
    """
    widths = 2 * kind.radius * kind.fibres
    in_ply, in_yarn = widths / (math.pi * kind.ply_radius**2), widths * kind.plies / math.pi
    across = np.linspace(-1, 1, 401)
    angle = np.linspace(0, 2 * np.pi / kind.plies, 32, endpoint=False)[:, None]
    chords = np.zeros((32, 401))
    for ply in range(kind.plies):
        offset = kind.ply_offset * np.cos(angle + 2 * np.pi * ply / kind.plies)
        chords += 2 * np.sqrt(np.maximum(kind.ply_radius**2 - (across - offset)**2, 0))
    covered = -np.expm1(-in_ply * chords).mean()
    chord, low, high = 2 * np.sqrt(1 - across**2), 0.0, in_yarn
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if -np.expm1(-middle * chord).mean() < covered else (low, middle)
    return in_yarn, high, in_ply


def _rows(axis: Axis) -> tuple[np.ndarray, np.ndarray]:
    """The points in the order of the texture, in which closed yarns have their first one again at their end, and which
    are the last of a yarn."""
    parts = [np.append(np.arange(first, end), first) if closed else np.arange(first, end)
             for first, end, closed in zip(axis.offsets[:-1], axis.offsets[1:], axis.closed, strict=True)]
    lengths = [len(part) for part in parts]
    is_last = np.zeros(sum(lengths), bool)
    is_last[np.cumsum(lengths) - 1] = True
    return np.concatenate(parts), is_last


def _spheres(points: np.ndarray, radii: np.ndarray, chunks: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres and radii of spheres about chunks with their fibres, and the thickest radius of the yarn in each."""
    low, high, thick = (np.stack([reduce(values[first:end + 1], axis=0) for first, end in pairwise(chunks)])
                        for reduce, values in ((np.min, points), (np.max, points), (np.max, radii)))
    return (low + high) / 2, np.linalg.norm(high - low, axis=1) / 2 + 2 * thick, thick
