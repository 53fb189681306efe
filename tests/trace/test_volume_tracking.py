"""Volumes in the path tracer's shaders: densities, majorants, free distances and transmittance, against float64."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from harness import evaluate

from viewer.gpu.programs import set_uniform
from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.scene.medium import Medium
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.trace.scene.scene_buffer import SceneBufferBuilder
from viewer.trace.scene.volumes import VolumeGrids, cell_size, majorants

UNIT_SCENE = 14
RAYS = 12


def random_density(shape, dtype=np.float32, seed=1):
    """Mostly empty and otherwise rough, so that majorants differ."""
    rng = np.random.default_rng(seed)
    density = rng.random(shape) ** 3 * (rng.random(shape) < 0.6)
    density[: shape[0] // 2, : shape[1] // 2] *= 0.05
    return density.astype(dtype)


def affine(seed=3):
    """Rotated, sheared, mirrored and far from the origin."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.random.default_rng(seed).normal(size=(3, 3)) * 0.2
    matrix[:3, 3] = 40, -30, 20
    return matrix


def trilinear(volume: Volume, world: np.ndarray) -> np.ndarray:
    """Densities at points (N, 3), in float64."""
    shape = np.array(volume.density.shape[::-1])
    index = (world - volume.index_to_world[:3, 3]) @ np.linalg.inv(volume.index_to_world[:3, :3]).T
    is_inside = ((index >= -0.5) & (index <= shape - 0.5)).all(axis=1)
    index = np.clip(index, 0, shape - 1)
    low = np.minimum(index.astype(int), np.maximum(shape - 2, 0))
    part, total = index - low, 0.0
    for corner in np.ndindex(2, 2, 2):
        at = np.minimum(low + corner, shape - 1)
        weight = np.where(corner, part, 1 - part).prod(axis=1)
        total = total + weight * volume.density[at[:, 2], at[:, 1], at[:, 0]].astype(float)
    return np.where(is_inside, total, 0)


@dataclass
class Shown:
    """A volume on the device, and rays through it."""

    context: object
    folder: Path
    scene: Scene
    extinction: float

    @property
    def volume(self) -> Volume:
        return self.scene.volumes[0]

    def to_tracer(self, world):
        return (world - self.scene.center) / self.scene.radius

    def run(self, body, rows, outputs=1):
        grids = VolumeGrids(self.context.gl, self.scene)
        buffer = SceneBufferBuilder()
        buffer.add("other", np.zeros((5, 4), np.uint32))
        buffer.add("volumes", grids.records(self.scene, Medium((self.extinction,) * 3)))
        texture = buffer.texture(self.context)

        def bind(program):
            grids.use_textures()
            grids.set_uniforms(program)
            texture.bind(program, "u_scene", UNIT_SCENE)
            set_uniform(program, "u_volumes", 5)

        found = evaluate(self.context, self.folder, "media/tracking.glsl", body, rows, outputs, bind=bind)
        texture.release()
        grids.release()
        return found

    def rays(self, count=RAYS, seed=5):
        """Origins, unit directions and limits in tracer units: some begin inside, some miss, one goes along an axis."""
        rng = np.random.default_rng(seed)
        corners = self.to_tracer(self.volume.corners)
        inside = rng.dirichlet(np.ones(8), count) @ corners
        direction = rng.normal(size=(count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        origin = inside - direction * rng.choice([0.0, 0.05, 3.0], count)[:, None]
        direction[0] = [0, 0, -1]
        limit = rng.choice([0.1, 0.7, 6.0], count)
        return [np.asarray(a, np.float32).astype(float) for a in (origin, direction, limit)]

    def optical_depth(self, origin, direction, limit, steps=20000):
        """Along one ray at `steps` + 1 distances, by the trapezoidal rule in float64."""
        t = np.linspace(0, limit, steps + 1)
        world = (origin + t[:, None] * direction) * self.scene.radius + self.scene.center
        rate = trilinear(self.volume, world) * self.extinction * self.scene.radius
        return t, np.append(0, np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(t)))


def shown(context, folder, density, extinction=1.0, matrix=None):
    volume = Volume("smoke", density, affine() if matrix is None else matrix)
    return Shown(context, folder, Scene("smoke", volumes=(volume,)), extinction)


@pytest.fixture
def make(context, tmp_path):
    return partial(shown, context, tmp_path)


def many(values, count):
    return [np.repeat(np.asarray(v, float), count, axis=0) for v in values]


def counters(count, seed=9):
    return np.random.default_rng(seed).integers(0, 1 << 32, count, np.uint64).astype(np.uint32)


def rows_of(origin, direction, limit, seed=9):
    """Rows for `evaluate`: origin, limit; direction, u; counter."""
    count = len(origin)
    rows = np.zeros((count, 12), np.float32)
    rows[:, :3], rows[:, 3], rows[:, 4:7] = origin, limit, direction
    rows[:, 7] = np.random.default_rng(seed).random(count, np.float32)
    rows.view(np.uint32)[:, 8] = counters(count, seed)
    return rows


COLLISION = "uint c = i2.x; o0.x = volume_collision(volume_at(0), f0.xyz, f1.xyz, f0.w, f1.w, c); " \
            "o0.y = float(tracking_faults);"
TRANSMITTANCE = "uint c = i2.x; o0.x = volume_transmittance(volume_at(0), f0.xyz, f1.xyz, f0.w, c); " \
                "o0.y = float(tracking_faults);"
MEAN_DENSITY = """Volume v = volume_at(0); Walk w; o0 = vec4(-1.0);
    if (enter(v, f0.xyz, vec3(0.0, 1.0, 0.0), 1.0, w)) {
        o0 = vec4(0.0, w.majorant, 0.0, 0.0);
        for (int i = 0; i < 64; ++i) {
            float sum = 0.0;
            for (int k = 0; k < 64; ++k) {
                float density = random_density_at(v, point_of(w), (float(64 * i + k) + 0.5) / 4096.0);
                sum += density;
                o0.z = max(o0.z, density);
            }
            o0.x += sum / 4096.0;
        }
    }"""
"""The mean density at a point, the majorant there and the greatest density."""
SHAPES = [(9, 14, 21), (21, 9, 14), (1, 1, 1), (1, 30, 2), (70, 5, 5)]


@pytest.mark.parametrize("shape", [*SHAPES, (5, 130, 300)])
def test_majorants_hold_for_all_that_is_interpolated(shape):
    density = random_density(shape)
    for size in (1, 4, 7):
        found = majorants(density, size)
        assert found.shape == tuple(-(-n // size) for n in shape)
        for cell in list(np.ndindex(found.shape))[:: max(found.size // 200, 1)]:
            lows = [max(c * size - 1, 0) for c in cell]
            part = density[tuple(slice(low, (c + 1) * size + 1) for low, c in zip(lows, cell, strict=True))]
            assert found[cell] == part.max()
    assert max(majorants(density, cell_size(density)).shape) <= 64


@pytest.mark.parametrize("dtype", [np.float32, np.float16])
@pytest.mark.parametrize("shape", SHAPES)
def test_mean_density_is_trilinear_and_axes_are_not_mixed_up(make, shape, dtype):
    smoke = make(random_density(shape, dtype))
    rng = np.random.default_rng(2)
    index = rng.uniform(-0.5, np.array(shape[::-1]) - 0.5, (400, 3))
    world = index @ smoke.volume.index_to_world[:3, :3].T + smoke.volume.index_to_world[:3, 3]
    point = np.zeros((400, 8), np.float32)
    point[:, :3] = smoke.to_tracer(world)
    exact = trilinear(smoke.volume, world)
    found = smoke.run(MEAN_DENSITY, point)[:, 0]
    assert (found[:, 0] >= 0).mean() > 0.97  # but for points that rounding puts outside
    ok = found[:, 0] >= 0
    assert np.abs(found[:, 0] - exact)[ok].max() < 3e-4 * max(1, max(shape) / 20)  # float32 positions
    assert (found[ok, 1] >= found[ok, 2]).all()


@pytest.mark.parametrize(("shape", "extinction"), [(SHAPES[0], 0.8), (SHAPES[1], 3.0), (SHAPES[3], 6.0),
                                                   (SHAPES[4], 1.0), ((1, 1, 1), 2.0)])
def test_transmittance_is_that_of_marching(make, shape, extinction):
    """Both estimates, for rays that begin inside, outside and far away, that miss, and that end inside."""
    smoke = make(random_density(shape) if shape != (1, 1, 1) else np.ones(shape, np.float32), extinction)
    origin, direction, limit = smoke.rays()
    each = 1 << 13
    exact = np.array([np.exp(-smoke.optical_depth(*ray)[1][-1]) for ray in zip(origin, direction, limit)])
    rows = rows_of(*many((origin, direction, limit), each))
    for body, is_ratio in ((TRANSMITTANCE, True), (COLLISION, False)):
        found = smoke.run(body, rows)[:, 0]
        assert (found[:, 1] == 0).all()
        passed = found[:, 0] if is_ratio else (found[:, 0] > 1e38).astype(float)
        passed = passed.reshape(RAYS, each)
        spread = np.maximum(passed.std(axis=1) / np.sqrt(each), 1e-4)
        assert (np.abs(passed.mean(axis=1) - exact) < 4.5 * spread).all()
    assert np.ptp(exact) > 0.1  # of rays that pass all, and that pass little


def test_free_distances_follow_the_extinction(make):
    """By chi-squared: a histogram along each ray against differences of the transmittance."""
    smoke = make(random_density((9, 14, 21)), 1.5)
    origin, direction, limit = smoke.rays()
    each = 1 << 13
    found = smoke.run(COLLISION, rows_of(*many((origin, direction, limit), each)))[:, 0, 0].reshape(RAYS, each)
    results = []
    for ray, distances in zip(zip(origin, direction, limit), found, strict=True):
        t, depth = smoke.optical_depth(*ray)
        edges = np.linspace(0, ray[2], 33)
        passes = np.exp(-np.interp(edges, t, depth))
        expected = np.append(-np.diff(passes), passes[-1]) * each
        counts = np.histogram(distances, np.append(edges, 3.4e38))[0].astype(float)
        results.append(statistic(counts, expected))
    assert max(chi2 / critical_value(degrees, RAYS) for chi2, degrees in results) < 1


def uniform_slab(make, tau, scale):
    """A box of 3 x 4 x 5 voxels of density 1, with an optical depth `tau` through it along x, at any scale."""
    matrix = np.diag([0.5 * scale, 0.3 * scale, 0.4 * scale, 1.0])
    return make(np.ones((5, 4, 3), np.float32), tau / (1.5 * scale), matrix)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_optical_depths_from_1e_6_to_1e4(make, scale):
    each = 1 << 15
    for tau in (0.0, 1e-6, 1e-3, 1.0, 30.0, 1e4):
        slab = uniform_slab(make, tau, scale)
        middle = slab.to_tracer(np.array([0.5, 0.45, 0.8]) * scale)
        origin, direction = np.tile(middle - [3, 0, 0], (each, 1)), np.tile([1.0, 0, 0], (each, 1))
        rows = rows_of(origin, direction, np.full(each, 3e38))
        rows[:, 7] = (np.arange(each) + 0.5) / each
        transmittance = slab.run(TRANSMITTANCE, rows)[:, 0]
        collision = slab.run(COLLISION, rows)[:, 0]
        assert (transmittance[:, 1] == 0).all() and (collision[:, 1] == 0).all()
        assert np.isfinite(transmittance).all() and np.isfinite(collision).all()
        error = 5 * max(transmittance[:, 0].std(), np.sqrt(min(tau, 1)) * 0.1) / np.sqrt(each)
        assert transmittance[:, 0].mean() == pytest.approx(np.exp(-tau), abs=error)
        collides = collision[:, 0] < 1e38
        # Without density differences every collision is real, and the stratified u decides alone.
        assert collides.mean() == pytest.approx(-np.expm1(-tau), abs=1.1 / each)
        if tau >= 1:
            depth = (collision[collides, 0] - (3 - 0.75 * scale / slab.scene.radius)) * tau / (1.5 * scale)
            expected = -np.log1p(-rows[collides, 7].astype(float))
            assert np.abs(depth * slab.scene.radius - expected).max() < 2e-6 * tau + 1e-5


def test_empty_grid_lets_all_light_through(make):
    nothing = make(np.zeros((3, 4, 5), np.float32), 5.0)
    origin, direction, limit = nothing.rays()
    rows = rows_of(*many((origin, direction, limit), 16))
    assert (nothing.run(TRANSMITTANCE, rows)[:, 0] == [1, 0, 0, 0]).all()
    assert (nothing.run(COLLISION, rows)[:, 0, 0] > 1e38).all()


def test_densities_above_the_majorant_are_counted(make, monkeypatch):
    """What never happens is noticed if it does."""
    monkeypatch.setattr("viewer.trace.scene.volumes.majorants", lambda density, size: majorants(density, size) * 0.3)
    smoke = make(random_density((9, 14, 21)), 10.0)
    rows = rows_of(*many(smoke.rays(), 64))
    assert smoke.run(COLLISION, rows)[:, 0, 1].sum() > 0
    assert smoke.run(TRANSMITTANCE, rows)[:, 0, 1].sum() > 0


def test_rays_along_faces_and_edges_stay_finite(make):
    """Directions with zeros, origins on the faces of the box and of cells, and beyond the box."""
    slab = uniform_slab(make, 2.0, 1.0)
    corners = slab.to_tracer(slab.volume.corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    places = np.array(np.meshgrid(*np.linspace(low, high, 5).T, indexing="ij")).reshape(3, -1).T
    axes = np.concatenate([np.eye(3), -np.eye(3), [[0.6, 0.8, 0], [0, -0.6, 0.8]]])
    origin, direction = np.repeat(places, len(axes), axis=0), np.tile(axes, (len(places), 1))
    found = [slab.run(body, rows_of(origin, direction, np.full(len(origin), 3e38)))[:, 0]
             for body in (TRANSMITTANCE, COLLISION)]
    assert np.isfinite(found).all() and (found[0][:, 0] >= 0).all() and (found[0][:, 0] <= 1).all()
    assert all((f[:, 1] == 0).all() for f in found)
