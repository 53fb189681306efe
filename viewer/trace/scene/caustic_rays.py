"""Rays of light that smooth bodies throw on rough surfaces, by photons on the CPU.

They only say where caustics come from (caustic_guide.py) and need not be exact: colours, films, coats and attenuation
are left out, and so are lights without size.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...scene.color import LUMINANCE
from ...scene.environment import Environment
from ...scene.equirect import texel_solid_angles
from ...scene.scene import Scene
from ...scene.transform import normal_matrix
from ...scene.unit_vectors import unit_vectors
from ..kinds import GLASS, SURFACE
from .geometry import TraceGeometry, TraceInstance

if TYPE_CHECKING:
    from ..rays.embree_triangles import EmbreeTriangles

PHOTONS = 1 << 15
"""From the environment, and as many from emissive triangles."""
SMOOTH = 0.1
"""The greatest alpha of a surface that is taken for smooth."""
MOST_BOUNCES = 8
_STEP = 1e-5
"""From a surface to the beginning of the next ray, in tracer units."""
_FAR = 4.0
"""From a caster to where rays of the environment begin: outside of the scene."""


@dataclass(frozen=True, eq=False)
class Caster:
    """A smooth body: the number of its instance, and a sphere about it in tracer space."""

    instance: int
    center: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class CausticRays:
    """N rays: the number of the `caster` that each comes from (N,), the `point` that it meets and the `direction` back
    along it, (N, 3) in tracer space, the `cosine` there to the normal, and its `flux`, both (N,).

    `mean` is about the irradiance of a surface by all lights. `follows_environment`: photons came from an environment.
    """

    caster: NDArray[np.int64]
    point: NDArray[np.float64]
    direction: NDArray[np.float64]
    cosine: NDArray[np.float64]
    flux: NDArray[np.float64]
    mean: float
    follows_environment: bool


def is_smooth(geometry: TraceGeometry, instance: TraceInstance) -> bool:
    """Whether all of it is solid glass or metal that is nearly a mirror."""
    material = geometry.materials[instance.material]
    m = material.material
    if material.data_maps or m.unlit or m.perceptual_roughness**2 > SMOOTH:
        return False
    is_glass = instance.kind == GLASS and not material.is_thin and m.transmission > 0.5
    return is_glass or (instance.kind == SURFACE and m.metallic > 0.5)


def receives(geometry: TraceGeometry, instance: TraceInstance) -> bool:
    """Whether paths go on from there by the guide: from what scatters light to all sides."""
    is_lit = not geometry.materials[instance.material].material.unlit
    return instance.kind == SURFACE and is_lit and not is_smooth(geometry, instance)


def optics(geometry: TraceGeometry, instance: TraceInstance) -> tuple[object, ...]:
    """What photons know of a body, beside its triangles and its kind."""
    material = geometry.materials[instance.material].material
    bends = (material.perceptual_roughness, material.ior) if is_smooth(geometry, instance) else ()
    return receives(geometry, instance), material.double_sided, bends


def casters_of(geometry: TraceGeometry, largest: float, most: int) -> list[Caster]:
    """The `most` largest smooth bodies with a radius up to `largest`."""
    found = []
    for number, instance in enumerate(geometry.instances):
        if not is_smooth(geometry, instance):
            continue
        mesh = geometry.meshes[instance.mesh]
        corners = mesh.positions.astype(np.float64) @ instance.transform[:, :3].T + instance.transform[:, 3]
        center = (corners.min(axis=0) + corners.max(axis=0)) / 2
        radius = float(np.sqrt(((corners - center) ** 2).sum(axis=1).max()))
        if 0 < radius <= largest:
            found.append(Caster(number, center, radius))
    return sorted(found, key=lambda caster: -caster.radius)[:most]


def caustic_rays(scene: Scene, geometry: TraceGeometry, triangles: EmbreeTriangles, casters: Sequence[Caster],
                 emitters: NDArray[np.uint32], emitted: NDArray[np.float64], environment: Environment | None,
                 ) -> CausticRays:
    """`emitters` and `emitted` are the records and powers of the emissive triangles (emitters.py). Raises InputError
    for an environment that cannot be decoded."""
    rng = np.random.default_rng(1)
    photons, mean = _Photons.none(), 0.0
    if emitted.any():
        photons = photons.joined(_from_emitters(geometry, casters, emitters, emitted, rng))
        mean += emitted.sum() / (4 * np.pi)  # over the surface of the unit ball
    if environment is not None:
        radiance = environment.radiance @ LUMINANCE.astype(np.float32) * environment.intensity
        photons = photons.joined(_from_environment(radiance, environment.rotation, casters, rng))
        mean += np.pi * _mean(radiance)
    follows = environment is not None and len(photons.flux) > PHOTONS * bool(emitted.any())
    caster, point, direction, cosine, flux = _traced(scene, geometry, triangles, casters, photons, rng)
    return CausticRays(caster, point, direction, cosine, flux, mean, follows)


@dataclass(frozen=True, eq=False)
class _Photons:
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    flux: NDArray[np.float64]

    @staticmethod
    def none() -> _Photons:
        return _Photons(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))

    def joined(self, other: _Photons) -> _Photons:
        return _Photons(np.concatenate([self.origin, other.origin]), np.concatenate([self.direction, other.direction]),
                        np.concatenate([self.flux, other.flux]))


def _targets(casters: Sequence[Caster], rng: np.random.Generator) -> tuple[NDArray, NDArray, NDArray]:
    """For each photon the centre and the radius of a caster, in proportion to its disk, and the probability."""
    radius = np.array([caster.radius for caster in casters])
    share = radius**2 / (radius**2).sum()
    chosen = rng.choice(len(casters), PHOTONS, p=share)
    return np.array([caster.center for caster in casters])[chosen], radius[chosen], share[chosen]


def _mean(radiance: NDArray) -> float:
    return float((radiance * texel_solid_angles(*radiance.shape)[:, None]).sum() / (4 * np.pi))


def _from_environment(radiance: NDArray, rotation: float, casters: Sequence[Caster], rng: np.random.Generator,
                      ) -> _Photons:
    """Photons of what is brighter than the mean, since other directions find the rest. `radiance` is (H, W)."""
    height, width = radiance.shape
    weights = np.maximum(radiance - _mean(radiance), 0.0) * texel_solid_angles(height, width)[:, None]
    sums = np.cumsum(weights, dtype=np.float64)
    if not sums[-1] > 0:
        return _Photons.none()
    texel = np.minimum(np.searchsorted(sums, rng.random(PHOTONS) * sums[-1], side="right"), len(sums) - 1)
    row, column = np.divmod(texel, width)
    phi = 2 * np.pi * ((column + rng.random(PHOTONS)) / width - 0.5) - rotation
    theta = np.pi * (row + rng.random(PHOTONS)) / height
    light = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=1)
    center, radius, share = _targets(casters, rng)
    x, y = basis(light)
    disk = _disk(rng) * radius[:, None]
    origin = center + disk[:, :1] * x + disk[:, 1:] * y + _FAR * light
    return _Photons(origin, -light, sums[-1] * np.pi * radius**2 / share / PHOTONS)


def _from_emitters(geometry: TraceGeometry, casters: Sequence[Caster], emitters: NDArray[np.uint32],
                   emitted: NDArray[np.float64], rng: np.random.Generator) -> _Photons:
    power = emitted / emitted.max()  # the sum of huge powers must not overflow
    chosen = emitters[rng.choice(len(emitted), PHOTONS, p=power / power.sum())]
    corners, is_double_sided = np.empty((PHOTONS, 3, 3)), np.zeros(PHOTONS, bool)
    for number in np.unique(chosen[:, 0]):
        rows, instance = chosen[:, 0] == number, geometry.instances[number]
        mesh = geometry.meshes[instance.mesh]
        placed = mesh.positions[mesh.triangles[chosen[rows, 1]]] @ instance.transform[:, :3].T
        placed += instance.transform[:, 3]
        corners[rows] = placed[:, ::-1] if instance.is_mirrored else placed
        is_double_sided[rows] = geometry.materials[instance.material].material.double_sided
    u, v = rng.random((2, PHOTONS, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    edges = corners[:, 1:] - corners[:, :1]
    origin = corners[:, 0] + u * edges[:, 0] + v * edges[:, 1]
    center, radius, share = _targets(casters, rng)
    to = center - origin
    ratio = np.minimum(radius**2 / np.maximum((to**2).sum(axis=1), 1e-30), 1.0)
    spread = ratio / (1 + np.sqrt(1 - ratio))  # 1 - cosine of the cone
    disk, axis = _disk(rng), unit_vectors(to)
    rise = spread * (disk**2).sum(axis=1)
    disk *= np.sqrt(spread * (2 - rise))[:, None]
    x, y = basis(axis)
    direction = disk[:, :1] * x + disk[:, 1:] * y + (1 - rise)[:, None] * axis
    cosine = (direction * unit_vectors(np.cross(edges[:, 0], edges[:, 1]))).sum(axis=1)
    cosine = np.where(is_double_sided, np.abs(cosine), np.maximum(cosine, 0.0))
    # A power is pi times area and radiance, of both sides together.
    flux = emitted.sum() / np.pi / (1 + is_double_sided) * cosine * 2 * np.pi * spread / share / PHOTONS
    return _Photons(origin + _STEP * direction, direction, flux)


def _traced(scene: Scene, geometry: TraceGeometry, triangles: EmbreeTriangles, casters: Sequence[Caster],
            photons: _Photons, rng: np.random.Generator) -> Iterator[NDArray]:
    """Follows photons from caster to caster, until they meet a rough surface: the arrays of `CausticRays`."""
    caster_of = np.full(len(geometry.instances), -1)
    caster_of[[caster.instance for caster in casters]] = np.arange(len(casters))
    is_receiver = np.array([receives(geometry, instance) for instance in geometry.instances])
    origin, direction, flux = photons.origin, photons.direction, photons.flux
    last = np.full(len(origin), -1)
    landed = []
    for _ in range(MOST_BOUNCES):
        found = triangles.intersect(origin.astype(np.float32), direction.astype(np.float32))
        rows = np.flatnonzero((found["primID"] >= 0) & (flux > 0))
        instance, triangle = triangles.places(found["primID"][rows])
        found = {name: found[name][rows].astype(np.float64) for name in ("u", "v", "tfar", "Ng")}
        direction, flux, last = direction[rows], flux[rows], last[rows]
        origin = origin[rows] + found["tfar"][:, None] * direction
        normal = unit_vectors(found["Ng"])
        ends = is_receiver[instance] & (last >= 0)
        cosine = np.abs((normal[ends] * direction[ends]).sum(axis=1))
        landed.append((last[ends], origin[ends], -direction[ends], cosine, flux[ends]))
        on = caster_of[instance] >= 0
        instance, triangle, flux = instance[on], triangle[on], flux[on]
        origin, direction, normal = origin[on], direction[on], normal[on]
        if not len(instance):
            break
        last = caster_of[instance]
        at = np.stack([1 - found["u"][on] - found["v"][on], found["u"][on], found["v"][on]], axis=1)
        direction = _scattered(scene, geometry, instance, triangle, at, normal, direction, rng)
        origin = origin + _STEP * direction
    return (np.concatenate(parts) for parts in zip(*landed, strict=True))


def _scattered(scene: Scene, geometry: TraceGeometry, instance: NDArray, triangle: NDArray, barycentric: NDArray,
               normal: NDArray, direction: NDArray, rng: np.random.Generator) -> NDArray[np.float64]:
    """Directions after a reflection or a refraction; `normal` are geometric ones, (N, 3)."""
    count, n = len(instance), normal.copy()
    alpha, ior, is_glass = np.empty(count), np.ones(count), np.zeros(count, bool)
    for number in np.unique(instance):
        of, placed = instance == number, geometry.instances[number]
        mesh, material = geometry.meshes[placed.mesh], geometry.materials[placed.material].material
        alpha[of], ior[of] = material.perceptual_roughness**2, max(material.ior, 1.0)
        is_glass[of] = placed.kind == GLASS
        normals = scene.meshes[mesh.source].normals
        if normals is not None:
            smooth = np.einsum("nk,nkc->nc", barycentric[of], normals[mesh.triangles[triangle[of]]])
            n[of] = unit_vectors(smooth @ normal_matrix(scene.instances[placed.source].transform).T)
    is_inside = (normal * direction).sum(axis=1) > 0
    n = np.where(is_inside[:, None], -n, n)
    # Facets with the density of GGX: Walter et al. 2007, "Microfacet Models for Refraction", equation 35
    u, phi = rng.random((2, count))
    cosine = 1 / np.sqrt(1 + alpha**2 * u / (1 - u))
    x, y = basis(n)
    sine, phi = np.sqrt(1 - cosine**2), 2 * np.pi * phi
    h = (sine * np.cos(phi))[:, None] * x + (sine * np.sin(phi))[:, None] * y + cosine[:, None] * n
    c = -(h * direction).sum(axis=1)
    eta = np.where(is_inside, ior, 1 / ior)  # the index on the side of the ray over that on the other
    squared = 1 - eta**2 * (1 - c**2)
    t = np.sqrt(np.maximum(squared, 0.0))
    s, p = (eta * c - t) / np.maximum(eta * c + t, 1e-30), (c - eta * t) / np.maximum(c + eta * t, 1e-30)
    passes = is_glass & (squared > 0) & (rng.random(count) >= 0.5 * (s**2 + p**2))
    refracted = eta[:, None] * direction + (eta * c - t)[:, None] * h
    return unit_vectors(np.where(passes[:, None], refracted, direction + 2 * c[:, None] * h))


def _disk(rng: np.random.Generator) -> NDArray[np.float64]:
    """Uniform points of the unit disk, (PHOTONS, 2)."""
    r, phi = np.sqrt(rng.random(PHOTONS)), 2 * np.pi * rng.random(PHOTONS)
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)


def basis(n: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The two vectors beside unit vectors (N, 3) that shaders/sample/orthonormal_basis.glsl has."""
    x, y, z = n.T
    s = np.where(z < 0, -1.0, 1.0)
    a = -1.0 / (s + z)
    return (np.stack([1 + s * x * x * a, s * x * y * a, -s * x], axis=1),
            np.stack([x * y * a, s + y * y * a, -y], axis=1))
