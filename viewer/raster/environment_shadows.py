"""Visibility of the environment, from the shadow maps of many lights sampled from it.

The light itself still comes from the filtered environment; the ratio of shadowed to unshadowed light of the samples
multiplies it (Heitz, Hill & McGuire 2018, "Combining Analytic Direct Illumination and Stochastic Shadows"). So
unoccluded surfaces have no noise, and with more samples the picture converges to direct light. In fog, light comes from
more sides: the ratio is that of what arrives in the middle of the scene. What lets light through has tints in the place
of depths.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..gpu.short_depth import short_depth_texture
from ..plan.model import Draw, Plan
from ..scene.frame import Frame
from ..scene.scene import Scene
from .environment import EnvironmentLight
from .gbuffer import UNIT_NORMALS
from .kept_maps import KeptMaps
from .media_light import MediaLight
from .shadows import ATLAS_SIDE, Atlas, Casters, directional_tiles
from .sky_shadows import MeanSurface, mean_surface, reflected
from .sky_tints import TintAtlas

BATCH = 64
ROOM = 1 << 26
"""Texels of depth for all lights together; they take 128 MB."""
MAX_TILE = 1024
"""For most models, 16 lights with tiles of 1024 x 1024 texels have a smaller error than 256 lights with 256 x 256."""
SMALL = 400
"""Pixels across a scene up to which its maps have half as many texels a side; so many are in a picture of 256 x 256."""
UNIT_ATLAS, UNIT_TINTS = UNIT_NORMALS + 1, UNIT_NORMALS + 2
BINDING = 2
"""The binding of the uniform block, after those of lights and shadows."""


class EnvironmentShadows:
    """The shadow maps of many lights, in batches. The camera changes one thing: whether the scene `is_small` in the
    picture, no more than SMALL pixels across.

    Where they fit, they lie in the memory of `before`, which is of no use afterwards.
    """

    def __init__(self, context: Context, environment: EnvironmentLight, plan: Plan, casters: Casters,
                 is_small: bool, before: EnvironmentShadows | None) -> None:
        gl = context.gl
        self._gl, self._casters, self._estimates = gl, casters, plan.estimates_indirect
        self._environment, self._rotation = environment, environment.environment.rotation
        self._is_small, self._lights = is_small, environment.many_lights(plan.environment_shadows)
        self._count = len(self._lights.directions)
        columns = math.ceil(math.sqrt(min(self._count, BATCH)))
        side = ATLAS_SIDE // 2 if is_small else ATLAS_SIDE
        tile_size = min(math.isqrt(ROOM // self._count), MAX_TILE, side // columns)
        number = math.ceil(self._count / BATCH)
        # Estimates are made for each batch by itself, so all of its sky must be in it.
        self._parts = [slice(k, None, number) if self._estimates else slice(k * BATCH, (k + 1) * BATCH)
                       for k in range(number)]
        counts = [len(self._lights.directions[part]) for part in self._parts]
        self._atlases: list[Atlas] = []
        self._tints: list[TintAtlas] = []
        if before is not None:
            self._atlases, before._atlases = before._atlases, []
            before.release()
        if len(self._atlases) != len(counts) or not all(
                atlas.lay_out(count, tile_size) for atlas, count in zip(self._atlases, counts, strict=True)):
            self.release()
            short = partial(short_depth_texture, context)  # these depths are linear: a step is far below a texel
            self._atlases = [Atlas(gl, count, tile_size, short) for count in counts]
        self._tints = [TintAtlas(gl, atlas) for atlas in self._atlases if plan.tints_sky]
        self._batches: list[tuple[Atlas, np.ndarray, np.ndarray]] = []
        self._surface = MeanSurface(np.zeros(3), np.zeros(3), 0.0)
        self._emission = np.zeros(3)
        self._scene: Scene | None = None
        self._fog: MediaLight | None = None
        self._scale = 0.0

    def show(self, scene: Scene, plan: Plan, fog: MediaLight | None,
             mean: Callable[[Draw, str], np.ndarray], kept: KeptMaps) -> None:
        """Draw the maps, unless they show this scene already or are `kept` on disk. `fog` is the light in it, None
        without fog, and `mean` gives that of a material's map."""
        is_shown = self._scene is not None and scene.has_surfaces_of(self._scene)
        scale = 1.0 if fog is not None else self._environment.scale
        if is_shown and fog is self._fog and scale == self._scale:
            return
        if not is_shown:
            self._draw(scene, plan, kept)
            if self._estimates:
                self._surface = mean_surface(scene, plan.draws, mean)
        lights = self._lights if fog is None else fog.arriving(self._environment.sky_lights(plan, self._count))
        unit = max(lights.irradiance.max(), 1e-300)
        instead = reflected(lights, self._surface.reflectance)[:, :3] if self._estimates else np.zeros((self._count, 3))
        for part, (_, _, rows) in zip(self._parts, self._batches, strict=True):
            rows[:, 4, :3], rows[:, 4, 3] = lights.irradiance[part] / unit, lights.solid_angles[part]
            rows[:, 5, :3] = instead[part] / unit
        self._emission = np.minimum(self._surface.emission / max(unit * scale, 1e-300), 1e9)
        self._scene, self._fog, self._scale = scene, fog, scale

    def _draw(self, scene: Scene, plan: Plan, kept: KeptMaps) -> None:
        lights = self._lights
        self._batches = []
        for k, (part, atlas) in enumerate(zip(self._parts, self._atlases, strict=True)):
            tiles = directional_tiles(-lights.directions[part], scene, atlas.tile_size)
            kept.draw(atlas, scene, tiles, [d for d in plan.draws if d.hides_sky], self._casters)
            if self._tints:
                self._tints[k].draw(scene, tiles, plan, self._casters)
            matrices = np.stack([_to_atlas(atlas, number) @ tile.matrix for number, tile in enumerate(tiles)])
            rows = np.zeros((len(tiles), 6, 4))
            rows[:, 3, :3], rows[:, 3, 3] = lights.directions[part], [tile.texel for tile in tiles]
            self._batches.append((atlas, matrices, rows))

    def forget_scene(self) -> None:
        """Let `show` draw the maps again, for meshes or programs that have changed."""
        self._scene = None

    def holds(self, environment: EnvironmentLight, plan: Plan, is_small: bool) -> bool:
        """Whether these are the lights that `plan` needs of `environment`, in maps of the size that is needed."""
        return (environment is self._environment and environment.environment.rotation == self._rotation
                and self._count == plan.environment_shadows and self._estimates == plan.estimates_indirect
                and bool(self._tints) == plan.tints_sky and self._is_small == is_small)

    def add(self, programs: Programs, frame: Frame, uniforms: dict[str, object]) -> None:
        """Add shadowed and unshadowed light to the two targets of the framebuffer in use, by blending."""
        from_eye = np.eye(4)
        from_eye[:3, 3] = (frame.camera.eye - frame.scene.center) / frame.unit
        for k, (atlas, matrices, rows) in enumerate(self._batches):
            rows[:, :3] = (matrices @ from_eye)[:, :3]
            program = programs.get("display/fullscreen.vert", "raster/environment_shadows.frag", {
                "LIGHTS": len(rows), "ESTIMATED": int(self._estimates), "TINTED": int(bool(self._tints)),
                "IS_ORTHOGRAPHIC": int(frame.camera.height is not None)})
            for name, value in uniforms.items():
                set_uniform(program, name, value)
            atlas.texture.use(UNIT_ATLAS)
            set_uniform(program, "u_atlas", UNIT_ATLAS)
            if self._tints:
                self._tints[k].texture.use(UNIT_TINTS)
                set_uniform(program, "u_tints", UNIT_TINTS)
            if self._estimates:
                for name, value in (("u_reflectance", self._surface.reflectance), ("u_emission", self._emission)):
                    set_uniform(program, name, tuple(value))
                set_uniform(program, "u_body", self._surface.width)
            set_uniform(program, "u_least_alpha", min(2.0 / self._count**0.5, 1.0))
            block = self._gl.buffer(rows.astype(np.float32))
            block.bind_to_uniform_block(BINDING)
            program["FarLights"].binding = BINDING
            fullscreen(self._gl, program).render(vertices=3)
            block.release()

    def release(self) -> None:
        for atlas in (*self._atlases, *self._tints):
            atlas.release()
        self._atlases, self._tints = [], []


def _to_atlas(atlas: Atlas, k: int) -> np.ndarray:
    """Clip space of tile k to texture coordinates and depth in the atlas."""
    matrix = np.diag([0.5, 0.5, 0.5, 1.0])
    matrix[:3, 3] = 0.5
    width, height = atlas.size
    scale = np.diag([atlas.tile_size / width, atlas.tile_size / height, 1.0, 1.0])
    scale[:2, 3] = np.divide(atlas.corner(k), (width, height))
    return scale @ matrix
