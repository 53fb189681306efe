"""Shadow maps of the environment on disk, so that a later process that draws the same model need not draw them.

They depend on geometry and on the environment, but not on the camera. Mesa's software rasteriser takes 15 times as long
to draw 64 maps of a model of 15,000 triangles as it takes to read them. A graphics card draws them faster than a disk
reads.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..bake import cache as disk
from ..base.digest import digest, files_digest
from ..gpu.context import Context
from ..gpu.short_depth import read_depths, write_depths
from ..gpu.source import assemble
from ..plan.model import Draw
from ..scene.scene import Scene
from .shadows import Atlas, Casters, Tile
from .surface_programs import SHADOW_VERTEX, shadow_maps_of, shadow_program

_PACKAGE = Path(__file__).parents[1]
_CODE = [_PACKAGE / name for name in ("raster/shadows.py", "raster/surface_casters.py", "raster/geometry.py",
                                      "raster/instances.py", "gpu/short_depth.py")]
"""The files that draw the maps, and lay them out in memory."""


class KeptMaps:
    """Draws one atlas, the first of a renderer, from the disk if it is there, and otherwise keeps it there. One that
    draws many models or poses would write one of up to 32 MB for each."""

    def __init__(self, context: Context, use_cache: bool) -> None:
        self._context = context
        self._may_keep = use_cache and context.is_software

    def draw(self, atlas: Atlas, scene: Scene, tiles: Sequence[Tile], draws: Sequence[Draw], casters: Casters) -> None:
        """As `atlas.draw`, with the same depths."""
        name = self._name(atlas, scene, tiles, draws) if self._may_keep and disk.cache_folder() is not None else None
        self._may_keep = False
        stored = disk.load(name) if name else None
        if stored is not None:
            write_depths(self._context, atlas.texture, stored["depths"])
            return
        atlas.draw(scene, tiles, draws, casters)
        if name:
            disk.store(name, {"depths": read_depths(self._context, atlas.texture, atlas.size)})

    def _name(self, atlas: Atlas, scene: Scene, tiles: Sequence[Tile], draws: Sequence[Draw]) -> str | None:
        """By all that the depths depend on; None where they depend on curves or images, too."""
        if scene.curves or any(shadow_maps_of(draw) for draw in draws):
            return None
        context = self._context
        programs = [shadow_program(draw) for draw in draws]
        shaders = dict.fromkeys((file, program.switches) for program in programs
                                for file in (SHADOW_VERTEX, program.fragment))
        meshes = [scene.meshes[number] for number in sorted({draw.mesh for draw in draws})]
        places = [[scene.instances[number].transform for number in draw.instances or (draw.instance,)]
                  for draw in draws]
        return disk.SHADOWS + disk.key(digest(
            files_digest(_CODE), context.vendor, context.renderer, context.version,
            [assemble(file, dict(switches)).text for file, switches in shaders],
            [[mesh.topology, mesh.positions, mesh.indices] for mesh in meshes],
            [[draw.mesh, program.fragment, program.switches] for draw, program in zip(draws, programs, strict=True)],
            places, scene.center, float(scene.radius), [tile.matrix for tile in tiles], atlas.tile_size, atlas.size))
