"""A grid on the ground, and the axes of the world in a corner of the picture."""

from __future__ import annotations

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..scene.camera import Camera
from ..scene.frame import Frame
from ..scene.ground_grid import GroundGrid
from ..settings import Settings
from .depth import Depth
from .target import Target

GREY = (0.3, 0.3, 0.3)
RED, GREEN, BLUE = (0.80, 0.06, 0.06), (0.10, 0.55, 0.06), (0.08, 0.22, 0.90)
OPACITY = 0.55
"""Of lines that are no axes."""
BELOW = 1e-4
"""In radii: the grid lies so far below the scene's lowest point, which may be a plane."""
ARM, LETTER = 0.055, 0.012
"""Lengths of the axes in the corner and half the height of their letters, in heights of the picture."""
_LETTERS = ([[-1, -1, 1, 1], [-1, 1, 1, -1]], [[-1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 0, -1]],
            [[-1, 1, 1, 1], [1, 1, -1, -1], [-1, -1, 1, -1]])
"""The strokes of X, Y and Z: from x, y to x, y."""


class GridPass:
    def __init__(self, context: Context, programs: Programs, depth: Depth) -> None:
        self._gl, self._programs, self._depth = context.gl, programs, depth
        self._buffer: moderngl.Buffer | None = None

    def draw_ground(self, frame: Frame, target: Target, settings: Settings) -> None:
        """Draw the grid into the framebuffer in use, within `Depth.test()`. It hides nothing that is drawn later."""
        gl, grid = self._gl, GroundGrid.under(frame.scene)
        program = self._programs.get("raster/grid.vert", "raster/grid.frag", {})
        first = np.floor(grid.middle[[0, 2]] / grid.spacing)  # numbers of lines stay small far from the origin
        light = 2.0**-settings.exposure
        middle = grid.middle - (0.0, BELOW * frame.unit, 0.0)
        values = {
            "u_view_projection": matrix_uniform(frame.view_projection), "u_middle": tuple(frame.position(middle)),
            "u_half": grid.half / frame.unit, "u_spacing": grid.spacing / frame.unit,
            "u_lines": tuple(grid.middle[[0, 2]] / grid.spacing - first), "u_zero": tuple(-first),
            "u_width": float(target.supersampling), "u_opacity": OPACITY,
            **{name: tuple(light * part for part in color) for name, color in (
                ("u_color", GREY), ("u_x_color", RED), ("u_z_color", BLUE))}}
        for name, value in values.items():
            set_uniform(program, name, value)
        if program.extra is None:
            program.extra = gl.vertex_array(program, [])
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        target.framebuffer.depth_mask = False
        target.framebuffer.use()
        with self._depth.beyond_planes():
            program.extra.render(moderngl.TRIANGLE_STRIP, vertices=4)
        target.framebuffer.depth_mask = True
        target.framebuffer.use()

    def draw_axes(self, frame: Frame, target: Target, settings: Settings) -> None:
        """Draw the axes of the world over all in the framebuffer in use, at the lower left."""
        program = self._programs.get("raster/line.vert", "raster/line.frag", {})
        size, light = np.array(frame.size, float), 2.0**-settings.exposure
        to_clip = np.diag([2 / size[0], 2 / size[1], 0.0, 1.0])
        to_clip[:2, 3] = -1.0
        values = {"u_model": matrix_uniform(np.eye(4)), "u_view_projection": matrix_uniform(to_clip),
                  "u_view_direction": (0.0, 0.0, 0.0), "u_nearer": (0.0, 0.0), "u_size": tuple(size),
                  "u_width": 2.0 * target.supersampling, "u_full_length": 1.0}
        for name, value in values.items():
            set_uniform(program, name, value)
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        for axis, lines in axes_lines(frame.camera, frame.size[1]):
            color = (RED, GREEN, BLUE)[axis]
            set_uniform(program, "u_color", (*(light * part for part in color), 1.0))
            data = np.zeros((len(lines), 2, 3), np.float32)
            data[..., :2] = lines
            if self._buffer is None:
                self._buffer = self._gl.buffer(reserve=4 * data.itemsize * 6, dynamic=True)
            self._buffer.write(data)
            array = self._gl.vertex_array(program, [(self._buffer, "3f 3f/i", "a_from", "a_to")])
            array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(lines))
            array.release()

    def release(self) -> None:
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None


def axes_lines(camera: Camera, height: int) -> list[tuple[int, np.ndarray]]:
    """The axes of the world as `camera` is turned, the farthest first: each with its number and lines (n, 2, 2) in
    pixels from the lower left of a picture of this height, the arm and then the strokes of its letter."""
    arm, letter = ARM * height, LETTER * height
    corner = np.full(2, 1.6 * (arm + letter))
    turned = camera.pose[:3, :3].T  # columns: the axes of the world in the camera's
    lines = []
    for axis in np.argsort(turned[2]):
        direction = turned[:2, axis]
        tip = corner + arm * direction
        at = tip + 1.8 * letter * (direction / max(float(np.linalg.norm(direction)), 0.3))
        strokes = at + 0.7 * letter * np.array(_LETTERS[axis], float).reshape(-1, 2, 2)
        lines.append((int(axis), np.concatenate([[[corner, tip]], strokes])))
    return lines
