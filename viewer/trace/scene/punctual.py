"""Punctual lights for the tracer: their powers, and their records in the scene buffer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ...scene.color import LUMINANCE
from ...scene.light import BRIGHTEST, Light, spot_falloff
from ...scene.scene import Scene


@dataclass(frozen=True, eq=False)
class LightColumns:
    """N punctual lights, whose objects are read once: there may be tens of thousands.

    Lengths are in tracer units. An intensity in candela is divided by unit^2, so that I / d^2 stays the same.
    """

    is_far: NDArray[np.bool_]
    """Whether it is directional."""
    is_spot: NDArray[np.bool_]
    position: NDArray[np.float64]
    direction: NDArray[np.float64]
    intensity: NDArray[np.float64]
    angles: NDArray[np.float64]
    """Half angles of the inner and the outer cone in radians, (N, 2); pi where there is none."""
    reach: NDArray[np.float64]

    @classmethod
    def of(cls, lights: Sequence[Light], scene: Scene) -> LightColumns:
        unit = scene.radius
        is_far, is_spot = (np.array([light.kind == kind for light in lights], bool) for kind in ("directional", "spot"))
        intensity = _rows([light.color for light in lights], 3) * _rows([(light.intensity,) for light in lights], 1)
        with np.errstate(over="ignore"):
            intensity = np.minimum(np.where(is_far[:, None], intensity, intensity / unit / unit), BRIGHTEST)
        angles = [(light.inner_cone, light.outer_cone) if light.kind == "spot" else (np.pi, np.pi) for light in lights]
        return cls(is_far, is_spot, (_rows([light.position for light in lights], 3) - scene.center) / unit,
                   _rows([light.direction for light in lights], 3), intensity, _rows(angles, 2),
                   np.array([light.range or np.inf for light in lights], np.float64) / unit)

    def __len__(self) -> int:
        return len(self.reach)

    def __getitem__(self, which: NDArray) -> LightColumns:
        return LightColumns(*(getattr(self, field.name)[which] for field in fields(self)))

    @property
    def powers(self) -> NDArray[np.float64]:
        """About the power that reaches the scene's bounding sphere, luminance, (N,); 0 only if none does."""
        distance = np.linalg.norm(self.position, axis=1)
        # Seen from a distance d, the sphere has the solid angle pi / d^2. For a light within it, all directions count.
        # A spot light fills a cone.
        seen = 4 * np.pi / np.maximum(1, 4 * distance**2)
        cone = 4 * np.pi * (np.sin(self.angles / 2) ** 2).mean(axis=1)  # 1 - cos = 2 sin^2 of the half
        angle = np.where(self.is_far, np.pi, np.where(distance - 1 < self.reach, np.minimum(seen, cone), 0))
        return self.intensity @ LUMINANCE * angle

    @property
    def texels(self) -> NDArray[np.float32]:
        """(3 N, 4): three texels for each light, as shaders/trace/punctual.glsl reads them."""
        is_far = self.is_far[:, None]
        scale, offset = spot_falloff(*self.angles.T)
        texels = np.zeros((len(self), 3, 4))
        texels[:, 0, :3] = np.where(is_far, -self.direction, self.position)
        # No square beyond float64: a light of a range below 1e-18 of the scene's radius reaches nothing.
        texels[:, 0, 3] = np.where(self.is_far, -1.0, np.maximum(self.reach, 1e-18) ** -2.0)
        texels[:, 1, :3] = self.intensity
        texels[:, 1, 3] = np.where(self.is_spot, scale, 0.0)  # others shine all around
        texels[:, 2, :3] = self.direction
        texels[:, 2, 3] = np.where(self.is_spot, offset, 1.0)
        return np.clip(texels, -3e38, 3e38).astype(np.float32).reshape(-1, 4)


def _rows(values: Sequence[Sequence[float]], columns: int) -> NDArray[np.float64]:
    """(N, columns); numpy reads a flat list several times as fast as a list of tuples."""
    return np.array([number for row in values for number in row], np.float64).reshape(-1, columns)
