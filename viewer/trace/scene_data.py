"""One scene on the GPU as the tracer's programs read it: words, atlases, and the switches that say what is there."""

from __future__ import annotations

import moderngl

from ..gpu.context import Context
from ..raster.programs import set_uniform
from ..scene.scene import Scene
from .atlas import Atlas
from .geometry import TraceGeometry
from .scene_words import add_geometry, add_materials, geometry_switches
from .words import WordsBuilder

UNIT_WORDS, UNIT_COLOR_ATLAS, UNIT_DATA_ATLAS = 14, 13, 12
"""Texture units of what all passes read; a pass's own textures are below."""


class SceneData:
    """Begins to decode the textures; others may add sections to `words` until `upload`."""

    def __init__(self, context: Context, scene: Scene, geometry: TraceGeometry) -> None:
        self._context, self._name = context, scene.name
        self.switches = geometry_switches(scene, geometry)
        color = [use.texture.image for m in geometry.materials for use in m.color_maps]
        data = [texture.image for m in geometry.materials for texture in m.data_textures]
        self._color = Atlas(context, color, True) if color else None
        self._data = Atlas(context, data, False) if data else None
        self.warnings = [line for atlas in (self._color, self._data) if atlas for line in atlas.layout.warnings]
        self.words = WordsBuilder()
        add_geometry(self.words, scene, geometry, self.switches)
        pages = (atlas.layout.pages if atlas else {} for atlas in (self._color, self._data))
        add_materials(self.words, geometry, *pages)
        self._textures: dict[str, tuple[int, moderngl.Texture]] = {}

    def upload(self) -> None:
        """Make the textures. Raises InputError for an image that is broken."""
        self._textures["u_words"] = UNIT_WORDS, self.words.texture(self._context.gl, self._name)
        if self._color:
            self._textures["u_color_atlas"] = UNIT_COLOR_ATLAS, self._color.upload()
        if self._data:
            self._textures["u_data_atlas"] = UNIT_DATA_ATLAS, self._data.upload()

    def bind(self, program: moderngl.Program) -> None:
        """Bind the textures and set the uniforms that shaders/trace/{words,atlas,interaction,material}.glsl read."""
        for name, (unit, texture) in self._textures.items():
            texture.use(unit)
            set_uniform(program, name, unit)
        for name, offset in self.words.uniforms().items():
            set_uniform(program, name, offset)

    @property
    def texture_bytes(self) -> int:
        """What they take on the GPU."""
        textures = [texture for _, texture in self._textures.values()]
        return sum(t.width * t.height * t.components * int(t.dtype[1]) for t in textures)

    def release(self) -> None:
        for atlas in (self._color, self._data):
            if atlas:
                atlas.cancel()
        for _, texture in self._textures.values():
            texture.release()
