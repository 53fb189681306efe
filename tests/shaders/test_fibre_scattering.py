"""Fibres: against float64, all light accounted for, and sampled as they say, down to the ends of every parameter."""

from __future__ import annotations

import fibre_twin as twin
import numpy as np
import pytest
from contexts import is_software

from viewer import call_glsl
from viewer.measure.check.chi_squared import critical_value, statistic

FILE = "bsdf/fibre/fibre.glsl"
BETA = (0.0, 1e-3, 0.02, 0.1, 0.3, 0.7, 1.0)
OFFSETS = (0.0, 0.3, -0.8, 0.999, 1.0, -1.0)


def f32(values):
    return np.asarray(values, np.float32).astype(float)


def fibre(**parameters):
    """A white fibre, with `parameters` in place of its own."""
    m = {"sigma_a": 0.0, "beta_m": 0.3, "beta_n": 0.3, "tilt": np.radians(2), "eta": 1.55, **parameters}
    return {name: f32(value) for name, value in m.items()}


def direction(theta, phi):
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta), np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi)], axis=-1)


def random_directions(rng, count):
    w = rng.normal(size=(count, 3))
    return f32(w / np.linalg.norm(w, axis=-1, keepdims=True))


def random_fibres(rng, count, narrowest=0.05):
    return fibre(sigma_a=rng.exponential(1, (count, 3)), beta_m=rng.uniform(narrowest, 1, count),
                 beta_n=rng.uniform(narrowest, 1, count), tilt=rng.uniform(-0.2, 0.2, count),
                 eta=rng.uniform(1.05, 2.4, count))


def draw(m, h, wo, u):
    return call_glsl(FILE, "fibre_sample", f=m, h=h, wo=wo, u=u)


def test_against_float64():
    """At directions that the lobes reach, which their samples find, and at any others."""
    rng = np.random.default_rng(1)
    count = 20_000
    m, wo, h = random_fibres(rng, count), random_directions(rng, count), f32(rng.uniform(-0.999, 0.999, count))
    drawn = draw(m, h, wo, rng.random((count, 4), np.float32))
    wi = np.where(rng.random((count, 1)) < 0.7, drawn["wi"], random_directions(rng, count)).astype(float)
    found, expected = call_glsl(FILE, "fibre_eval", f=m, h=h, wo=wo, wi=wi), twin.evaluate(m, h, wo, wi)
    error = np.abs(found - expected) / np.maximum(expected, 1e-3)
    assert error.max() < 5e-3 and np.quantile(error, 0.999) < 3e-4  # of angles in float32, over the narrowest width
    albedo = call_glsl(FILE, "fibre_albedo", f=m, h=h, wo=wo)
    assert np.abs(albedo - twin.albedo(m, h, wo)).max() < 3e-6
    pdf = call_glsl(FILE, "fibre_pdf", f=m, h=h, wo=wo, wi=wi)
    chance = twin.attenuation(m, h, twin.angles(wo)[0])[0].max(axis=-1)
    expected_pdf = (chance / chance.sum(axis=0) * twin.densities(m, h, wo, wi)).sum(axis=0)
    assert np.quantile(np.abs(pdf - expected_pdf) / np.maximum(expected_pdf, 1e-3), 0.999) < 3e-4


def test_offset_is_that_of_the_ray():
    """The sine of the angle at which the ray meets the circle; with it a smooth fibre mirrors wo at the normal."""
    rng = np.random.default_rng(2)
    normal = direction(0, rng.uniform(0, 2 * np.pi, 500))
    wo = random_directions(rng, 500)
    wo *= np.sign((wo * normal).sum(axis=-1, keepdims=True))
    h = call_glsl(FILE, "fibre_offset", normal=normal, wo=wo)
    aside = np.linalg.norm(np.cross(normal, wo * [0, 1, 1]), axis=-1) / np.hypot(wo[:, 1], wo[:, 2])
    assert np.abs(np.abs(h) - aside).max() < 1e-6
    mirrored = 2 * (wo * normal).sum(axis=-1, keepdims=True) * normal - wo
    smooth = fibre(beta_m=0.02, beta_n=0.02, tilt=0.0, sigma_a=1e6)
    at, beside = (call_glsl(FILE, "fibre_eval", f=smooth, h=sign * h, wo=wo, wi=mirrored)[:, 0] for sign in (1, -1))
    drawn = draw(smooth, h, wo, np.full((500, 4), [0.5, 0.999, 0.3, 0.5]))
    assert np.abs(drawn["wi"] - mirrored).max() < 2e-3
    clear = (np.abs(h) > 0.1) & (np.abs(h) < 0.98)  # else both signs turn the light to about the same side
    assert (at[clear] > 1e3 * beside[clear]).all()


@pytest.mark.parametrize("beta_m", BETA)
def test_longitudinal_integrates_to_1_and_is_sampled_by_its_inverse(beta_m):
    """M cos theta over theta, with nodes about the peak; and the distribution of the angle to the mean direction."""
    variance = float(call_glsl(FILE, "fibre_variance", beta_m=beta_m))
    assert variance == pytest.approx(max(twin.variances(np.float64(beta_m))[0], 4e-6), rel=1e-5)
    node, weight = np.polynomial.legendre.leggauss(300)
    for v in f32(variance * np.array([0.25, 1, 4])):
        for mean in (0.0, 0.5, -1.4, np.pi / 2 - 1e-3, np.pi / 2):
            peak = f32([np.cos(mean), np.sin(mean)])
            low, high = np.clip([mean - 12 * np.sqrt(v), mean + 12 * np.sqrt(v)], -np.pi / 2, np.pi / 2)
            theta, step = (low + high) / 2 + (high - low) / 2 * node, (high - low) / 2 * weight
            t = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
            M = call_glsl(FILE, "longitudinal", theta=t, mean=peak, v=v)
            assert (M * np.cos(theta) * step).sum() == pytest.approx(1, abs=2e-4 if v < 1e-4 else 1e-5)
        u = f32(np.concatenate([np.arange(1, 8) / 2**24, np.linspace(0.01, 0.99, 99), 1 - np.arange(1, 9) / 2**24]))
        drawn = call_glsl(FILE, "longitudinal_sample", mean=np.array([1.0, 0]), v=v, u=np.stack([u, 0 * u], -1))
        expected = -v * np.log1p((1 - u) * np.expm1(-2 / v))  # 1 - cos of the angle, all of which is along the fibre
        angle = np.arctan2(drawn[:, 1].astype(float), drawn[:, 0])
        assert np.abs(2 * np.sin(np.abs(angle) / 2) ** 2 - np.minimum(expected, 2 - expected)).max() < 3e-6 * max(v, 1)


@pytest.mark.parametrize("beta_n", BETA)
def test_azimuthal_integrates_to_1_and_is_sampled_by_its_inverse(beta_n):
    s = float(call_glsl(FILE, "fibre_scale", beta_n=beta_n))
    assert s == pytest.approx(max(twin.scale(beta_n), 1e-3), rel=1e-5)
    node, weight = np.polynomial.legendre.leggauss(200)
    edge = min(40 * s, np.pi)
    x = edge * (node + 1) / 2
    N = call_glsl(FILE, "azimuthal", angle=np.stack([np.cos(x), np.sin(x)], axis=-1), s=s)
    assert (N * weight).sum() * edge == pytest.approx(1, abs=1e-5 + 3e-7 / s)
    assert np.abs(N / twin.azimuthal(x, s) - 1)[x < 10 * s].max() < 2e-5 + 1e-6 / s
    u = f32(np.concatenate([np.arange(8) / 2**24, np.linspace(0.01, 0.99, 98), 1 - np.arange(1, 9) / 2**24]))
    drawn = call_glsl(FILE, "azimuthal_sample", s=s, u=u)
    found = np.arctan2(drawn[:, 1].astype(float), drawn[:, 0])
    t = np.longdouble(np.tanh(np.longdouble(np.pi) / (2 * s)))
    with np.errstate(divide="ignore"):
        expected = np.clip(2 * s * np.arctanh((2 * np.longdouble(u) - 1) * t), -np.pi, np.pi)
    gap = (found - expected + np.pi) % (2 * np.pi) - np.pi  # -pi and pi are one angle
    beyond = np.abs(u - 0.5) > 0.49  # where float32 has few numbers before 0 and 1
    bound = (1e-6 if is_software() else 5e-6) * max(s, 1)
    assert np.abs(gap[~beyond]).max() < bound
    assert np.abs(gap).max() < bound + (np.pi if s < 0.03 else 0)


@pytest.mark.parametrize("eta", [1.0, 1.0001, 1.55, 3.0])
def test_white_furnace(eta):
    """What absorbs nothing returns all: as the lobe says itself, for every offset, inclination and tilt; by its
    samples, of every roughness; and by quadrature over the sphere for what is rough enough."""
    h, theta, tilt = np.meshgrid(OFFSETS, [0, 0.5, -1.2, 1.57, np.pi / 2], [0, 0.05, -0.3], indexing="ij")
    wo = f32(direction(theta, 0.7))
    albedo = call_glsl(FILE, "fibre_albedo", f=fibre(tilt=tilt, eta=eta), h=h, wo=wo)
    assert np.abs(albedo - 1).max() < 2e-6
    u = np.random.default_rng(3).random((*h.shape, 4), np.float32)
    for beta in BETA:
        drawn = draw(fibre(tilt=tilt, eta=eta, beta_m=beta, beta_n=beta), h, wo, u)
        kept = drawn["pdf"] > 0
        assert kept.mean() > 0.95 and np.abs(drawn["return"][kept] - 1).max() < 1e-5
    node, weight = np.polynomial.legendre.leggauss(160)
    sine, phi = np.meshgrid(node, np.arange(160) / 160 * 2 * np.pi, indexing="ij")
    wi = direction(np.arcsin(sine), phi).reshape(-1, 3)
    area = np.repeat(weight * 2 * np.pi / 160, 160)
    for beta_m, beta_n in ((0.3, 0.3), (1.0, 0.3), (0.3, 1.0)):
        pick = (slice(None, None, 2), slice(None, None, 2), 2)
        m = fibre(beta_m=beta_m, beta_n=beta_n, tilt=tilt[pick][..., None], eta=eta)
        f = call_glsl(FILE, "fibre_eval", f=m, h=h[pick][..., None], wo=wo[pick][..., None, :], wi=wi)[..., 0]
        assert np.abs((f * area).sum(axis=-1) - 1).max() < 2e-4


@pytest.mark.parametrize(("beta_m", "beta_n"), [(0.2, 0.3), (0.3, 1.0), (1.0, 0.2), (0.6, 0.6)])
def test_samples_follow_pdf(beta_m, beta_n):
    """By chi-squared at 1 % for all the histograms together (Sidak 1967)."""
    rng = np.random.default_rng(4)
    draws, bins, inner, tests = 1 << 15, 16, 12, []
    node, weight = np.polynomial.legendre.leggauss(inner)
    cell = (np.arange(bins)[:, None] + (node + 1) / 2) / bins
    sine, phi = np.meshgrid(2 * cell.ravel() - 1, 2 * np.pi * cell.ravel() - np.pi, indexing="ij")
    area = np.tile(weight, bins)[:, None] * np.tile(weight, bins) / bins**2 * np.pi
    for theta, h, tilt, sigma_a in ((0.4, 0.5, 0.05, (0.2, 0.5, 2.0)), (-1.2, -0.95, 0.3, (3.0, 0.0, 0.1))):
        m, wo = fibre(beta_m=beta_m, beta_n=beta_n, tilt=tilt, sigma_a=sigma_a), f32(direction(theta, 2.0))
        pdf = call_glsl(FILE, "fibre_pdf", f=m, h=h, wo=wo, wi=direction(np.arcsin(sine), phi)) * area
        share = pdf.reshape(bins, inner, bins, inner).sum(axis=(1, 3))
        assert share.sum() == pytest.approx(1, abs=1e-3)
        wi = draw(m, h, wo, rng.random((draws, 4), np.float32))["wi"]
        counts = np.histogram2d(wi[:, 0], np.arctan2(wi[:, 2], wi[:, 1]), bins, [(-1, 1), (-np.pi, np.pi)])[0]
        tests.append(statistic(counts.ravel(), draws * share.ravel()))
    assert max(chi2 / critical_value(degrees, 8) for chi2, degrees in tests) < 1


def test_weight_is_eval_over_pdf():
    """And the sample's pdf is what the pdf says of its direction. No weight is above the number of channels."""
    rng = np.random.default_rng(5)
    count = 20_000
    m, wo, h = random_fibres(rng, count, 0.0), random_directions(rng, count), f32(rng.uniform(-1, 1, count))
    drawn = draw(m, h, wo, rng.random((count, 4), np.float32))
    value = call_glsl(FILE, "fibre_eval", f=m, h=h, wo=wo, wi=drawn["wi"])
    pdf = call_glsl(FILE, "fibre_pdf", f=m, h=h, wo=wo, wi=drawn["wi"])
    assert np.abs(drawn["pdf"] / pdf - 1).max() < 1e-4
    assert np.abs(drawn["return"] - value / pdf[:, None]).max() < 1e-4
    assert np.abs(np.linalg.norm(drawn["wi"], axis=-1) - 1).max() < 1e-6
    assert drawn["return"].max() <= 3


def test_reciprocity_as_the_model_has_it():
    """The mean over the offsets is the same both ways where the inclinations are equal in amount and the fibre has no
    tilt. Elsewhere the model is not reciprocal."""
    rng = np.random.default_rng(6)
    theta, phi = rng.uniform(-1.4, 1.4, 40), rng.uniform(0, 2 * np.pi, (2, 40))
    sign = np.where(rng.random(40) < 0.5, -1, 1)
    node, weight = np.polynomial.legendre.leggauss(200)

    def mean(m, wo, wi):
        f = call_glsl(FILE, "fibre_eval", f=m, h=node, wo=wo[:, None], wi=wi[:, None])
        return (f * weight[:, None]).sum(axis=1) / 2

    a, b = direction(theta, phi[0]), direction(sign * theta, phi[1])
    m = fibre(sigma_a=(0.1, 0.5, 2.0), tilt=0.0)
    assert np.abs(mean(m, a, b) / mean(m, b, a) - 1).max() < 1e-3
    c = direction(theta / 2, phi[1])
    assert np.abs(mean(m, a, c) / mean(m, c, a) - 1).max() > 0.05


def test_extremes_are_finite():
    """Every parameter at its ends, alone and together; offsets that rounding has put beyond 1."""
    rng = np.random.default_rng(7)
    count = 50_000
    m = fibre(sigma_a=rng.choice([0, 1e-6, 1, 80, 1e6, 1e30], (count, 3)), beta_m=rng.choice(BETA, count),
              beta_n=rng.choice(BETA, count), tilt=rng.choice([0, 0.03, -0.5, np.pi / 2], count),
              eta=rng.choice([1, 1.0001, 1.55, 100], count))
    h = rng.choice([*OFFSETS, 1 + 1e-6, -1 - 1e-6, 1e-6], count)
    theta = rng.choice([0, 1e-6, 1, np.pi / 2 - 1e-6, np.pi / 2, -np.pi / 2], (2, count))
    wo, wi = direction(theta[0], rng.uniform(0, 7, count)), direction(theta[1], rng.choice([0, np.pi / 2, 1, 4], count))
    exactly_along = rng.random(count) < 0.1
    wo[exactly_along] = [1, 0, 0]
    wi[rng.random(count) < 0.1] = [-1, 0, 0]
    wi = np.where(rng.random((count, 1)) < 0.2, wo * rng.choice([1, -1], (count, 1)), wi)
    u = rng.choice(f32([0, 2**-24, 0.5, 1 - 2**-24]), (count, 4))
    found = draw(m, h, wo, u)
    found |= {"f": call_glsl(FILE, "fibre_eval", f=m, h=h, wo=wo, wi=wi),
              "of the pdf": call_glsl(FILE, "fibre_pdf", f=m, h=h, wo=wo, wi=wi),
              "albedo": call_glsl(FILE, "fibre_albedo", f=m, h=h, wo=wo),
              "h": call_glsl(FILE, "fibre_offset", normal=wi, wo=wo)}
    for name, values in found.items():
        assert np.isfinite(values).all(), name
        assert name in ("wi", "h") or (values >= 0).all(), name
    assert found["albedo"].max() < 1 + 1e-6 and found["return"].max() <= 3 and np.abs(found["h"]).max() <= 1
    assert np.abs(np.linalg.norm(found["wi"], axis=-1) - 1).max() < 1e-6


def test_light_that_nothing_absorbs_is_not_lost_at_the_edge():
    """1 - F and 1 - T keep their digits where both vanish: the share of A_2 and of the rest at |h| near 1."""
    h = f32(1 - np.geomspace(1e-7, 0.1, 30))
    wo = f32(direction(0.3, 0.0))
    for sigma_a in (0.0, 1e-6, 1e-3, 1.0):
        m = fibre(sigma_a=np.full(3, sigma_a))
        way = call_glsl(FILE, "fibre_way", h=h, cos_theta=np.hypot(wo[1], wo[2]), eta=1.55)
        found = call_glsl(FILE, "fibre_attenuation", sigma_a=m["sigma_a"], way=way["way"], eta=1.55,
                          mu=np.hypot(wo[1], wo[2]) * np.sqrt((1 - h) * (1 + h)))
        wide = {name: np.asarray(value, np.longdouble) for name, value in m.items()}
        expected = twin.attenuation(wide, np.longdouble(h), np.longdouble(twin.angles(wo)[0]))[0][..., 0].T
        assert np.abs(found[:, 0] / expected - 1).max() < 2e-5
