"""Distances in homogeneous media: against float64 from an optical depth of 1e-6 to 1e6, and by chi-squared."""

from __future__ import annotations

import media_twins as twins
import numpy as np
import pytest

from viewer import call_glsl
from viewer.measure.check.chi_squared import critical_value, statistic

FILE = "media/distance.glsl"
U = np.concatenate([np.arange(4) / 2**24, np.geomspace(1e-6, 0.5, 40), np.linspace(0.501, 0.999, 40),
                    1 - np.arange(3, 0, -1) / 2**24]).astype(np.float32).astype(float)
MEDIA = [((1.0, 3.0, 0.2), (0.2, 0.5, 0.3)), ((2.0, 2.0, 2.0), (1 / 3, 1 / 3, 1 / 3)),
         ((5.0, 0.0, 1.0), (0.5, 0.0, 0.5)), ((4.0, 0.5, 0.01), (1.0, 0.0, 0.0))]


def f32(values):
    return np.asarray(values, np.float32).astype(float)


def midpoints(count):
    return (np.arange(count) + 0.5) / count


@pytest.mark.parametrize(("function", "twin", "values"), [
    ("one_minus_exp(float)", lambda x: -np.expm1(-x), np.geomspace(1e-30, 1e6, 2000)),
    ("minus_log_one_minus", lambda x: -np.log1p(-x), np.concatenate([np.geomspace(1e-30, 0.5, 999), 1 - U[1:-3]])),
])
def test_functions_that_glsl_lacks(function, twin, values):
    """To 4 units in the last place; near the root of the logarithm, by the digits that x has."""
    values = f32(values[values < 1] if function.startswith("minus") else values)
    found = call_glsl("media/one_minus_exp.glsl", function, x=values)
    assert np.abs(found / twin(values) - 1).max() < 5e-7
    assert call_glsl("media/one_minus_exp.glsl", function, x=0.0) == 0


@pytest.mark.parametrize("tau", [1e-6, 1e-4, 0.01, 0.49, 0.51, 3.0, 60.0, 1e4, 1e6])
@pytest.mark.parametrize("limit", [1e-6, 1.0, 1e4])
def test_distance_below_a_limit(tau, limit):
    sigma = float(np.float32(tau / limit))
    limit = float(np.float32(limit))
    found = call_glsl(FILE, "bounded_distance", sigma_t=sigma, limit=limit, u=U).astype(float)
    expected = -np.log1p(U * np.expm1(-sigma * limit)) / sigma
    assert (found <= limit).all() and (np.diff(found) >= 0).all()
    error = np.abs(found - expected) / np.maximum(expected, 1e-30)
    error[expected > 10 / sigma] = 0  # 1 - u there has few digits, of which 1 - u (1 - exp(-tau)) rounds the last
    assert error.max() < 2e-6
    pdf = call_glsl(FILE, "bounded_distance_pdf", sigma_t=sigma, limit=limit, distance=found).astype(float)
    exact = sigma * np.exp(-sigma * found) / -np.expm1(-sigma * limit)
    assert (np.abs(pdf - exact) <= 2e-6 * (1 + sigma * found) * exact + 1e-37).all()


def test_no_medium_and_no_length():
    """Without extinction distances are uniform; free ones are endless, also for u = 0."""
    found = call_glsl(FILE, "bounded_distance", sigma_t=0.0, limit=2.0, u=U)
    assert np.allclose(found, 2 * U, rtol=1e-7)
    assert (call_glsl(FILE, "bounded_distance_pdf", sigma_t=0.0, limit=2.0, distance=found) == 0.5).all()
    free = call_glsl(FILE, "free_distance", sigma_t=np.zeros(3), chances=np.full(3, 1 / 3), u=U)
    assert (free > 1e38).all() and np.isfinite(free).all()


@pytest.mark.parametrize(("sigma_t", "chances"), MEDIA)
def test_free_distances_follow_their_density(sigma_t, chances):
    sigma, c = np.array(sigma_t), np.array(chances)
    draws = 1 << 16
    t = call_glsl(FILE, "free_distance", sigma_t=sigma, chances=c, u=np.random.default_rng(2).random(draws, np.float32))
    edges = np.append(np.concatenate([[0], np.geomspace(1e-3, 30, 40)]), np.inf)
    with np.errstate(invalid="ignore"):
        reached = np.array([(c * np.where(sigma > 0, np.exp(-sigma * e), 1)).sum() for e in edges[:-1]] + [0.0])
    counts = np.histogram(t, np.append(edges[:-1], 3.4e38))[0]
    chi2, degrees = statistic(counts.astype(float), -np.diff(reached) * draws)
    assert chi2 < critical_value(degrees, len(MEDIA))


@pytest.mark.parametrize(("sigma_t", "chances"), MEDIA)
def test_weights_give_the_light_of_each_channel(sigma_t, chances):
    """The mean weight of collisions before a distance is 1 - exp(-tau), that of the paths that pass exp(-tau)."""
    sigma, c, limit = np.array(sigma_t), np.array(chances), 0.7
    t = call_glsl(FILE, "free_distance", sigma_t=sigma, chances=c, u=midpoints(1 << 16)).astype(float)
    collides = t < limit
    at = np.where(collides, t, 0.1)
    weight = np.where(collides[:, None], call_glsl(FILE, "collision_weight", sigma_t=sigma, chances=c, distance=at), 0)
    passed = call_glsl(FILE, "passing_weight", sigma_t=sigma, chances=c, distance=limit)
    lit = c > 0
    assert np.allclose(weight.mean(axis=0)[lit], -np.expm1(-sigma * limit)[lit], atol=2e-4)
    assert np.allclose(((~collides).mean() * passed)[lit], np.exp(-sigma * limit)[lit], atol=2e-4)
    assert np.isfinite(weight).all() and np.isfinite(passed).all()


def test_weights_at_every_depth():
    """Finite from an optical depth of 1e-6 to 1e6, 1 where the channels are equal, and never above 1 / chance."""
    d = np.geomspace(1e-6, 1e6, 40)
    third = np.full(3, 1 / 3)
    for name in ("collision_weight", "passing_weight"):
        equal = call_glsl(FILE, name, sigma_t=np.ones(3), chances=third, distance=d)
        assert np.allclose(equal, 1, atol=1e-6), name
        for sigma in ([1.0, 2.0, 1e-6], [1e6, 1.0, 0.0], [1e-6, 1e-5, 1e-6]):
            weight = call_glsl(FILE, name, sigma_t=np.array(sigma), chances=third, distance=d)
            assert np.isfinite(weight).all() and weight.min() >= 0 and weight.max() <= 3 * (1 + 1e-6), (name, sigma)


def test_chances_are_those_of_the_throughput():
    found = call_glsl(FILE, "channel_chances", throughput=np.array([[1, 2, 1], [0, 0, 3], [0, 0, 0], [1e-30, 0, 0]]))
    assert np.allclose(found, [[0.25, 0.5, 0.25], [0, 0, 1], [1 / 3] * 3, [1, 0, 0]])


RAYS = [(d, a, limit) for limit in (1e-3, 1.0, 1e4) for d in (1e-4, 0.1, 1.0, 1e3)
        for a in (-1e3, -1.0, -0.5, 0.0, 10.0)]


def ray(closest, start, limit):
    """A ray of `limit` along y from the origin, and a light: relative to the limit."""
    light = np.array([closest * limit, -start * limit, 0.0])
    return {"origin": np.zeros(3), "direction": np.array([0.0, 1, 0]), "limit": limit, "light": light}


def sampled(given, u):
    e = call_glsl("media/equiangular.glsl", "equiangular", **given)
    e = {name: float(value) for name, value in e.items()}
    t = call_glsl("media/equiangular.glsl", "equiangular_sample", e=e, limit=given["limit"], u=u)
    return e, t.astype(float), call_glsl("media/equiangular.glsl", "equiangular_pdf", e=e, distance=t).astype(float)


@pytest.mark.parametrize(("closest", "start", "limit"), RAYS)
def test_equiangular_against_float64(closest, start, limit):
    u, limit = f32(np.linspace(0, 1, 101)), float(np.float32(limit))
    _, t, pdf = sampled(ray(closest, start, limit), u)
    expected, density = twins.equiangular(closest * limit, start * limit, limit, u)
    assert (t >= 0).all() and (t <= limit).all() and np.isfinite(pdf).all()
    # Mesa has atan, sin and cos to a few 1e-6; an error of the angle moves a point by 1 / density times as much.
    assert (np.abs(t - expected) < 2e-6 * limit + 4e-6 / density).all()
    angle = np.arctan2(closest, closest**2 + start * (start + 1))
    exact = closest * limit / (angle * ((closest * limit) ** 2 + (start * limit + t) ** 2))
    assert np.abs(pdf / exact - 1).max() < 1e-5


@pytest.mark.parametrize(("closest", "start", "limit"), [(0.1, -0.5, 1.0), (1.0, 10.0, 1.0), (1e-3, -0.3, 4.0)])
def test_equiangular_density_is_normalised_and_sampled(closest, start, limit):
    draws = 1 << 16
    e, t, _ = sampled(ray(closest, start, limit), np.random.default_rng(5).random(draws, np.float32))
    edges, _ = twins.equiangular(closest * limit, start * limit, limit, np.linspace(0, 1, 65))
    edges[[0, -1]] = 0, limit * (1 + 1e-6)
    s, weight = np.polynomial.legendre.leggauss(32)
    x = edges[:-1, None] + np.diff(edges)[:, None] * (s + 1) / 2
    pdf = call_glsl("media/equiangular.glsl", "equiangular_pdf", e=e, distance=x).astype(float)
    shares = (pdf * weight).sum(axis=1) * np.diff(edges) / 2
    assert shares.sum() == pytest.approx(1, abs=1e-4)
    chi2, degrees = statistic(np.histogram(t, edges)[0].astype(float), shares * draws)
    assert chi2 < critical_value(degrees, 3)


def test_light_on_the_ray():
    """No density exists there; samples stay finite and on the ray, with the light before, on and behind it."""
    u = np.linspace(0, 1, 65)
    for start in (-2.0, -1.0, -0.5, 0.0, 1.0):
        _, t, pdf = sampled(ray(0.0, start, 1.0), u)
        assert np.isfinite(t).all() and np.isfinite(pdf).all() and (pdf > 0).all() and (t >= 0).all() and (t <= 1).all()


def airlight(given, sigma):
    """What an isotropic medium scatters along the ray of a point light of intensity 4 pi, without its sigma_s."""
    s, weight = np.polynomial.legendre.leggauss(400)
    e = np.linalg.norm(given["light"] - np.multiply.outer((s + 1) / 2 * given["limit"], given["direction"]), axis=-1)
    t = (s + 1) / 2 * given["limit"]
    return (np.exp(-sigma * (t + e)) / e**2 * weight).sum() * given["limit"] / 2


@pytest.mark.parametrize("sigma", [0.01, 1.0, 20.0])
def test_equiangular_and_free_distances_combined(sigma):
    """In-scattering by both techniques equals quadrature. Each is weighed by the square of its density."""
    given, count = ray(0.2, -0.4, 1.5), 1 << 14
    u = midpoints(count)
    e, t_e, _ = sampled(given, u)
    t_f = call_glsl(FILE, "free_distance", sigma_t=np.full(3, sigma), chances=np.full(3, 1 / 3), u=u).astype(float)

    def contribution(t, is_equiangular):
        d = np.linalg.norm(given["light"] - np.multiply.outer(t, given["direction"]), axis=-1)
        p_e = call_glsl("media/equiangular.glsl", "equiangular_pdf", e=e, distance=t).astype(float)
        p_f = sigma * np.exp(-sigma * t)
        p, q = (p_e, p_f) if is_equiangular else (p_f, p_e)
        f = np.exp(-sigma * (t + d)) / d**2
        return np.where(t < given["limit"], f * p / (p**2 + q**2), 0)

    found = contribution(t_e, True).mean() + contribution(t_f, False).mean()
    assert found == pytest.approx(airlight(given, sigma), rel=2e-3)
