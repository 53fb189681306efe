"""Chooses the quality of a picture where none is named, by a rule and not by the clock, so that pictures repeat.

The rule foresees the processor time of `pbr-viewer render` with Mesa's llvmpipe, from its start to its picture, as a
sum over what has to be loaded, prepared and drawn. `python -m benchmarks.quality` measures such times beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..quality import POINTS
from ..scene.scene import Scene
from .instances import instances_of, is_instanced

TIMES = 1.9
"""It is to be foreseen within so many times a draft's time, so that it is within twice where the sum errs a little."""
LIGHTS = int(POINTS["standard"]["environment_shadows"]), 16
"""How many of the environment may cast shadows, the most first. 32 come no nearer to pictures of other engines than 16,
and 8 lose half or more of what 16 gain (benchmarks/results/choices_visibility.md)."""
_START_S, _MATERIAL_S, _DRAW_S, _MEGATEXEL_S, _TRIANGLE_S, _MEGAPIXEL_S = 0.46, 0.039, 0.5e-3, 0.022, 2e-6, 0.26
"""Of a draft: Python, its packages and the OpenGL context; a material's program, a draw's mesh, a million texels of its
textures, a triangle, a million pixels."""
_SHADING_S, _SHADED_DRAW_S, _SHADED_TRIANGLE_S, _SHADED_MEGAPIXEL_S = 0.04, 0.2e-3, 1e-6, 0.3
"""Of shading four points of each pixel, beyond a draft: its programs, a draw, a triangle, a million pixels."""
_FOUND_MEGAPIXEL_S = 1.2
"""Of the shadows of all lights together: a million of the points that look them up, and maps as large as these need."""
_MAP_S, _CASTER_S, _CAST_TRIANGLE_S, _SHADOWED_MEGAPIXEL_S = 0.3e-3, 8.5e-6, 0.17e-6, 0.017
"""Of the shadows of one light: its map, a draw and a triangle in it, and a million of the points that look it up."""
_MOST_SHADOWED = (1 << 17) / 1e6
"""As `MOST_POINTS` of viewer/raster/visibility.py."""


@dataclass(frozen=True)
class FirstPicture:
    """Foreseen seconds of processor time, from the start of the command."""

    draft: float
    unshadowed: float
    """Of `standard`, but for what each light of the environment adds."""
    light: float
    """Of the shadows of each of its lights."""

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> FirstPicture:
        megapixels = size[0] * size[1] / 1e6
        used = {scene.meshes[instance.mesh].material for instance in scene.instances}
        megatexels = sum(image.width * image.height for image in scene.images) / 1e6
        triangles = scene.triangle_count + 2 * sum(len(curves.points) for curves in scene.curves)
        draws = _draws(scene)
        draft = _START_S + _MATERIAL_S * len(used) + _DRAW_S * draws + _MEGATEXEL_S * megatexels \
            + _TRIANGLE_S * triangles + _MEGAPIXEL_S * megapixels
        unshadowed = draft + _SHADING_S + _SHADED_DRAW_S * draws + _SHADED_TRIANGLE_S * triangles \
            + _SHADED_MEGAPIXEL_S * megapixels
        light = 0.0
        if scene.environment is not None and (scene.instances or scene.curves):
            # Surfaces look lights up, which take as much of a picture as the square about the model does.
            shadowed = min(megapixels, _MOST_SHADOWED) * min(size) / max(size)
            unshadowed += _FOUND_MEGAPIXEL_S * shadowed
            light = _MAP_S + _CASTER_S * draws + _CAST_TRIANGLE_S * triangles + _SHADOWED_MEGAPIXEL_S * shadowed
        return cls(draft, unshadowed, light)

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
        fewer = f" with {lights} of {LIGHTS[0]} lights of the environment" if lights < LIGHTS[0] else ""
        return f"standard{fewer} is estimated to take {self.standard(lights):.2f} s, " \
            f"{'at most' if self.lights else 'more than'} {TIMES:g} times a draft's time of {self.draft:.2f} s"


def _draws(scene: Scene) -> int:
    """How many calls draw the instances, where light is not baked."""
    switches = {"INDIRECT": 0, "SUBSURFACE": 0}
    return sum(1 if is_instanced(len(numbers), scene.materials[scene.meshes[mesh].material], switches) else len(numbers)
               for mesh, numbers in instances_of(scene).items())
