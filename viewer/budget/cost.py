"""What work costs, as a sum over what there is of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from ..bake.environment import is_baked
from ..plan.model import Plan
from ..plan.planner import plan_scene
from ..scene.scene import Scene
from ..settings import Settings


@dataclass(frozen=True)
class Load:
    """What a picture is made of.

    `texels` are those of all image files, `pixels` the picture's; `draws` one for each instance; `programs` the
    surface shaders that a plain picture takes; `shadowed` the triangles that go into shadow maps, as often as they do;
    `bakes` environments that are not in the cache.
    """

    pixels: int
    triangles: int
    texels: int
    draws: int = 0
    programs: int = 0
    shadowed: int = 0
    bakes: int = 0

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int], plan: Plan | None = None, use_cache: bool = True) -> Load:
        """`plan` is what `plain_plan` gives."""
        plan = plan or plain_plan(scene)
        images = {id(texture.image): texture.image for material in scene.materials
                  for texture in vars(material).values() if hasattr(texture, "image")}
        texels = sum(image.width * image.height for image in images.values())
        # Whether an environment has a sun is known when it is baked: count one.
        layers = plan.shadow_layer_count + plan.environment
        bakes = plan.environment and scene.environment is not None and not (use_cache and is_baked(scene.environment))
        return cls(size[0] * size[1], scene.triangle_count, texels, len(plan.draws), len(plan.programs),
                   layers * scene.triangle_count, int(bakes))


def plain_plan(scene: Scene) -> Plan:
    """What a picture of the raster with no more than the defaults takes."""
    return plan_scene(scene, Settings(), scene.lights, samples=1, half_target=False, orthographic=False)


@dataclass(frozen=True)
class Cost:
    """Seconds: `fixed`, and for each of what a `Load` counts."""

    fixed: float = 0.0
    pixel: float = 0.0
    triangle: float = 0.0
    texel: float = 0.0
    draw: float = 0.0
    program: float = 0.0
    shadowed: float = 0.0
    bake: float = 0.0

    def seconds(self, load: Load) -> float:
        return (self.fixed + self.pixel * load.pixels + self.triangle * load.triangles + self.texel * load.texels
                + self.draw * load.draws + self.program * load.programs + self.shadowed * load.shadowed
                + self.bake * load.bakes)

    def __add__(self, other: Cost) -> Cost:
        return Cost(**{name: value + getattr(other, name) for name, value in asdict(self).items()})

    @classmethod
    def fitted(cls, base: tuple[Load, float], known: Cost | None = None, **others: tuple[Load, float]) -> Cost:
        """From what `base` took, and one more load for each part named: the one that has more of that and as much, or
        nearly, of the rest. What is `known` comes on top of the parts that are looked for.

        Nothing comes out negative: a machine that is busy meanwhile takes longer for less.
        """
        known = known or cls()

        def left(pair: tuple[Load, float]) -> float:
            return pair[1] - known.seconds(pair[0])

        each = {part: max(left(other) - left(base), 0.0) / (_count(other[0], part) - _count(base[0], part))
                for part, other in others.items()}
        fixed = left(base) - sum(slope * _count(base[0], part) for part, slope in each.items())
        return cls(max(fixed, 0.0), **each) + known


def _count(load: Load, part: str) -> int:
    return int(getattr(load, part if part == "shadowed" else part + "s"))
