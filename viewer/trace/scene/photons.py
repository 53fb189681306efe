"""What photons are aimed at: the surfaces with delta lobes, as boxes, and the cones in which lights send them there.

A photon is a path that begins at a light without size (shaders/trace/emit.frag). It brings the light that no path from
the camera finds: that which a delta lobe, such as smooth glass or a mirror, scatters first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...base.counted import counted
from ...material.pack import DATA_ROLES
from ...material.use import DELTA_ALPHA
from ...plan.warnings import NO_PHOTONS
from ...scene.color import LUMINANCE
from ...scene.light import Light
from ...scene.material import ANISOTROPY
from ...scene.scene import Scene
from ...settings import Settings
from ..kinds import GLASS
from .alias import alias_table
from .geometry import TraceGeometry, TraceInstance
from .inside import solids_around
from .materials import TraceMaterial
from .punctual import LightColumns
from .scene_buffer import SceneBufferBuilder

MOST_TARGETS = 64
"""Targets of one light: more surfaces are grouped, each with those near to it."""
_MOST_PAIRS = 1 << 18
_SLACK, _MARGIN = 1 + 1e-5, 1e-6
"""For float32: directions are rounded, and rays are aimed at the edges of boxes, too."""


class Photons:
    """Adds the section `photon_pairs` to `buffer` if the settings ask for photons, there is a light in `lit` (those
    that light something) and a target. `count` is the number of targets, 0 if no photon is traced.

    `uniforms` are those of shaders/trace/emit.frag, and u_photon_power. `left_out` has lines for the user.
    """

    def __init__(self, scene: Scene, geometry: TraceGeometry, buffer: SceneBufferBuilder, settings: Settings,
                 lit: Sequence[Light]) -> None:
        self.count, self._lights = 0, len(lit)
        self.uniforms: dict[str, object] = {}
        self.left_out: list[str] = []
        if settings.caustics != "photons":
            if lit and any(_is_smooth_glass(geometry, instance) for instance in geometry.instances):
                self.left_out = ["light from point, spot or directional lights through smooth glass: no path from the "
                                 "camera can hit them; caustics=photons finds it"]
            return
        if not lit:
            self.left_out = [f"{NO_PHOTONS}there is no point, spot or directional light"]
            return
        targets = delta_targets(geometry).grouped(max(min(MOST_TARGETS, _MOST_PAIRS // len(lit)), 1))
        if not len(targets.radius):
            self.left_out = [f"{NO_PHOTONS}no surface is smooth glass or a smooth mirror"]
            return
        self.count = len(targets.radius)
        texels, power = photon_pairs(lit, scene, targets, settings.light_radius / scene.radius)
        inside = [_medium_at(geometry, scene, light) for light in lit]
        texels.reshape(len(lit), -1, 3, 4)[:, :, 0, 0] = np.array(inside, np.uint32)[:, None]
        buffer.add("photon_pairs", texels.reshape(-1, 4))
        self.uniforms = {"u_photon_pair_count": len(texels), "u_photon_target_count": self.count,
                         "u_photon_power": min(power, 3e38)}
        if geometry.curves is not None:
            self.left_out = ["light that smooth surfaces throw on curves: photons end there"]

    @property
    def description(self) -> str:
        """What is traced, for the plan."""
        return f"photons from {counted(self._lights, 'light')} to {counted(self.count, 'smooth surface')}"


def has_delta_lobe(material: TraceMaterial) -> bool:
    """Whether any point of a surface may scatter light to single directions."""
    m = material.material
    if m.unlit or material.is_boundary:
        return False
    if m.weave is not None:
        return m.weave.has_gaps
    if m.clearcoat > 0 and _least_alpha(material, "clearcoat_roughness") < DELTA_ALPHA:
        return True
    alpha = _least_alpha(material, "perceptual_roughness")
    varies = any(use.roles & DATA_ROLES["anisotropy"] for use in material.data_maps)
    stretch = 0.0 if varies else m.anisotropy_strength**2
    if max(alpha, alpha + (1 - alpha) * stretch) < DELTA_ALPHA:
        return m.has_interface or material.transmits
    return material.transmits and not material.is_thin and alpha * abs(m.ior - 1) < DELTA_ALPHA * min(m.ior, 1.0)


def _least_alpha(material: TraceMaterial, parameter: str) -> float:
    """The least alpha of a surface whose roughness is `parameter`, with its map."""
    factor = float(getattr(material.material, parameter))
    name = _MAPS[parameter]
    for use in material.data_maps:
        if use.roles & DATA_ROLES[name]:
            channel = use.texture.image.decode("RGB")[..., 1]
            factor *= float(channel.min()) / np.iinfo(channel.dtype).max
    return factor * factor


_MAPS = {"perceptual_roughness": "metallic_roughness", "clearcoat_roughness": "clearcoat_roughness"}
"""The maps, in whose G these are."""


def _is_smooth_glass(geometry: TraceGeometry, instance: TraceInstance) -> bool:
    material = geometry.materials[instance.material].material
    is_glass = instance.kind == GLASS and not instance.is_pane
    return is_glass and material.perceptual_roughness == 0.0 and not ANISOTROPY.is_on(material)


@dataclass(frozen=True)
class Targets:
    """`count` boxes, each within a sphere about its middle: `low` and `high` are (count, 3), `radius` is (count,)."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    radius: NDArray[np.float64]

    @property
    def center(self) -> NDArray[np.float64]:
        return (self.low + self.high) / 2

    @property
    def corners(self) -> NDArray[np.float64]:
        """(count, 8, 3)"""
        choice = np.array(list(product((0, 1), repeat=3)), bool)
        return np.where(choice, self.high[:, None], self.low[:, None])

    def grouped(self, most: int) -> Targets:
        """At most `most` targets that hold these: they are halved along their longest extent, again and again."""
        count = len(self.radius)
        if count <= most:
            return self
        if most <= 1:
            low, high = self.low.min(axis=0), self.high.max(axis=0)
            return Targets(low[None], high[None], np.linalg.norm([high - low], axis=1) / 2 * _SLACK)
        order = np.argsort(self.center[:, int(np.ptp(self.center, axis=0).argmax())], kind="stable")
        halves = [Targets(self.low[part], self.high[part], self.radius[part]).grouped(most // 2)
                  for part in (order[:count // 2], order[count // 2:])]
        return Targets(np.concatenate([half.low for half in halves]), np.concatenate([half.high for half in halves]),
                       np.concatenate([half.radius for half in halves]))


def delta_targets(geometry: TraceGeometry) -> Targets:
    """The instances that have delta lobes, in tracer space."""
    has_delta = [has_delta_lobe(material) for material in geometry.materials]
    found = [_bounds(geometry, instance) for instance in geometry.instances if has_delta[instance.material]]
    return Targets(np.array([low for low, _, _ in found]).reshape(-1, 3),
                   np.array([high for _, high, _ in found]).reshape(-1, 3), np.array([r for _, _, r in found]))


def _bounds(geometry: TraceGeometry, instance: TraceInstance) -> tuple[NDArray, NDArray, float]:
    mesh = geometry.meshes[instance.mesh]
    used = mesh.positions[np.unique(mesh.triangles)].astype(np.float64)
    points = used @ instance.transform[:, :3].T + instance.transform[:, 3]
    low, high = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    return low, high, float(np.linalg.norm(points - (low + high) / 2, axis=1).max() + _MARGIN)


def photon_pairs(lit: Sequence[Light], scene: Scene, targets: Targets, radius: float,
                 ) -> tuple[NDArray[np.uint32], float]:
    """The pairs of each of N lights and each of T targets, (N T, 3, 4) uint32 in the order of the lights, as
    shaders/trace/emit.frag reads them, with medium 0; and u_photon_power. `radius` is that of lights, in tracer units.
    """
    columns = LightColumns.of(lit, scene)
    position, direction, far = columns.position, columns.direction, columns.is_far[:, None]
    towards = targets.center - position[:, None]  # (N, T, 3)
    distance = np.linalg.norm(towards, axis=2)
    to_center = np.where(distance[..., None] > 1e-30, towards / np.maximum(distance, 1e-30)[..., None], (0, 1, 0))
    height = np.minimum(_height_of_sphere(distance, targets.radius + radius),
                        _height_of_corners(targets.corners - position[:, None, None], to_center, radius))
    cone = np.broadcast_to((2 * np.sin(columns.angles[:, 1] / 2) ** 2)[:, None], height.shape)
    axis = np.where((cone < height)[..., None], direction[:, None], to_center)
    height = np.minimum(cone, height).astype(np.float32)
    from_axis = targets.corners - targets.center[:, None]
    from_axis = from_axis - (from_axis @ direction.T).transpose(2, 0, 1)[..., None] * direction[:, None, None]
    disk = np.minimum(np.linalg.norm(from_axis, axis=3).max(axis=2), targets.radius).astype(np.float32)

    texels = np.zeros((*height.shape, 3, 4), np.float32)
    texels[:, :, 1, :3] = np.where(far[..., None], targets.center, axis)
    texels[:, :, 1, 3] = np.where(far, disk, height)
    along = (towards * axis).sum(axis=2)
    texels[:, :, 2, :3] = position[:, None] + along[..., None] * axis
    texels[:, :, 2, 3] = np.where(far, 0, along)
    angle = np.where(far, np.pi * disk.astype(np.float64) ** 2, 2 * np.pi * height.astype(np.float64))
    power = (columns.intensity @ LUMINANCE)[:, None] * angle
    threshold, alias = alias_table(power.ravel())
    out = texels.reshape(-1, 3, 4).view(np.uint32)
    out[:, 0, 1], out[:, 0, 2] = threshold.astype(np.float32).view(np.uint32), alias
    return out, float(power.sum())


def _height_of_sphere(distance: NDArray, radius: NDArray) -> NDArray:
    """1 - cos of the half angle of the cone about a sphere; 2 within it, where all directions meet it."""
    sine2 = np.minimum(radius / np.maximum(distance, 1e-30), 1.0) ** 2
    return np.where(sine2 < 1, sine2 / (1 + np.sqrt(1 - sine2)), 2.0)


def _height_of_corners(corners: NDArray, axis: NDArray, radius: float) -> NDArray:
    """1 - cos of the half angle of the cone about an axis, (..., 3), that holds a box. `corners`, (..., 8, 3), are
    relative to the light. A cone of less than a right angle is convex, so it holds all of the box; 2 if there is none.

    Spheres of `radius` about the corners stand for lights of that radius.
    """
    distance = np.linalg.norm(corners, axis=-1)
    cosine = np.einsum("...ij,...j->...i", corners, axis) / np.maximum(distance, 1e-30)
    angle = 2 * np.arcsin(np.minimum(np.linalg.norm(
        corners / np.maximum(distance, 1e-30)[..., None] - axis[..., None, :], axis=-1) / 2, 1))
    angle = (angle + np.arcsin(np.minimum(radius / np.maximum(distance, 1e-30), 1))).max(axis=-1) * _SLACK
    is_narrow = (cosine > 0).all(axis=-1) & (angle < 1.5)
    return np.where(is_narrow, 2 * np.sin(angle / 2) ** 2, 2.0)


def _medium_at(geometry: TraceGeometry, scene: Scene, light: Light) -> int:
    """The number of the medium around a light; in scenes with scattering or nested solids, the nesting of media."""
    if light.kind == "directional" or not any(material.is_solid for material in geometry.materials):
        return 0
    around = [instance.medium for instance in
              solids_around(geometry, (np.asarray(light.position) - scene.center) / scene.radius)]
    if geometry.scatters or geometry.indices:
        return geometry.nesting.of(around)
    return around[-1] if around else 0
