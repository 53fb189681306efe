"""The environment as a light: samples, densities and estimates, compared with float64."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate

from viewer.gpu.programs import set_uniform
from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_solid_angles
from viewer.trace.scene import environment as module
from viewer.trace.scene.environment import EnvironmentTable, cell_densities

RANDOM = np.random.default_rng(11)


def sun_map(height: int = 16, width: int = 32) -> np.ndarray:
    radiance = RANDOM.uniform(0, 1, (height, width, 3)).astype(np.float32)
    radiance[height // 4, width // 3] = 1e5
    radiance[-3:] = 0
    return radiance


def poles_map() -> np.ndarray:
    radiance = np.full((8, 16, 3), 0.01, np.float32)
    radiance[0], radiance[-1, 3] = 50, 200
    return radiance


MAPS = {
    "one texel": np.full((1, 1, 3), 2.0, np.float32),
    "constant": np.full((8, 16, 3), 0.5, np.float32),
    "sun": sun_map(),
    "poles": poles_map(),
    "odd": RANDOM.exponential(size=(7, 5, 3)).astype(np.float32) ** 4,
    "half dark": np.repeat(np.array([0, 1], np.float32), 4)[:, None, None] * np.ones((1, 16, 3), np.float32),
}
CASES = [(name, angle) for name in MAPS for angle in (0.0, 1.1)]


class Sampled:
    """`environment` on the GPU. `samples` gives directions (N, 3) and pdf (N,), `look` radiance (N, 3) and pdf (N,)."""

    def __init__(self, context, folder, radiance: np.ndarray, angle: float = 0.0, intensity: float = 1.0) -> None:
        self.context, self.folder = context, folder
        self.table = EnvironmentTable(context, Environment("map", radiance, angle, intensity), radiance)
        self.switches = {"HAS_ENVIRONMENT": 1, "ENVIRONMENT_ROTATED": int(angle != 0)}

    def bind(self, program) -> None:
        self.table.use_textures()
        self.table.set_uniforms(program)
        set_uniform(program, "u_environment_share", 1.0)

    def run(self, body: str, inputs: np.ndarray) -> np.ndarray:
        inputs = inputs.astype(np.float32)
        return evaluate(self.context, self.folder, "trace/environment.glsl", body, inputs, 1, self.switches,
                        self.bind)[:, 0]

    def samples(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = self.run("float pdf; o0.xyz = sample_environment(f0.xyz, pdf); o0.w = pdf;", u)
        return found[:, :3], found[:, 3]

    def look(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = self.run("vec3 d = normalize(f0.xyz); o0 = vec4(environment_radiance(d), environment_pdf(d));", d)
        return found[:, :3], found[:, 3]


def numbers(count: int, seed: int = 1) -> np.ndarray:
    """(count, 3) multiples of 2^-24 in [0, 1)."""
    return np.random.default_rng(seed).integers(0, 1 << 24, (count, 3)) / 2**24


def turned(d: np.ndarray, angle: float) -> np.ndarray:
    """Rotates directions from the world to the map."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * d[:, 0] - s * d[:, 2], d[:, 1], s * d[:, 0] + c * d[:, 2]], axis=1)


def bilinear(radiance: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(N, 3) float64: the bilinear look-up in directions of the map's frame, wrapped in u and clamped in v."""
    height, width = radiance.shape[:2]
    x = (0.5 + np.arctan2(d[:, 2], d[:, 0]) / (2 * np.pi)) * width - 0.5
    y = np.arctan2(np.hypot(d[:, 0], d[:, 2]), d[:, 1]) / np.pi * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - column)[:, None], (y - row)[:, None]
    rows = np.clip([row, row + 1], 0, height - 1)
    columns = np.array([column, column + 1]) % width
    texels = radiance.astype(np.float64)
    top, bottom = ((1 - fx) * texels[r, columns[0]] + fx * texels[r, columns[1]] for r in rows)
    return (1 - fy) * top + fy * bottom


def sphere_points(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Midpoints of an equirectangular grid (2 n^2, 3) and their solid angles."""
    theta = np.pi * (np.arange(n) + 0.5) / n
    phi = 2 * np.pi * ((np.arange(2 * n) + 0.5) / (2 * n) - 0.5)
    d = np.stack([np.sin(theta)[:, None] * np.cos(phi), np.cos(theta)[:, None] + 0 * phi,
                  np.sin(theta)[:, None] * np.sin(phi)], axis=-1)
    return d.reshape(-1, 3), np.repeat(texel_solid_angles(n, 2 * n), 2 * n)


@pytest.mark.parametrize(("name", "angle"), CASES)
def test_radiance_is_the_bilinear_map(context, tmp_path, name, angle):
    """The radiance is right to 1e-5 of the map's brightest texel, also at the seam and the poles."""
    edges = [[0, 1, 0], [0, -1, 0], [-1, 0, 0], [-1, 0, 1e-9]]
    d = np.concatenate([np.random.default_rng(4).normal(size=(3000, 3)), edges])
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    found, _ = Sampled(context, tmp_path, MAPS[name], angle, 0.5).look(d)
    expected = 0.5 * bilinear(MAPS[name], turned(d.astype(np.float32).astype(np.float64), angle))
    assert np.abs(found - expected).max() < 1e-5 * MAPS[name].max()


@pytest.mark.parametrize("name", MAPS)
def test_samples_have_their_density(context, tmp_path, name):
    """environment_pdf of a sample's direction is the sample's pdf, except for 1 in 1000 at the edges of cells."""
    for angle in (0.0, 2.5):
        sampled = Sampled(context, tmp_path, MAPS[name], angle)
        d, pdf = sampled.samples(numbers(20000))
        assert np.abs(np.linalg.norm(d, axis=1) - 1).max() < 1e-6
        again = sampled.look(d)[1]
        assert (np.abs(again / pdf - 1) > 1e-6).mean() < 1e-3
        assert (pdf > 0).all()


def test_stratified_points_stay_so(context, tmp_path):
    """Of 1024 points, one in each of 32 x 32 parts of the square of the first two numbers, the 64 parts of a light get
    what is theirs: Pearson's statistic over their number is below 0.2, where it is 1 for random points."""
    radiance = np.zeros((64, 128, 3), np.float32)
    light = np.s_[24:40, 80:96]
    radiance[light] = 1
    rng = np.random.default_rng(5)
    square = (np.indices((32, 32)).reshape(2, -1).T + rng.uniform(size=(1024, 2))) / 32
    d, _ = Sampled(context, tmp_path, radiance).samples(np.c_[square, rng.uniform(size=1024)])
    column = (0.5 + np.arctan2(d[:, 2], d[:, 0]) / (2 * np.pi)) * 128 - 80
    row = np.arccos(d[:, 1]) / np.pi * 64 - 24
    inside = (column > 0) & (column < 16) & (row > 0) & (row < 16)
    observed = np.bincount((row[inside] // 2 * 8 + column[inside] // 2).astype(int), minlength=64)
    densities, solid_angles = cell_densities(radiance)
    expected = 1024 * (densities * solid_angles)[light].reshape(8, 2, 8, 2).sum(axis=(1, 3)).ravel()
    assert ((observed - expected) ** 2 / expected).sum() / 64 < 0.2


@pytest.mark.parametrize(("name", "angle"), CASES)
def test_density(context, tmp_path, name, angle):
    """The density integrates to 1 over the sphere and is positive wherever the map is not black."""
    sampled = Sampled(context, tmp_path, MAPS[name], angle)
    points, solid_angles = sphere_points(560)  # a multiple of all the maps' sides
    to_world = turned(points, -angle)
    radiance, pdf = sampled.look(to_world)
    assert (pdf * solid_angles).sum() == pytest.approx(1, abs=2e-4)
    assert (pdf[radiance.sum(axis=1) > 0] > 0).all()


@pytest.mark.parametrize(("name", "angle"), CASES)
def test_histogram(context, tmp_path, name, angle):
    """Pearson's test over quarters of cells, whose expected shares follow from their solid angles."""
    sampled = Sampled(context, tmp_path, MAPS[name], angle)
    d = turned(sampled.samples(numbers(200000))[0], angle)
    densities, _ = cell_densities(MAPS[name])
    height, width = densities.shape
    column = ((0.5 + np.arctan2(d[:, 2], d[:, 0]) / (2 * np.pi)) * 2 * width).astype(int) % (2 * width)
    row = np.minimum(np.arccos(np.clip(d[:, 1], -1, 1)) / np.pi * 2 * height, 2 * height - 1).astype(int)
    observed = np.bincount(row * 2 * width + column, minlength=4 * width * height)
    expected = np.repeat(np.repeat(densities, 2, axis=0), 2, axis=1)
    expected *= texel_solid_angles(2 * height, 2 * width)[:, None]
    assert expected.sum() == pytest.approx(1, abs=1e-12)
    value, degrees = statistic(observed, expected.ravel() * len(d))
    assert value < critical_value(degrees, len(CASES))


@pytest.mark.parametrize("name", MAPS)
def test_irradiance(context, tmp_path, name):
    """Light samples estimate the irradiance of planes to within 4.5 standard deviations of quadrature in float64."""
    angle = 0.8
    sampled = Sampled(context, tmp_path, MAPS[name], angle)
    d, pdf = sampled.samples(numbers(400000))
    radiance, _ = sampled.look(d)
    points, solid_angles = sphere_points(560)
    exact = bilinear(MAPS[name], points)
    for normal in np.array([[0, 1, 0], [0.6, 0, -0.8], [0, -0.6, 0.8]]):
        estimates = radiance[:, 1] * np.maximum(d @ normal, 0) / pdf
        error = estimates.std() / np.sqrt(len(d))
        expected = (exact[:, 1] * np.maximum(turned(points, -angle) @ normal, 0) * solid_angles).sum()
        assert error <= 0.3 * expected
        assert abs(estimates.mean() - expected) < 4.5 * error + 1e-3 * expected


@pytest.mark.parametrize("pole", [0, -1])
def test_a_bright_row_at_a_pole_is_interpolated_towards_its_neighbour(context, tmp_path, pole):
    """Between the centres of the first two rows, at h/2 and 3h/2 from the pole, the light falls linearly. For small h
    that is (1/4 + 5/6) pi h^2 instead of the pi h^2 of the texels alone."""
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[pole] = 1
    sampled = Sampled(context, tmp_path, radiance)
    d, pdf = sampled.samples(numbers(100000))
    light = (sampled.look(d)[0][:, 0] / pdf).mean()
    assert light / (128 * texel_solid_angles(64, 128)[pole]) == pytest.approx(13 / 12, rel=5e-3)


def test_sun_is_chosen():
    """A texel of 1e5 in a map of 1 gets nearly all samples. The others keep the density of the floor."""
    densities, solid_angles = cell_densities(sun_map(64, 128))
    shares = densities * solid_angles
    assert shares[15:18, 41:44].sum() > 0.99
    assert (shares[:50] > 0).all() and (shares[-2:] == 0).all()


def test_compensation():
    """The density of uniform light is a tenth of what it would be without MIS compensation."""
    radiance = np.full((32, 64, 3), 1.0, np.float32)
    radiance[8, 20] = 1000
    densities, solid_angles = cell_densities(radiance)
    mean = 1 + 999 * solid_angles[8, 20] / (4 * np.pi)
    # The mean of the bilinear look-up over the sun's texel is 9/16 of its peak.
    expected = 0.1 / (1 + 999 * 9 / 16 - mean)
    assert densities[30, 5] / densities[8, 20] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("limit", [(16, 4), (5, 3), (1, 1)])
def test_large_map_in_blocks(context, tmp_path, monkeypatch, limit):
    """For cells of several texels, cut off at the edges, densities integrate to 1 and samples follow them."""
    monkeypatch.setattr(module, "MAX_CELLS", limit)
    radiance = sun_map(14, 20)
    sampled = Sampled(context, tmp_path, radiance)
    points, solid_angles = sphere_points(560)
    light, pdf = sampled.look(points)
    assert (pdf * solid_angles).sum() == pytest.approx(1, abs=2e-4)
    assert (pdf[light.sum(axis=1) > 0] > 0).all()
    d, pdf = sampled.samples(numbers(100000))
    light, again = sampled.look(d)
    assert (np.abs(again / pdf - 1) > 1e-6).mean() < 1e-3
    estimates = light[:, 0] / pdf
    expected = (bilinear(radiance, points)[:, 0] * solid_angles).sum()
    assert abs(estimates.mean() - expected) < 4.5 * estimates.std() / np.sqrt(len(d)) + 1e-3 * expected
