"""The map of the ground: how much of an environment's light the model hides from each point of it.

It is drawn once for all cameras, from the shadow maps of directional lights that stand for the environment. Each light
adds what is hidden of it within a rectangle, since its shadow covers only a part of the map.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.programs import Programs, set_uniform
from ..gpu.short_depth import short_depth_texture
from ..scene.ground import ground_height
from ..scene.scene import Scene
from .shadows import Atlas, Tile, directional_tiles
from .units import UNIT_BACKGROUND

_SIDE = 512
"""In texels. Those about the model are as wide as those of the shadow maps."""
_TILE = 256
_LIGHT = np.dtype([("u", "3f4"), ("v", "3f4"), ("tile", "4f4"), ("box", "4f4"), ("part", "f4")])
"""The attributes of shaders/raster/ground_light.vert."""


def draw_ground_map(context: Context, programs: Programs, scene: Scene, directions: np.ndarray, parts: np.ndarray,
                    draw_tiles: Callable[[Atlas, Sequence[Tile]], None]) -> moderngl.Texture:
    """The map under lights in these `directions`, (N, 3), all above the ground. Each brings one of the `parts`, (N,),
    of all light. `draw_tiles` draws what hides them into the tiles of an atlas."""
    gl, program = context.gl, programs.get("raster/ground_light.vert", "raster/ground_light.frag", {})
    atlas = Atlas(gl, len(parts), _TILE, partial(short_depth_texture, context))
    tiles = directional_tiles(-directions, scene, atlas.tile_size)
    lights = gl.buffer(_lights(scene, atlas, directions, np.stack([tile.matrix for tile in tiles]), parts).tobytes())
    array = gl.vertex_array(program, [(lights, "3f 3f 4f 4f 1f/i", "a_u", "a_v", "a_tile", "a_box", "a_part")])
    hidden = gl.texture((_SIDE, _SIDE), 1, dtype="f4")
    hidden.repeat_x = hidden.repeat_y = False
    framebuffer = gl.framebuffer([hidden])
    try:
        draw_tiles(atlas, tiles)
        atlas.texture.use(UNIT_BACKGROUND)
        set_uniform(program, "u_atlas", UNIT_BACKGROUND)
        set_uniform(program, "u_texel", 2 / _SIDE)
        framebuffer.use()
        framebuffer.clear()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(parts))
    finally:
        free(gl, array, lights, framebuffer, atlas)
    return hidden


def _lights(scene: Scene, atlas: Atlas, directions: np.ndarray, matrices: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """The attributes of all lights. `matrices` take points about the scene's centre, in its radius, to clip space."""
    lights, size = np.zeros(len(parts), _LIGHT), np.array(atlas.size)
    from_ground = np.zeros((4, 3))
    from_ground[[0, 2, 3], [0, 1, 2]] = 1
    from_ground[1, 2] = (ground_height(scene) - scene.center[1]) / scene.radius
    to_tile = (matrices @ from_ground)[:, :2] / 2
    to_tile[..., 2] += 0.5
    lights["u"], lights["v"] = to_tile[:, 0], to_tile[:, 1]
    lights["tile"][:, :2] = np.array([atlas.corner(k) for k in range(len(parts))]) / size
    lights["tile"][:, 2:] = atlas.tile_size / size
    lights["box"], lights["part"] = _shadow_boxes(scene, directions), parts
    return lights


def _shadow_boxes(scene: Scene, directions: np.ndarray) -> np.ndarray:
    """The rectangles of the map in which the shadows of the scene's box lie: their lower and upper corners, (N, 4)."""
    low, high = (scene.bounds - (scene.center[0], ground_height(scene), scene.center[2])) / scene.radius
    shift = directions[:, [0, 2]] * (high[1] / directions[:, 1:2])  # of the shadow of its top
    left, right = low[[0, 2]] - np.maximum(shift, 0), high[[0, 2]] - np.minimum(shift, 0)
    margin = 0.02 * (right - left)  # of shadows, where the filter mixes texels of shadow maps
    texel = 2 / _SIDE
    return np.concatenate([to_map(left - margin) - texel, to_map(right + margin) + texel], axis=1)


def to_map(x: np.ndarray) -> np.ndarray:
    """As in shaders/raster/ground_map.glsl."""
    return np.where(np.abs(x) < 1, 0.5 * x, np.sign(x) - 0.5 / np.where(x == 0, 1, x))
