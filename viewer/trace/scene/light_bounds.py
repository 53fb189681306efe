"""What is known of a group of lights: where they are, how strong, and towards where they shine.

Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", section 4.1, with
spheres in place of boxes. shaders/trace/light_bounds.glsl bounds the light that arrives from a group by this.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ...scene.color import LUMINANCE
from ...scene.unit_vectors import octahedron
from ..layout import (
    LIGHT_COSINE_STEPS,
    LIGHT_FLAG_SHIFT,
    LIGHT_LAMP,
    LIGHT_NARROW,
    LIGHT_REACH_LOW,
    LIGHT_REACH_STEPS,
    LIGHT_TWO_SIDED,
)
from .geometry import TraceGeometry
from .punctual import LightColumns

_FAINTEST = 1e-20
"""Least intensity, of the greatest one: the products of shaders/trace/light_bounds.glsl stay normal in float32."""


@dataclass(frozen=True, eq=False)
class LightBounds:
    """N groups of lights, or single ones. All lengths are in tracer units.

    `low`, `high` (N, 3) are a box about the lights, `radius` (N,) is that of a sphere about the middle of the box.
    `intensity` (N,) is the luminance times the area of emissive triangles, or of lamps the luminous intensity, divided
    by the greatest of all lights. Lights shine within the angle `spread` (N,), 0 to pi, about `axis` (N, 3); emissive
    triangles up to a right angle more, in proportion to the cosine of what is beyond. No light comes further than
    `reach` (N,). `flags` (N,) are LIGHT_LAMP, LIGHT_TWO_SIDED, LIGHT_NARROW (viewer/trace/layout.py).
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    radius: NDArray[np.float64]
    intensity: NDArray[np.float64]
    axis: NDArray[np.float64]
    spread: NDArray[np.float64]
    reach: NDArray[np.float64]
    flags: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.radius)

    def __getitem__(self, which: NDArray) -> LightBounds:
        return LightBounds(*(getattr(self, field.name)[which] for field in fields(self)))

    @property
    def center(self) -> NDArray[np.float64]:
        return (self.low + self.high) / 2


def light_bounds(lamps: LightColumns, radius: float, geometry: TraceGeometry, emitters: NDArray[np.uint32],
                 powers: NDArray[np.float64]) -> LightBounds:
    """Of point and spot lights of a `radius` in tracer units, and then of the emissive triangles with these records and
    powers (viewer/trace/scene/emitters.py)."""
    found = [_of_lamps(lamps, radius)] if len(lamps) else []
    found += [_of_emitters(geometry, emitters, powers)] if len(emitters) else []
    joined = LightBounds(*(np.concatenate([getattr(one, field.name) for one in found])
                           for field in fields(LightBounds)))
    scaled = joined.intensity / joined.intensity.max()
    object.__setattr__(joined, "intensity", np.maximum(scaled, _FAINTEST))
    return joined


def _of_lamps(lamps: LightColumns, radius: float) -> LightBounds:
    spread = np.where(lamps.is_spot, lamps.angles[:, 1], np.pi)
    return LightBounds(lamps.position, lamps.position, np.full(len(lamps), radius), lamps.intensity @ LUMINANCE,
                       _unit(lamps.direction), spread, lamps.reach,
                       np.where(lamps.is_spot, LIGHT_LAMP | LIGHT_NARROW, LIGHT_LAMP))


def _of_emitters(geometry: TraceGeometry, emitters: NDArray[np.uint32], powers: NDArray[np.float64]) -> LightBounds:
    corners = np.empty((len(emitters), 3, 3))
    sign, sides = np.ones(len(emitters)), np.ones(len(emitters), np.int64)
    for number in np.unique(emitters[:, 0]):
        instance, run = geometry.instances[number], emitters[:, 0] == number
        mesh = geometry.meshes[instance.mesh]
        points = mesh.positions @ instance.transform[:, :3].T + instance.transform[:, 3]
        corners[run] = points[mesh.triangles[emitters[run, 1]]]
        sign[run] = -1 if instance.is_mirrored else 1
        sides[run] = 1 + geometry.materials[instance.material].material.double_sided
    low, high = corners.min(axis=1), corners.max(axis=1)
    radius = np.linalg.norm(corners - ((low + high) / 2)[:, None], axis=2).max(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return LightBounds(low, high, radius, powers / np.pi / sides, _unit(normal) * sign[:, None],
                       np.zeros(len(emitters)), np.full(len(emitters), np.inf),
                       np.where(sides == 2, LIGHT_TWO_SIDED, 0))


def union(a: LightBounds, b: LightBounds) -> LightBounds:
    """The bounds of pairs of groups."""
    low, high = np.minimum(a.low, b.low), np.maximum(a.high, b.high)
    center = (low + high) / 2
    radius = np.minimum(np.linalg.norm(high - low, axis=1) / 2 + np.maximum(a.radius, b.radius), np.maximum(
        *(np.linalg.norm(center - one.center, axis=1) + one.radius for one in (a, b))))
    two_sided = (a.flags | b.flags) & LIGHT_TWO_SIDED
    # A double cone may be turned round.
    is_turned = (two_sided > 0) & ((a.axis * b.axis).sum(axis=1) < 0)
    axis, spread = _cone(a.axis, a.spread, np.where(is_turned[:, None], -b.axis, b.axis), b.spread)
    flags = (a.flags | b.flags) & (LIGHT_LAMP | LIGHT_TWO_SIDED) | a.flags & b.flags & LIGHT_NARROW
    return LightBounds(low, high, radius, a.intensity + b.intensity, axis, spread, np.maximum(a.reach, b.reach), flags)


def _cone(a: NDArray, spread_a: NDArray, b: NDArray, spread_b: NDArray) -> tuple[NDArray, NDArray]:
    """Axes and half angles of the least cones about two cones each."""
    between = 2 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=1) / 2, 1))
    is_a = np.minimum(between + spread_b, np.pi) <= spread_a
    is_b = ~is_a & (np.minimum(between + spread_a, np.pi) <= spread_b)
    spread = (spread_a + between + spread_b) / 2
    # From a towards b, by the angle spread - spread_a. Opposite axes have no such direction: all directions then.
    across = np.sin(between)
    is_all = (spread >= np.pi) | (np.pi - between < 1e-6)
    turn, safe = spread - spread_a, np.maximum(across, 1e-30)
    axis = np.where((across > 1e-9)[:, None],
                    (np.sin(between - turn) / safe)[:, None] * a + (np.sin(turn) / safe)[:, None] * b, a)
    axis = np.where((is_a | is_all)[:, None], a, np.where(is_b[:, None], b, axis))
    spread = np.where(is_a, spread_a, np.where(is_b, spread_b, np.where(is_all, np.pi, spread)))
    return _unit(axis), np.minimum(spread + 1e-9 * ~(is_a | is_b), np.pi)


def bounds_texels(bounds: LightBounds, links: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """(2 N, 4): two texels of the scene buffer for each, as shaders/trace/light_bounds.glsl reads them."""
    texels = np.empty((len(bounds), 2, 4), np.uint32)
    center = np.clip(bounds.center, -3e37, 3e37).astype(np.float32)
    texels[:, 0, :3] = center.view(np.uint32)
    slack = np.abs(bounds.center - center).sum(axis=1) + 1e-6 * bounds.radius
    texels[:, 0, 3] = np.minimum(bounds.radius + slack, 3e37).astype(np.float32).view(np.uint32)
    texels[:, 1, 0] = bounds.intensity.astype(np.float32).view(np.uint32)
    axis = np.round((octahedron(bounds.axis) + 1) * 32767.0).astype(np.uint32)
    texels[:, 1, 1] = axis[:, 0] | axis[:, 1] << 16
    # Rounded down by at least 1.5 steps, which is more than the axis and the shader's cosines are off.
    cosine = np.floor((np.cos(bounds.spread) + 1) / 2 * LIGHT_COSINE_STEPS - 1.5).clip(0)
    with np.errstate(divide="ignore"):
        reach = np.ceil((np.log2(bounds.reach) + LIGHT_REACH_LOW) * LIGHT_REACH_STEPS + 1e-3).clip(0, 0xFFFF)
    flags = (bounds.flags << LIGHT_FLAG_SHIFT).astype(np.uint32)
    texels[:, 1, 2] = cosine.astype(np.uint32) | flags | reach.astype(np.uint32) << 16
    texels[:, 1, 3] = links
    return texels.reshape(-1, 4)


def _unit(v: NDArray) -> NDArray:
    """Unit vectors; +Y for those without a length."""
    largest = np.abs(v).max(axis=1, keepdims=True)
    v = v / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return np.where(length > 0, v / np.where(length > 0, length, 1), (0.0, 1.0, 0.0))
