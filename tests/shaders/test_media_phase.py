"""Phase functions: against float64, normalised, and sampled as they say."""

from __future__ import annotations

import media_twins as twins
import numpy as np
import pytest

from viewer import call_glsl
from viewer.measure.check.chi_squared import critical_value, statistic

G = np.array([0.0, 1e-7, 1e-6, 1e-3, 0.3, 0.7, 0.9, 0.99])
SIGNED_G = np.unique(np.concatenate([-G, G]))
DIAMETERS = np.array([5.0, 8.0, 15.0, 50.0])
AXIS = np.array([0.36, -0.48, 0.8])
DRAWS = 1 << 17


def f32(values):
    return np.asarray(values, np.float32).astype(float)


def nodes(g: float):
    """Gauss-Legendre nodes and weights of 1 - mu over [0, 2], dense where 1 - mu is about (1 - g)^2."""
    width = np.log((2 + (1 - g) ** 2) / (1 - g) ** 2)
    s, weight = np.polynomial.legendre.leggauss(200)
    x = (1 - g) ** 2 * np.expm1(width * (s + 1) / 2)
    return x, weight * width / 2 * (x + (1 - g) ** 2)


def turned(one_minus_mu):
    """Unit vectors at these angles from the x axis, in float32: pairs (before, after)."""
    angle = 2 * np.arcsin(np.sqrt(np.asarray(one_minus_mu) / 2))
    after = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    return np.broadcast_to([1.0, 0, 0], after.shape), f32(after)


def one_minus_cosine(before, after):
    """1 - mu of the rounded vectors, which keeps the digits of small angles."""
    unit = after / np.linalg.norm(after, axis=-1, keepdims=True)
    return ((before - unit) ** 2).sum(axis=-1) / 2


def test_henyey_greenstein_against_float64():
    g, x = np.meshgrid(f32(SIGNED_G), np.concatenate([[0], np.geomspace(1e-9, 2, 60)]), indexing="ij")
    before, after = turned(x)
    found = call_glsl("media/phase.glsl", "phase_between", g=g, before=before, after=after)
    forth, back = one_minus_cosine(before, after), one_minus_cosine(-before, after)
    expected = twins.henyey_greenstein(np.abs(g), np.where(g < 0, back, forth))
    assert np.abs(found / expected - 1).max() < 3e-6
    mu = f32(1 - x)
    by_cosine = call_glsl("media/phase.glsl", "phase_eval", g=g, mu=mu)
    expected = twins.henyey_greenstein(np.abs(g), np.where(g < 0, 1 + mu, 1 - mu))
    assert np.abs(by_cosine / expected - 1).max() < 3e-6


@pytest.mark.parametrize("g", SIGNED_G)
def test_henyey_greenstein_is_normalised_and_has_the_mean_cosine_g(g):
    x, weight = nodes(abs(g))
    before, after = turned(x)
    if g < 0:  # the peak is where light turns back
        before = -before
    p = call_glsl("media/phase.glsl", "phase_between", g=g, before=before, after=after)
    assert 2 * np.pi * (p * weight).sum() == pytest.approx(1, abs=2e-6)
    mean = 2 * np.pi * (p * weight * (1 - x)).sum()
    assert mean * (1 if g >= 0 else -1) == pytest.approx(g, abs=3e-6)


def test_henyey_greenstein_sampling_inverts_the_distribution():
    """1 - mu to a few units in the last place, at the smallest g and in the sharpest peak."""
    u = f32(np.concatenate([np.arange(8) / 2**24, np.linspace(0.01, 0.99, 99), 1 - np.arange(1, 9) / 2**24]))
    for g in f32(G):
        drawn = call_glsl("media/phase.glsl", "phase_sample", g=g, direction=np.array([1.0, 0, 0]),
                          u=np.stack([u, 0.1 + 0 * u], axis=-1)).astype(float)
        found, expected = one_minus_cosine(np.array([1.0, 0, 0]), drawn), twins.henyey_greenstein_one_minus_mu(g, u)
        assert np.abs(found - expected).max() < 2e-6
        near = expected < 0.1
        assert np.abs(found / expected - 1)[near].max() < 2e-5  # of float32 directions, at angles down to 3e-6


def histogram_is(drawn, one_minus_mu_edges, shares, tests):
    """Whether directions about AXIS fall into the rings between the edges, each cut into 8 turns, by the shares."""
    x = one_minus_cosine(AXIS, drawn.astype(float))
    side = np.cross(AXIS, [0, 0, 1.0])
    side /= np.linalg.norm(side)
    turn = np.arctan2(drawn @ np.cross(AXIS, side), drawn @ side)
    counts = np.histogram2d(x, turn, [one_minus_mu_edges, np.linspace(-np.pi, np.pi, 9)])[0]
    expected = np.repeat(shares[:, None] / 8, 8, axis=1) * len(drawn)
    chi2, degrees = statistic(counts.ravel(), expected.ravel())
    return chi2 < critical_value(degrees, tests)


def ring_shares(density, edges, g):
    """The integrals of a density of 1 - mu over the rings, by 40 nodes in each."""
    s, weight = np.polynomial.legendre.leggauss(40)
    low, high = edges[:-1, None] + (1 - g) ** 2, edges[1:, None] + (1 - g) ** 2  # in logarithms, for the peak
    y = low * (high / low) ** ((s + 1) / 2)
    return 2 * np.pi * (density(y - (1 - g) ** 2) * y * weight * np.log(high / low) / 2).sum(axis=1)


@pytest.mark.parametrize("g", SIGNED_G)
def test_henyey_greenstein_samples_follow_it(g):
    drawn = call_glsl("media/phase.glsl", "phase_sample", g=g, direction=AXIS,
                      u=np.random.default_rng(3).random((DRAWS, 2), np.float32))
    assert np.abs(np.linalg.norm(drawn, axis=-1) - 1).max() < 1e-6
    edges = twins.henyey_greenstein_one_minus_mu(abs(g), np.linspace(1, 0, 33))
    edges[[0, -1]] = 0, 2 + 1e-6
    shares = ring_shares(lambda x: twins.henyey_greenstein(abs(g), x), edges, abs(g))
    assert shares.sum() == pytest.approx(1, abs=1e-5)
    assert histogram_is(drawn if g >= 0 else -drawn, edges, shares, 2 * len(G))


@pytest.mark.parametrize("diameter", DIAMETERS)
def test_droplets(diameter):
    """The fit's lobes: against float64, normalised, and sampled as they say, at each diameter."""
    m = call_glsl("media/droplets.glsl", "droplets", diameter=diameter)
    assert [float(m[name]) for name in ("g", "g_wide", "a", "share")] == pytest.approx(twins.droplets(diameter), 3e-6)
    given = {name: float(value) for name, value in m.items()}
    x, weight = nodes(given["g"])
    before, after = turned(x)
    found = call_glsl("media/droplets.glsl", "droplets_between", m=given, before=before, after=after)
    exact = one_minus_cosine(before, after)
    expected = ((1 - given["share"]) * twins.henyey_greenstein(given["g"], exact)
                + given["share"] * twins.draine(given["g_wide"], given["a"], exact))
    assert np.abs(found / expected - 1).max() < 5e-6
    assert 2 * np.pi * (found * weight).sum() == pytest.approx(1, abs=1e-5)

    drawn = call_glsl("media/droplets.glsl", "droplets_sample", m=given, direction=AXIS,
                      u=np.random.default_rng(4).random((DRAWS, 2), np.float32))
    edges = np.concatenate([[0], np.geomspace((1 - given["g"]) ** 2 / 4, 2, 31)])
    edges[-1] += 1e-6
    shares = ring_shares(lambda y: twins.droplet_phase(diameter, y), edges, given["g"])
    assert histogram_is(drawn, edges, shares, len(DIAMETERS))


def test_draine_sampling_inverts_the_distribution():
    m = {"g": 0.9, "g_wide": 0.6, "a": 30.0, "share": 0.5}
    u = (np.arange(200) + 0.5) / 200
    found = call_glsl("media/droplets.glsl", "draine_sample", m=m, u=u).astype(float)
    s, weight = np.polynomial.legendre.leggauss(64)
    x = found[:, None] * (s + 1) / 2
    reached = 2 * np.pi * (twins.draine(0.6, 30.0, x) * weight).sum(axis=1) * found / 2
    assert np.abs(reached - u).max() < 2e-6


def test_wrong_parameters_are_noticed():
    """The histogram of a peak that is a tenth too wide does not pass."""
    drawn = call_glsl("media/phase.glsl", "phase_sample", g=0.9 * 0.99, direction=AXIS,
                      u=np.random.default_rng(3).random((DRAWS, 2), np.float32))
    edges = twins.henyey_greenstein_one_minus_mu(0.9, np.linspace(1, 0, 33))
    edges[[0, -1]] = 0, 2 + 1e-6
    shares = ring_shares(lambda x: twins.henyey_greenstein(0.9, x), edges, 0.9)
    assert not histogram_is(drawn, edges, shares, 1)
