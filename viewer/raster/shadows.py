"""Shadow maps: one atlas of depth tiles, drawn again only when the scene moves or its lights change.

A directional or a spot light has one tile, a point light the six faces of a cube. Each tile is fitted to the scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ..gpu.free import free
from ..plan.model import Draw, Plan
from ..scene.frame import Frame
from ..scene.light import Light
from ..scene.scene import Scene

ATLAS_SIDE = 4096
MAX_TILE = 2048
_KEPT = 2
"""The maps of how many plans are kept: a window that is split between two modes draws with two in turn."""


@dataclass(frozen=True)
class Casters:
    """How what casts shadows is drawn: a mesh by matrices from its own space to clip space and to scene units about the
    scene's centre, and the light's place there; and all curves by a matrix from the world to clip space, into a tile of
    so many texels."""

    draw_depth: Callable[[Draw, np.ndarray, np.ndarray, np.ndarray], None]
    draw_curves: Callable[[np.ndarray, int], None]


_FACES = ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0))  # axis and sign, as cube_face() counts them


@dataclass(frozen=True, eq=False)
class Tile:
    """A light's view: `matrix` takes scene units about the scene's centre to clip space. There is the light at `place`,
    (4,), whose last is 1, or 0 for a direction."""

    matrix: np.ndarray
    place: np.ndarray
    texel: float
    texel_per_distance: float


class Atlas:
    """A square texture of equal depth tiles, as large as ATLAS_SIDE and `max_tile` (texels) allow."""

    def __init__(self, gl: moderngl.Context, count: int, max_tile: int) -> None:
        self._gl = gl
        self._columns = math.ceil(math.sqrt(count))
        self.tile_size = min(max_tile, ATLAS_SIDE // self._columns)
        rows = math.ceil(count / self._columns)
        self.tiles = self._columns, rows
        self.texture = gl.depth_texture((self._columns * self.tile_size, rows * self.tile_size))
        self.texture.compare_func = "<="
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._framebuffer = gl.framebuffer(depth_attachment=self.texture)

    def draw(self, scene: Scene, tiles: Sequence[Tile], draws: Sequence[Draw], casters: Casters) -> None:
        """Draw the triangles of `draws`, and the curves, into every tile."""
        gl, framebuffer = self._gl, self._framebuffer
        framebuffer.use()
        framebuffer.clear(depth=1.0)
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.polygon_offset = 1.0, 2.0  # half a step of depth and of slope: the rounding error of the depth map
        to_center = np.eye(4) / scene.radius
        to_center[:3, 3], to_center[3, 3] = -scene.center / scene.radius, 1.0
        draws = [draw for draw in draws if scene.meshes[draw.mesh].topology == "triangles"]
        for k, tile in enumerate(tiles):
            framebuffer.viewport = (*self.corner(k), self.tile_size, self.tile_size)
            for draw in draws:
                transform = scene.instances[draw.instance].transform
                casters.draw_depth(draw, tile.matrix @ to_center @ transform, to_center @ transform, tile.place)
            casters.draw_curves(tile.matrix @ to_center, self.tile_size)
        gl.polygon_offset = 0.0, 0.0

    def corner(self, k: int) -> tuple[int, int]:
        """Of tile k, in texels."""
        return k % self._columns * self.tile_size, k // self._columns * self.tile_size

    def release(self) -> None:
        self._framebuffer.release()
        self.texture.release()


class ShadowMaps:
    """The atlas for one plan."""

    def __init__(self, gl: moderngl.Context, plan: Plan, casters: Casters) -> None:
        self._key, self._casters = _key(plan), casters
        self._atlas = Atlas(gl, plan.shadow_layer_count, MAX_TILE)
        self.texture, self.tile_size = self._atlas.texture, self._atlas.tile_size
        self._tiles: list[Tile] = []
        self._scene: Scene | None = None
        self._lights: tuple[Light, ...] = ()

    def show(self, scene: Scene, plan: Plan) -> None:
        """Draw the maps, unless they show this scene, and these lights, already."""
        if self._scene is not None and scene.has_surfaces_of(self._scene) and plan.lights == self._lights:
            return
        self._tiles = [tile for light, layer in zip(plan.lights, plan.shadow_layers, strict=True) if layer >= 0
                       for tile in light_tiles(light, scene, self.tile_size)]
        self._atlas.draw(scene, self._tiles, plan.draws, self._casters)
        self._scene, self._lights = scene, plan.lights

    def pack(self, frame: Frame) -> np.ndarray:
        """The uniform block of shaders/light/shadow.glsl, (tiles, 20) float32."""
        from_eye = np.eye(4)
        from_eye[:3, 3] = (frame.camera.eye - frame.scene.center) / frame.unit
        to_unit = np.array([[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1.0]])
        rows = np.zeros((len(self._tiles), 20), np.float32)
        for k, tile in enumerate(self._tiles):
            rows[k, :16] = (to_unit @ tile.matrix @ from_eye).T.ravel()
            rows[k, 16:18] = tile.texel, tile.texel_per_distance
            rows[k, 18:] = self._atlas.corner(k)
        return rows

    def holds(self, plan: Plan) -> bool:
        """Whether these have the tiles that `plan` needs."""
        return _key(plan) == self._key

    def release(self) -> None:
        self._atlas.release()


class KeptShadowMaps:
    """The maps of the plans drawn last."""

    def __init__(self, gl: moderngl.Context, casters: Casters) -> None:
        self._gl, self._casters = gl, casters
        self._maps: list[ShadowMaps] = []

    def show(self, scene: Scene, plan: Plan) -> None:
        """Draw the maps of `plan`, unless they are there."""
        maps = self.of(plan)
        if maps is None:
            self._maps, dropped = self._maps[:_KEPT - 1], self._maps[_KEPT - 1:]
            free(self._gl, *dropped)
            maps = ShadowMaps(self._gl, plan, self._casters)
            self._maps.insert(0, maps)
        maps.show(scene, plan)

    def of(self, plan: Plan) -> ShadowMaps | None:
        return next((maps for maps in self._maps if maps.holds(plan)), None)

    def release(self) -> None:
        """None is held afterwards."""
        free(self._gl, *self._maps)
        self._maps = []


def _key(plan: Plan) -> tuple[object, ...]:
    return tuple(light.kind for light in plan.lights), plan.shadow_layers, any(draw.is_pane for draw in plan.kinds)


def light_tiles(light: Light, scene: Scene, size: int) -> list[Tile]:
    """The views of one light, fitted to the scene; `size` is a tile's side in texels."""
    corners = np.concatenate([scene.corners.reshape(-1, 3), scene.curve_corners])
    corners = (corners - scene.center) / scene.radius
    if light.kind == "directional":
        return [_directional_tile(np.asarray(light.direction, np.float64), corners, size)]
    origin = (np.asarray(light.position, np.float64) - scene.center) / scene.radius
    far = max(float(np.linalg.norm(corners - origin, axis=1).max()), 1e-6) * 1.001
    if light.kind == "spot":
        # A cone of 89 degrees would need an almost infinite plane. Outside the tile nothing is shadowed.
        half = math.tan(min(light.outer_cone * 1.02 + 0.01, math.radians(80)))
        return [_perspective_tile(origin, np.asarray(light.direction, np.float64), half, far, size)]
    half = size / (size - 4)  # two texels beyond the face for the filter
    return [_perspective_tile(origin, np.eye(3)[axis] * sign, half, far, size) for axis, sign in _FACES]


def _directional_tile(direction: np.ndarray, corners: np.ndarray, size: int) -> Tile:
    basis = _basis(direction)
    local = corners @ basis.T
    low, high = local.min(axis=0), local.max(axis=0)
    margin = (high - low).max() * 2 / size + 1e-6
    low, high = low - margin, high + margin
    matrix = np.eye(4)
    matrix[:3, :3] = basis * (2.0 / (high - low))[:, None]
    matrix[:3, 3] = -(high + low) / (high - low)
    return Tile(matrix, np.array([*direction, 0.0]), float((high - low)[:2].max()) / size, 0.0)


def _perspective_tile(origin: np.ndarray, direction: np.ndarray, half: float, far: float, size: int) -> Tile:
    near = far * 1e-3
    view = np.eye(4)
    view[:3, :3] = _basis(direction)
    view[:3, 3] = -view[:3, :3] @ origin
    projection = np.zeros((4, 4))
    projection[0, 0] = projection[1, 1] = 1.0 / half
    projection[2, 2], projection[2, 3] = (far + near) / (far - near), -2 * far * near / (far - near)
    projection[3, 2] = 1.0
    return Tile(projection @ view, np.array([*origin, 1.0]), 0.0, 2.0 * half / size)


def _basis(direction: np.ndarray) -> np.ndarray:
    """Rows x, y, z of a frame whose z is `direction`."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])
