"""What work costs, as a sum over what there is of it."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.scene import Scene


@dataclass(frozen=True)
class Load:
    """What a picture is made of. `texels` are those of all image files, `pixels` the picture's."""

    pixels: int
    triangles: int
    texels: int

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> Load:
        images = {id(texture.image): texture.image for material in scene.materials
                  for texture in vars(material).values() if hasattr(texture, "image")}
        texels = sum(image.width * image.height for image in images.values())
        return cls(size[0] * size[1], scene.triangle_count, texels)


@dataclass(frozen=True)
class Cost:
    """Seconds: `fixed`, and for each pixel, triangle and texel."""

    fixed: float = 0.0
    pixel: float = 0.0
    triangle: float = 0.0
    texel: float = 0.0

    def seconds(self, load: Load) -> float:
        return self.fixed + self.pixel * load.pixels + self.triangle * load.triangles + self.texel * load.texels

    @classmethod
    def fitted(cls, base: tuple[Load, float], **others: tuple[Load, float]) -> Cost:
        """From what `base` took, and one more load for each part named: the one that has more of that.

        Nothing comes out negative: a machine that is busy meanwhile takes longer for less.
        """
        load, seconds = base
        each = {part: _slope(base, other, part + "s") for part, other in others.items()}
        fixed = seconds - sum(slope * getattr(load, part + "s") for part, slope in each.items())
        return cls(max(fixed, 0.0), **each)


def _slope(base: tuple[Load, float], other: tuple[Load, float], name: str) -> float:
    return max(other[1] - base[1], 0.0) / (getattr(other[0], name) - getattr(base[0], name))
