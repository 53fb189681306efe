"""The quality that a picture takes where none is named: by a rule, and never by the clock, so that pictures repeat.

The rule foresees the processor time of `pbr-viewer render` with Mesa's llvmpipe, from its start to its picture, as a
sum over what has to be loaded, prepared and drawn. `python -m benchmarks.quality` measures such times beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..quality import POINTS
from ..scene.scene import Scene

TIMES = 1.9
"""It is to be foreseen within so many times a draft's time, so that it is within twice where the sum errs a little."""
LIGHTS = int(POINTS["standard"]["environment_shadows"]), 16
"""How many of the environment may cast shadows, the most first. 32 come no nearer to pictures of other engines than 16,
and 8 lose half or more of what 16 gain (benchmarks/results/choices_visibility.md)."""
_START_S, _MATERIAL_S, _MEGATEXEL_S, _TRIANGLE_S, _MEGAPIXEL_S = 0.6, 0.013, 0.024, 3.7e-6, 0.25
"""Of a draft: Python, its packages and the OpenGL context; a material's program, a million texels of its textures, a
triangle, a million pixels."""
_SHADED_MEGAPIXEL_S = 0.3
"""Of shading four points of each of a million pixels, beyond a draft."""
_MAP_S, _CASTER_S, _CAST_TRIANGLE_S, _SHADOWED_MEGAPIXEL_S = 3.7e-3, 0.2e-3, 0.4e-6, 0.016
"""Of the shadows of one light: its map, an instance and a triangle in it, and a million of the points that look it up.
"""
_MOST_SHADOWED = (1 << 17) / 1e6
"""As `MOST_POINTS` of viewer/raster/visibility.py."""


@dataclass(frozen=True)
class FirstPicture:
    """Foreseen seconds of processor time, from the start of the command."""

    draft: float
    unshadowed: float
    """Of `standard`, but for the shadows of the environment."""
    light: float
    """Of the shadows of each of its lights."""

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> FirstPicture:
        megapixels = size[0] * size[1] / 1e6
        used = {scene.meshes[instance.mesh].material for instance in scene.instances}
        megatexels = sum(image.width * image.height for image in scene.images) / 1e6
        triangles = scene.triangle_count + 2 * sum(len(curves.points) for curves in scene.curves)
        draft = _START_S + _MATERIAL_S * len(used) + _MEGATEXEL_S * megatexels + _TRIANGLE_S * triangles \
            + _MEGAPIXEL_S * megapixels
        light = 0.0
        if scene.environment is not None and (scene.instances or scene.curves):
            light = _MAP_S + _CASTER_S * len(scene.instances) + _CAST_TRIANGLE_S * triangles \
                + _SHADOWED_MEGAPIXEL_S * min(megapixels, _MOST_SHADOWED)
        return cls(draft, draft + _SHADED_MEGAPIXEL_S * megapixels, light)

    def standard(self, lights: int) -> float:
        """With so many lights of the environment."""
        return self.unshadowed + lights * self.light

    @property
    def lights(self) -> int:
        """The most of LIGHTS with which `standard` is foreseen within TIMES the time of a draft; 0: with none, so that
        the picture is a draft.

        `high` is never taken: its light is baked, which alone takes longer than a draft.
        """
        return next((lights for lights in LIGHTS if self.standard(lights) <= TIMES * self.draft), 0)

    @property
    def reason(self) -> str:
        lights = self.lights or LIGHTS[-1]
        within = "within" if self.lights else "not within"
        fewer = f" with {lights} of {LIGHTS[0]} lights of the environment" if lights < LIGHTS[0] else ""
        return f"foreseen {within} {TIMES:g} times a draft's time{fewer}: " \
            f"{self.standard(lights):.2f} s, {self.draft:.2f} s"
