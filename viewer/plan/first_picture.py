"""The quality that a picture takes where none is named: by a rule, and never by the clock, so that pictures repeat.

The rule foresees the processor time of `pbr-viewer render` with Mesa's llvmpipe, from its start to its picture, as a
sum over what has to be loaded, prepared and drawn. `python -m benchmarks.quality` measures such times beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..quality import POINTS, QualityName
from ..scene.scene import Scene

TIMES = 2.0
"""It may take so many times as long as a draft."""
_START_S, _MATERIAL_S, _MEGATEXEL_S, _TRIANGLE_S, _MEGAPIXEL_S = 0.6, 0.013, 0.024, 3.7e-6, 0.25
"""Of a draft: Python, its packages and the OpenGL context; a material's program, a million texels of its textures, a
triangle, a million pixels."""
_SHADED_MEGAPIXEL_S = 0.4
"""Of shading four points of each of a million pixels, beyond a draft."""
_SHADOWS_S, _CASTER_S, _CAST_TRIANGLE_S, _SHADOWED_MEGAPIXEL_S = 0.15, 0.2e-3, 0.4e-6, 1.5
"""Of shadows of the environment: what is always there, an instance and a triangle in one light's map, and a million of
the points at which they are found."""
_LIGHTS = int(POINTS["standard"]["environment_shadows"])
_MOST_SHADOWED = (1 << 17) / 1e6
"""As `MOST_POINTS` of viewer/raster/visibility.py."""


@dataclass(frozen=True)
class FirstPicture:
    """Foreseen seconds of processor time, from the start of the command."""

    draft: float
    standard: float

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> FirstPicture:
        megapixels = size[0] * size[1] / 1e6
        used = {scene.meshes[instance.mesh].material for instance in scene.instances}
        megatexels = sum(image.width * image.height for image in scene.images) / 1e6
        triangles = scene.triangle_count + 2 * sum(len(curves.points) for curves in scene.curves)
        draft = _START_S + _MATERIAL_S * len(used) + _MEGATEXEL_S * megatexels + _TRIANGLE_S * triangles \
            + _MEGAPIXEL_S * megapixels
        standard = draft + _SHADED_MEGAPIXEL_S * megapixels
        if scene.environment is not None and (scene.instances or scene.curves):
            standard += _SHADOWS_S + _SHADOWED_MEGAPIXEL_S * min(megapixels, _MOST_SHADOWED) \
                + _LIGHTS * (_CASTER_S * len(scene.instances) + _CAST_TRIANGLE_S * triangles)
        return cls(draft, standard)

    @property
    def quality(self) -> QualityName:
        """`standard` where it is foreseen within TIMES the time of a draft, else `draft`.

        `high` is never taken: its light is baked, which alone takes longer than a draft.
        """
        return "standard" if self.standard <= TIMES * self.draft else "draft"

    @property
    def reason(self) -> str:
        within = "within" if self.quality == "standard" else "not within"
        return f"foreseen {within} {TIMES:g} times a draft's time: {self.standard:.2f} s, {self.draft:.2f} s"
