"""Shadow maps: one atlas of depth tiles, drawn again only when the scene moves or its lights change.

A directional or a spot light has one tile, a point light the six faces of a cube. Each tile is fitted to the scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import moderngl
import numpy as np

from ..gpu.free import free
from ..plan.model import Draw, Plan
from ..scene.frame import Frame
from ..scene.light import Light
from ..scene.scene import Scene

ATLAS_SIDE = 4096
MAX_TILE = 2048
_MOST_WAITING = 1 << 18
"""Triangles after which the driver is waited for. Mesa's software rasteriser keeps 200 bytes of each that it has not
drawn yet, in 64 maps of 15,000 triangles 110 MB."""
_KEPT = 2
"""The maps of how many plans are kept: a window that is split between two modes draws with two in turn."""


PrepareMesh = Callable[[Draw, np.ndarray], Callable[[np.ndarray, np.ndarray], None]]
"""It gets instances of a mesh and the matrix from the world to scene units about the scene's centre. It returns what
draws them, until it is called for the next ones, by the matrix from the world to clip space and the light's place in
scene units."""


@dataclass(frozen=True)
class Casters:
    """How what casts shadows is drawn. `prepare_mesh` draws depths of meshes, and `prepare_tint` what light keeps in
    those that let it through. `draw_curves` draws all curves, by a matrix from the world to clip space, into a tile of
    so many texels."""

    prepare_mesh: PrepareMesh
    prepare_tint: PrepareMesh
    draw_curves: Callable[[np.ndarray, int], None]


_FACES = ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0))  # axis and sign, as cube_face() counts them


@dataclass(frozen=True, eq=False)
class Tile:
    """A light's view: `matrix` takes scene units about the scene's centre to clip space. There is the light at `place`,
    (4,), whose last is 1, or 0 for a direction; all are 0 where panes stop it."""

    matrix: np.ndarray
    place: np.ndarray
    texel: float
    texel_per_distance: float


class Atlas:
    """A square texture of equal depth tiles, as large as ATLAS_SIDE and `max_tile` (texels) allow. `depth_texture`
    makes it, by default with 24 bits."""

    def __init__(self, gl: moderngl.Context, count: int, max_tile: int,
                 depth_texture: Callable[[tuple[int, int]], moderngl.Texture] | None = None) -> None:
        self._gl = gl
        self.tile_size, self.tiles = _layout(count, max_tile)
        self.size = _size(self.tile_size, self.tiles)
        self.texture = (depth_texture or gl.depth_texture)(self.size)
        self.texture.compare_func = "<="
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._framebuffer = gl.framebuffer(depth_attachment=self.texture)

    def lay_out(self, count: int, max_tile: int) -> bool:
        """Have other tiles, if these take a texture of the same size. Returns whether they do."""
        tile_size, tiles = _layout(count, max_tile)
        if self.size != _size(tile_size, tiles):
            return False
        self.tile_size, self.tiles = tile_size, tiles
        return True

    def draw(self, scene: Scene, tiles: Sequence[Tile], draws: Sequence[Draw], casters: Casters) -> None:
        """Draw the triangles of `draws`, and the curves, into every tile."""
        gl, framebuffer = self._gl, self._framebuffer
        framebuffer.use()
        framebuffer.clear(depth=1.0)
        gl.enable_only(moderngl.DEPTH_TEST)
        viewports = [(*self.corner(k), self.tile_size, self.tile_size) for k in range(len(tiles))]
        try:
            gl.polygon_offset = 1.0, 2.0  # half a step of depth and of slope: the rounding error of the depth map
            draw_meshes(framebuffer, viewports, scene, tiles, draws, casters.prepare_mesh)
            for viewport, tile in zip(viewports, tiles, strict=True):
                framebuffer.viewport = viewport
                casters.draw_curves(tile.matrix @ _to_center(scene), self.tile_size)
        finally:
            gl.polygon_offset = 0.0, 0.0

    def corner(self, k: int) -> tuple[int, int]:
        """Of tile k, in texels."""
        return k % self.tiles[0] * self.tile_size, k // self.tiles[0] * self.tile_size

    def release(self) -> None:
        self._framebuffer.release()
        self.texture.release()


def draw_meshes(framebuffer: moderngl.Framebuffer, viewports: Sequence[tuple[int, int, int, int]], scene: Scene,
                tiles: Sequence[Tile], draws: Sequence[Draw], prepare: PrepareMesh) -> None:
    """Draw the triangles of `draws` into every tile, whose place in the framebuffer is one of `viewports`."""
    to_center = _to_center(scene)
    matrices = [tile.matrix @ to_center for tile in tiles]
    waiting = 0
    for draw in draws:  # the outer loop, since another mesh takes longer than another tile
        mesh = scene.meshes[draw.mesh]
        if mesh.topology == "triangles":
            draw_mesh = prepare(draw, to_center)
            for viewport, matrix, tile in zip(viewports, matrices, tiles, strict=True):
                framebuffer.viewport = viewport
                draw_mesh(matrix, tile.place)
                waiting += mesh.triangle_count * max(len(draw.instances), 1)
                if waiting >= _MOST_WAITING:
                    framebuffer.ctx.finish()
                    waiting = 0


def _to_center(scene: Scene) -> np.ndarray:
    """The matrix from the world to scene units about the scene's centre."""
    matrix = np.eye(4) / scene.radius
    matrix[:3, 3], matrix[3, 3] = -scene.center / scene.radius, 1.0
    return matrix


def _layout(count: int, max_tile: int) -> tuple[int, tuple[int, int]]:
    """The side of a tile, and the columns and rows of an atlas."""
    columns = math.ceil(math.sqrt(count))
    return min(max_tile, ATLAS_SIDE // columns), (columns, math.ceil(count / columns))


def _size(tile_size: int, tiles: tuple[int, int]) -> tuple[int, int]:
    """Of the atlas, in texels."""
    return tiles[0] * tile_size, tiles[1] * tile_size


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
        self._tiles = []
        for light, layer in zip(plan.lights, plan.shadow_layers, strict=True):
            if layer >= 0:
                tiles = light_tiles(light, scene, self.tile_size)
                is_stopped = plan.photons and light in scene.lights
                self._tiles += [replace(tile, place=np.zeros(4)) for tile in tiles] if is_stopped else tiles
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
    has_panes = any(draw.is_pane for draw in plan.kinds)
    return tuple(light.kind for light in plan.lights), plan.shadow_layers, has_panes, has_panes and plan.photons


def directional_tiles(directions: np.ndarray, scene: Scene, size: int) -> list[Tile]:
    """The views of directional lights that shine along `directions`, (N, 3), fitted to the scene; `size` is a tile's
    side in texels."""
    corners = _corners(scene)
    return [_directional_tile(direction, corners, size) for direction in directions]


def light_tiles(light: Light, scene: Scene, size: int) -> list[Tile]:
    """The views of one light, fitted to the scene; `size` is a tile's side in texels."""
    corners = _corners(scene)
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


def _corners(scene: Scene) -> np.ndarray:
    """Of all boxes in the scene, about its centre and in its radius."""
    corners = np.concatenate([scene.corners.reshape(-1, 3), scene.curve_corners])
    return (corners - scene.center) / scene.radius


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
    x = _cross((0.0, 1.0, 0.0) if abs(z[1]) < 0.9 else (1.0, 0.0, 0.0), z)
    x /= np.linalg.norm(x)
    return np.stack([x, _cross(z, x), z])


def _cross(a: Sequence[float], b: Sequence[float]) -> np.ndarray:
    """As `numpy.cross`, which takes 50 times as long for two vectors."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
