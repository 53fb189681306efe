"""The points of curves on the GPU, and which of their segments strips do not show well."""

from __future__ import annotations

import math

import moderngl
import numpy as np

from ..gpu.programs import matrix_uniform, set_uniform
from ..scene.curve_segments import Segments, segments
from ..scene.curves import Curves
from ..scene.fibre import sigma_a_of_color
from ..scene.frame import Frame
from .curve_texture import curve_texture

UNIT_POINTS, UNIT_COLORS, UNIT_TABLE, UNIT_NEXT = range(4)
"""Texture units. UNIT_TABLE is that of the lobes of a fibre (curves.py)."""


class CurveBuffers:
    """The points of one set of curves on the GPU: 16 bytes a point, and 16 more where colours count.

    They are stored in `space_of` the curves.
    """

    def __init__(self, gl: moderngl.Context, curves: Curves, beta_n: float | None) -> None:
        """`beta_n` is the azimuthal roughness, on which the absorption depends that colours mean; None: they do not
        count."""
        pieces = segments(curves)
        self.center, self.unit = space_of(curves)
        self.radius = curves.widest
        self.blunt_radius = blunt_radius(pieces)
        last = np.append(pieces.strand[1:] != pieces.strand[:-1], True) if len(pieces) else np.zeros(0, bool)
        self.count = len(pieces) + int(last.sum())
        rows = np.zeros((self.count, 4), np.float32)
        is_last = np.zeros(self.count, bool)
        is_last[np.flatnonzero(last) + np.arange(1, last.sum() + 1)] = True
        rows[~is_last], rows[is_last] = pieces.ends[:, 0], pieces.ends[last, 1]
        rows[:, :3] -= self.center
        rows /= np.float32(self.unit)
        rows[is_last, 3] = np.copysign(rows[is_last, 3], -1.0)
        self._vertex_arrays: dict[int, moderngl.VertexArray] = {}
        self._gl, self._points = gl, curve_texture(gl, rows)
        self._colors = None
        if beta_n is not None and pieces.colors is not None:
            absorbed = np.zeros((self.count, 4), np.float32)
            absorbed[~is_last, :3] = sigma_a_of_color(pieces.colors[:, 0], beta_n)
            absorbed[is_last, :3] = sigma_a_of_color(pieces.colors[last, 1], beta_n)
            self._colors = curve_texture(gl, absorbed)

    def bind_next(self, frame: Frame) -> dict[str, object]:
        """The uniforms of the points at the next time, which `frame` shows; binds them."""
        self._points.use(UNIT_NEXT)
        return {"u_next_points": UNIT_NEXT,
                "u_next_to_eye": matrix_uniform(frame.model(np.eye(4)) @ self.to_world)}

    @property
    def to_world(self) -> np.ndarray:
        """From the space of the points, (4, 4)."""
        return placed(self.unit, self.center)

    def draw(self, program: moderngl.Program, columns: int) -> None:
        self._points.use(UNIT_POINTS)
        set_uniform(program, "u_points", UNIT_POINTS)
        if self._colors is not None:
            self._colors.use(UNIT_COLORS)
            set_uniform(program, "u_colors", UNIT_COLORS)
        set_uniform(program, "u_columns", columns)
        if program.glo not in self._vertex_arrays:
            self._vertex_arrays[program.glo] = self._gl.vertex_array(program, [])
        array = self._vertex_arrays[program.glo]
        array.render(moderngl.TRIANGLE_STRIP, vertices=2 * columns, instances=max(self.count - 1, 0))

    def release(self) -> None:
        for thing in (*self._vertex_arrays.values(), self._points, self._colors):
            if thing is not None:
                thing.release()


def blunt_radius(pieces: Segments) -> float:
    """The largest radius of the segments that strips do not show well, 0 if there are none: those that are thick beside
    their length, turn sharply or taper quickly (shaders/raster/curve_blunt.glsl)."""
    if not len(pieces):
        return 0.0
    way = pieces.ends[:, 1, :3].astype(np.float64) - pieces.ends[:, 0, :3]
    size = np.linalg.norm(way, axis=1)
    axis = way / np.maximum(size, 1e-300)[:, None]
    sines = np.zeros((len(pieces) + 1, 1))  # at the joint before each segment
    joined = (pieces.strand[1:] == pieces.strand[:-1]) & (size[1:] > 0) & (size[:-1] > 0)
    mean = axis[1:] + axis[:-1]
    length = np.linalg.norm(mean, axis=1)
    sine = np.linalg.norm(np.cross(axis[1:], mean / np.maximum(length, 1e-300)[:, None]), axis=1)
    sines[1:-1, 0] = np.where(joined, np.where(length**2 > 0.5, sine, 1.0), 0.0)
    both, radii = np.concatenate([sines[:-1], sines[1:]], axis=1), pieces.ends[:, :, 3].astype(np.float64)
    is_blunt = ((radii * both).sum(axis=1) >= 0.79 * size) | (both.max(axis=1) > 0.39) | (
        np.abs(radii[:, 0] - radii[:, 1]) > 0.149 * size)  # a little more than the shader finds
    return float(radii[is_blunt].max(initial=0.0))


def space_of(curves: Curves) -> tuple[np.ndarray, float]:
    """Where points are stored: about the middle of their box, so that curves far from the origin keep their digits in
    float32, and in a unit of about their size, so that squares of lengths do not leave float32's range."""
    if not len(curves.points):
        return np.zeros(3), 1.0
    size = float(np.ptp(curves.corners, axis=0).max())
    unit = 2.0 ** round(math.log2(size)) if size > 0 else 1.0  # a power of two keeps all digits
    return curves.corners.mean(axis=0), unit


def placed(unit: float, center: np.ndarray) -> np.ndarray:
    """The matrix, (4, 4), to the world from a space of this unit about `center`."""
    matrix = np.diag([unit, unit, unit, 1.0])
    matrix[:3, 3] = center
    return matrix
