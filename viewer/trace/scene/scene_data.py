"""One scene on the GPU as the tracer's programs read it: the scene buffer, the atlases, and the switches of the
programs."""

from __future__ import annotations

import moderngl

from ...gpu.buffer_texture import BufferTexture
from ...gpu.context import Context
from ...gpu.programs import set_uniform
from ...material.pack import COLOR_ROLES
from ...scene.scene import Scene
from ...scene.texture_image import TextureImage
from .atlas import Atlas
from .encode import add_geometry, add_materials, geometry_switches
from .geometry import TraceGeometry
from .scene_buffer import SceneBufferBuilder

UNIT_SCENE, UNIT_COLOR_ATLAS, UNIT_DATA_ATLAS = 14, 13, 12
"""Texture units of the textures that all passes read. The own textures of a pass have lower units."""


class SceneData:
    """Begins to decode the textures. Sections may be added to `buffer` until `upload`, or to a copy of it."""

    def __init__(self, context: Context, scene: Scene, geometry: TraceGeometry, everything: bool = False) -> None:
        self._context, self._name = context, scene.name
        self.switches = geometry_switches(scene, geometry, everything)
        self._everything, self._shows_specular = everything, True
        color, data = _images(geometry)
        self._covering = _covering(geometry)
        self._color = Atlas(context, color, True, self._covering) if color else None
        self._data = Atlas(context, data, False) if data else None
        self.warnings = [line for atlas in (self._color, self._data) if atlas for line in atlas.layout.warnings]
        self.take(scene, geometry)
        self._uploaded = self.buffer
        self._sections: BufferTexture | None = None
        self._textures: dict[str, tuple[int, moderngl.Texture]] = {}

    def fits(self, scene: Scene, geometry: TraceGeometry) -> bool:
        """Whether the textures and programs of another scene are the same."""
        held = ({} if atlas is None else atlas.layout.pages for atlas in (self._color, self._data))
        return (geometry_switches(scene, geometry, self._everything) == self.switches
                and _covering(geometry) == self._covering
                and all(set(images) == pages.keys() for images, pages in zip(_images(geometry), held, strict=True)))

    def take(self, scene: Scene, geometry: TraceGeometry) -> None:
        """Begin a buffer for this scene, whose images are those in the atlases; it is to be uploaded."""
        self.buffer = SceneBufferBuilder()
        add_geometry(self.buffer, scene, geometry, self.switches)
        pages = (atlas.layout.pages if atlas else {} for atlas in (self._color, self._data))
        add_materials(self.buffer, geometry, *pages)

    def upload(self, buffer: SceneBufferBuilder | None = None) -> None:
        """Make the textures, with `buffer` in place of `self.buffer` if it is given.

        A second call replaces the scene buffer; the atlases stay. Raises InputError for an image that is broken.
        """
        self._uploaded = buffer or self.buffer
        if self._sections is not None:
            self._sections.release()
            self._sections = None  # in case that the next one fails
        self._sections = self._uploaded.texture(self._context, self._name)
        for name, unit, atlas in (("u_color_atlas", UNIT_COLOR_ATLAS, self._color),
                                  ("u_data_atlas", UNIT_DATA_ATLAS, self._data)):
            if atlas and name not in self._textures:
                self._textures[name] = unit, atlas.upload()

    def show_specular(self, is_shown: bool) -> None:
        """Say whether pictures show what panes let through (shaders/trace/pane.glsl)."""
        self._shows_specular = is_shown

    def bind(self, program: moderngl.Program) -> None:
        """Bind the textures and set the uniforms of the scene buffer, the atlases and the sections."""
        self.use_textures()
        self.set_uniforms(program)

    def use_textures(self) -> None:
        """Bind the textures to their units."""
        assert self._sections is not None
        self._sections.use(UNIT_SCENE)
        for unit, texture in self._textures.values():
            texture.use(unit)

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Set the uniforms of the scene buffer, the atlases and the sections."""
        # A missing atlas gets its unit, too: samplers of two types must not share a unit.
        for name, unit in (("u_color_atlas", UNIT_COLOR_ATLAS), ("u_data_atlas", UNIT_DATA_ATLAS)):
            set_uniform(program, name, unit)
        assert self._sections is not None
        self._sections.set_sampler(program, "u_scene", UNIT_SCENE)
        set_uniform(program, "u_shows_specular", self._shows_specular)
        for name, offset in self._uploaded.uniforms().items():
            set_uniform(program, name, offset)

    @property
    def texture_bytes(self) -> int:
        """Size of the textures on the GPU."""
        textures = [texture for _, texture in self._textures.values()]
        return 16 * self._uploaded.count + sum(t.width * t.height * t.components * int(t.dtype[1]) for t in textures)

    def release(self) -> None:
        for atlas in (self._color, self._data):
            if atlas:
                atlas.cancel()
        if self._sections is not None:
            self._sections.release()
        for _, texture in self._textures.values():
            texture.release()


def _images(geometry: TraceGeometry) -> tuple[list[TextureImage], list[TextureImage]]:
    """The images of colours, and those of data."""
    return ([use.texture.image for m in geometry.materials for use in m.color_maps],
            [texture.image for m in geometry.materials for texture in m.data_textures])


def _covering(geometry: TraceGeometry) -> set[TextureImage]:
    """The images whose alpha covers what is behind, in all base colours that they are."""
    uses = [(use.texture.image, m.material.alpha_mode == "opaque") for m in geometry.materials for use in m.color_maps
            if use.roles & COLOR_ROLES["base_color"]]
    return {image for image, _ in uses} - {image for image, is_opaque in uses if is_opaque}
