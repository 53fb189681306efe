"""Tables by which rough surfaces send rays to where smooth bodies show them lamps (shaders/trace/caustic_guide.glsl).

A path that leaves a rough surface seldom meets a ball of metal or of glass just where that reflects or refracts it to a
lamp. What it brings then is so much that nearly all noise of a scene can come of it. So photons find before where the
light comes from (Jensen 1995, "Importance Driven Path Tracing using the Photon Map"). Their directions are counted
relative to the body, the caster, because they depend on where a surface lies around it, and not on where in the scene:
for each place around a caster in cells of the disk that it shows there. A share of a surface's samples follows these
counts, and the rest its BSDF; samples are weighed by the density of both together, so that there is no bias, whatever
the tables say.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from ...scene.environment import Environment
from ...scene.scene import Scene
from ...scene.unit_vectors import unit_vectors
from ...settings import Settings
from ..layout import GUIDE_CELLS, GUIDE_PLACES, GUIDE_STEPS
from ..rays.intersect import Intersector
from .alias import alias_table_of_mean_one, morton_order
from .caustic_rays import Caster, CausticRays, basis, casters_of, caustic_rays, optics, receives
from .geometry import TraceGeometry
from .lights import SceneLights
from .scene_buffer import SceneBufferBuilder

MOST_CASTERS = 4
_CANDIDATES = 16
_LARGEST = 0.6
"""The radius of a caster, at most: larger ones surround most of the scene."""
_LEAST_PHOTONS = 8
"""Photons that a place needs."""
MOST_SHARE = 0.25
"""Of a surface's samples that are guided. Below it, their share is that of the caster's light in all light."""
FLOOR = 0.1
"""Of the guided samples, those that are spread over the whole disk."""
_COPIES = 4
"""Each photon counts as so many, moved by about a place and a cell, so that few photons make no gaps."""


class CausticGuide:
    """Adds the sections `guide_casters`, `guide_places` and `guide_cells` to `buffer` if smooth bodies throw light on
    rough surfaces. `count` is the number of these casters, `uniforms` and `switches` are those of the shader.
    `previous` is the guide before this one: what it found is kept if it was of the same bodies and the same light.

    The triangles are those of `intersector`, if it is Embree's. There is no guide unless `is_wanted`, and none where
    `may_guide` says so. Raises InputError for an environment that cannot be decoded.
    """

    def __init__(self, scene: Scene, geometry: TraceGeometry, buffer: SceneBufferBuilder, lights: SceneLights,
                 intersector: Intersector | None = None, previous: CausticGuide | None = None,
                 is_wanted: bool = True) -> None:
        self._geometry, self._environment, self._emitters = geometry, _environment(scene, lights), lights.emitters
        self._optics = [optics(geometry, instance) for instance in geometry.instances]
        self._is_made = is_wanted and may_guide(scene, geometry, lights)
        self._found = _Found([], False)
        if self._is_made:
            self._found = (previous._found if previous is not None and self._is_as(previous)
                           else _find(scene, geometry, lights, intersector))
        self.tables = self._found.tables
        tables = self.tables
        self.count = len(tables)
        self.uniforms: dict[str, object] = {"u_guide_count": self.count}
        self.switches = {"HAS_CAUSTIC_GUIDE": int(self.count > 0)}
        if not tables:
            return
        spheres = [[*table.caster.center, table.caster.radius] for table in tables]
        buffer.add("guide_casters", np.array(spheres, np.float32))
        places = np.zeros((len(tables), GUIDE_PLACES**2, 4), np.uint32)
        cells, first = [], 0
        for k, table in enumerate(tables):
            lit = np.flatnonzero(table.shares)
            places[k, lit, 0] = first + GUIDE_CELLS**2 // 4 * np.arange(len(lit))
            places[k, lit, 1] = table.shares[lit].astype(np.float32).view(np.uint32)
            cells.append(_cells(table.weights[lit]))
            first += len(cells[-1])
        buffer.add("guide_places", places.reshape(-1, 4))
        buffer.add("guide_cells", np.concatenate(cells))

    def _is_as(self, other: CausticGuide) -> bool:
        """Whether both are of the same bodies and the same light, so that photons would find the same."""
        return (other._is_made and self._is_lit_as(other) and self._optics == other._optics
                and all(np.array_equal(a, b) for a, b in zip(self._emitters, other._emitters, strict=True))
                and self._geometry.has_triangles_of(other._geometry))

    def _is_lit_as(self, other: CausticGuide) -> bool:
        """Whether the environment is the same for photons. A turn is of no matter if it has no lamps."""
        a, b = self._environment, other._environment
        if a is None or b is None:
            return a is b
        return (a.source is b.source and a.intensity == b.intensity
                and (a.rotation == b.rotation or not other._found.follows_environment))


def guides(settings: Settings) -> bool:
    """Whether paths under these settings may get from one surface by way of another to a lamp, and show it."""
    return settings.bounces > 1 and settings.lobes == "all"


def may_guide(scene: Scene, geometry: TraceGeometry, lights: SceneLights) -> bool:
    """Whether photons would look for a guide: by materials, sizes and lights alone, so that it takes no time. Without
    Embree none would."""
    is_lit = _environment(scene, lights) is not None or bool(lights.emitters[1].any())
    return (is_lit and find_spec("embreex") is not None
            and any(receives(geometry, instance) for instance in geometry.instances)
            and bool(casters_of(geometry, _LARGEST, 1)))


def _environment(scene: Scene, lights: SceneLights) -> Environment | None:
    return scene.environment if lights.switches["HAS_ENVIRONMENT"] else None


@dataclass(frozen=True, eq=False)
class Table:
    """The light of a caster: the `weights` of the cells for each place (places, cells), and the `shares` (places,) of
    samples, 0 where no light was found."""

    caster: Caster
    weights: NDArray[np.float64]
    shares: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Found:
    """What photons found, and whether any of them came from an environment."""

    tables: list[Table]
    follows_environment: bool


def _find(scene: Scene, geometry: TraceGeometry, lights: SceneLights, intersector: Intersector | None) -> _Found:
    emitters, emitted = lights.emitters
    environment = _environment(scene, lights)
    casters = casters_of(geometry, _LARGEST, _CANDIDATES)
    triangles = getattr(intersector, "triangles", None)
    if triangles is None:
        from ..rays.embree_triangles import EmbreeTriangles

        triangles = EmbreeTriangles(geometry)
    rays = caustic_rays(scene, geometry, triangles, casters, emitters, emitted, environment)
    flux = np.bincount(rays.caster, rays.flux, len(casters))
    tables = [caster_table(casters[k], k, rays) for k in np.argsort(-flux, kind="stable")[:MOST_CASTERS]]
    return _Found([table for table in tables if table.shares.any()], rays.follows_environment)


def caster_table(caster: Caster, number: int, rays: CausticRays) -> Table:
    """Counts the rays of the caster with that number."""
    away = rays.point - caster.center
    distance = np.linalg.norm(away, axis=1)
    is_own = (rays.caster == number) & (distance > caster.radius)
    away, distance, direction = away[is_own] / distance[is_own, None], distance[is_own], rays.direction[is_own]
    flux, cosine = rays.flux[is_own], rays.cosine[is_own]
    rng, square = np.random.default_rng(2), square_of(caster.radius / distance, away, direction)
    weights, counts = np.zeros(GUIDE_PLACES**2 * GUIDE_CELLS**2), np.zeros(GUIDE_PLACES**2, np.int64)
    squares, cosines = np.zeros((2, GUIDE_PLACES**2))
    for _ in range(_COPIES):
        place = place_of(unit_vectors(away + rng.normal(0, 1 / GUIDE_PLACES, away.shape)))
        moved = (square + rng.normal(0, 0.5 / GUIDE_CELLS, square.shape)) * GUIDE_CELLS
        column, row = np.clip(moved.astype(np.int64), 0, GUIDE_CELLS - 1).T
        weights += np.bincount((place * GUIDE_CELLS + row) * GUIDE_CELLS + column, flux, len(weights))
        counts += np.bincount(place, minlength=len(counts))
        # The surface that a place shows has the area of its solid angle times distance^2 / cosine.
        squares += np.bincount(place, distance**2, len(counts))
        cosines += np.bincount(place, cosine, len(counts))
    weights = weights.reshape(len(counts), -1) / _COPIES
    area = 4 * np.pi / len(counts) * squares / np.maximum(cosines, 1e-30)
    irradiance = weights.sum(axis=1) / np.maximum(area, 1e-30)
    shares = np.minimum(irradiance / max(rays.mean, 1e-30), MOST_SHARE)
    shares[counts < _LEAST_PHOTONS * _COPIES] = 0.0
    return Table(caster, weights, shares)


def place_of(away: NDArray) -> NDArray[np.int64]:
    """The place of unit vectors from the middle of a caster, (N, 3)."""
    p = away[:, :2] / np.abs(away).sum(axis=1, keepdims=True)
    folded = (1 - np.abs(p[:, ::-1])) * np.where(p >= 0, 1.0, -1.0)
    column, row = np.clip((np.where(away[:, 2:] < 0, folded, p) * 0.5 + 0.5) * GUIDE_PLACES, 0, GUIDE_PLACES - 1).T
    return row.astype(np.int64) * GUIDE_PLACES + column.astype(np.int64)


def square_of(ratio: NDArray, away: NDArray, direction: NDArray) -> NDArray[np.float64]:
    """Where directions from a point to its caster lie in the square of cells, (N, 2) in [0, 1]. `ratio` is the radius
    of the caster over the distance to its middle, `away` the direction from there."""
    spread = ratio**2 / (1 + np.sqrt(1 - ratio**2))
    x, y = basis(-away)
    across = np.stack([(direction * x).sum(axis=1), (direction * y).sum(axis=1)], axis=1)
    disk = across / np.sqrt(spread * np.maximum(1 - (direction * away).sum(axis=1), 1e-7))[:, None]
    return np.clip(disk * 0.5 + 0.5, 0, 1)


def cells_on_disk() -> NDArray[np.bool_]:
    """Whether the disk touches each cell of its square, (cells,)."""
    nearest = np.maximum(np.abs(np.arange(GUIDE_CELLS) - (GUIDE_CELLS - 1) / 2) - 0.5, 0) * (2 / GUIDE_CELLS)
    return (np.hypot(*np.meshgrid(nearest, nearest)) < 1).ravel()


def _cells(weights: NDArray[np.float64]) -> NDArray[np.uint32]:
    """The alias tables of places with these weights of cells, one after the other, (places * cells / 4, 4).

    Shares are whole numbers of 1 / GUIDE_STEPS, so that thresholds are whole numbers, too, of `cells / GUIDE_STEPS`,
    and a cell has 32 bits: small tables stay in caches, and waiting for large ones was most of what a guide cost.
    """
    steps, cells, order = cell_steps(weights), GUIDE_CELLS**2, morton_order(GUIDE_CELLS, GUIDE_CELLS)
    # One table for all: each place has as much as it has cells, so that none gives or takes.
    mean = GUIDE_STEPS // cells
    table = alias_table_of_mean_one(steps[:, order].ravel() / mean)
    threshold, alias = (values.reshape(steps.shape) for values in table)
    whole = (threshold * mean).astype(np.uint32)
    other = np.where(whole < mean, order[alias % cells], order)
    packed = np.empty(steps.shape, np.uint32)
    packed[:, order] = np.minimum(whole, mean - 1) << 8 | other.astype(np.uint32)
    packed |= steps.astype(np.uint32) << np.uint32(16)
    return packed.reshape(-1, 4)


def cell_steps(weights: NDArray[np.float64]) -> NDArray[np.int64]:
    """The shares of samples of the cells of places with these weights, (places, cells), in units of 1 / GUIDE_STEPS."""
    on_disk = cells_on_disk()
    weights = weights * on_disk
    p = (1 - FLOOR) * weights / weights.sum(axis=1, keepdims=True) + FLOOR * on_disk / on_disk.sum()
    ends = np.round(np.cumsum(p, axis=1) * GUIDE_STEPS).astype(np.int64)
    ends[:, -1] = GUIDE_STEPS
    return np.diff(ends, axis=1, prepend=0)
