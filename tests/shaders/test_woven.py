"""Layers of fibres in a woven cloth: against float64, all light accounted for, and sampled as they say."""

from __future__ import annotations

import numpy as np
import pytest
import woven_twin as twin

from viewer import call_glsl
from viewer.measure.check.chi_squared import critical_value, statistic

FILE = "bsdf/weave/woven.glsl"
ALPHA, THICKNESS = (0.02, 0.1, 0.4, 1.0), (0.0, 1e-6, 0.5, 4.0, 1e4)
COSINES = (1.0, 0.6, 0.2, 0.01, 1e-6)
DELTA = 4


def f32(values):
    return np.asarray(values, np.float32).astype(float)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def yarn(tilt=0.0, turn=0.0, **parameters):
    """A white yarn whose fibres rise by `tilt` from the plane, in the direction `turn`."""
    tilt, turn = np.broadcast_arrays(tilt, turn)
    axis = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1)
    normal = np.stack([-np.sin(tilt) * np.cos(turn), -np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
    return {"axis": f32(axis), "normal": f32(normal), "alpha": 0.2, "thickness": 2.0, "specular": 1.0, "diffuse": 1.0,
            "through": 0.3, **{name: f32(value) for name, value in parameters.items()}}


def seen(cosine, turn=0.7):
    s = np.sqrt(1 - np.asarray(cosine) ** 2)
    return f32(np.stack([s * np.cos(turn), s * np.sin(turn), np.asarray(cosine) + 0 * s], axis=-1))


def sphere(bins, inner):
    """Directions and areas of quadrature nodes over the sphere, in bins of the cosine and the azimuth."""
    node, weight = np.polynomial.legendre.leggauss(inner)
    place = ((np.arange(bins)[:, None] + (node + 1) / 2) / bins).ravel()
    z, phi = np.meshgrid(2 * place - 1, 2 * np.pi * place, indexing="ij")
    s = np.sqrt(1 - z * z)
    area = np.outer(np.tile(weight, bins), np.tile(weight, bins)) * np.pi / bins**2
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1), area


def test_against_float64():
    rng = np.random.default_rng(1)
    count = 20_000
    m = yarn(rng.uniform(-1, 1, count), rng.uniform(0, 7, count), alpha=rng.uniform(0.05, 1, count),
             thickness=rng.exponential(2, count), diffuse=0.0)
    wo, wi = (f32(unit(rng.normal(size=(count, 3)))) for _ in range(2))
    usable = (np.abs(wo[:, 2]) > 0.02) & (np.abs(wi[:, 2]) > 0.02) & (np.linalg.norm(wo + wi, axis=-1) > 0.05)
    found = call_glsl(FILE, "woven_eval", m=m, wo=wo, wi=wi)[usable] * np.abs(wi[usable, 2:])
    axis = unit(m["axis"])
    expected = twin.mirrored(axis, m["alpha"], m["thickness"], wo, wi)[usable, None]
    assert (np.abs(found - expected) / np.maximum(expected, 1e-2)).max() < 1e-3
    view = call_glsl(FILE, "woven_view(Woven, vec3)", m=m, wo=wo)
    assert np.abs(view["straight"] - twin.straight(axis, m["alpha"], m["thickness"], wo)).max() < 2e-5
    assert (view["mirrored"] + view["straight"] < 1 + 1e-6).all()


@pytest.mark.parametrize("alpha", [0.1, 1.0])
def test_white_furnace(alpha):
    """What is mirrored, by quadrature, what is diffuse and what goes straight on are all the light, for fibres at any
    angle. The share that is mirrored is a mean over a lattice."""
    cosine, tilt, turn, thickness = (grid.ravel() for grid in np.meshgrid(
        COSINES[:3], [0, -0.9], [0.7, 1.5, 2.2], [0.5, 4.0], indexing="ij"))
    m, wo = yarn(tilt, turn, alpha=alpha, thickness=thickness), seen(cosine)
    wi, area = sphere(1, 120)
    columns = {name: np.asarray(value) for name, value in m.items()}
    columns = {name: value.reshape(len(value), 1, 1, *value.shape[1:]) if value.ndim else value
               for name, value in columns.items()}
    f = call_glsl(FILE, "woven_eval", m=columns, wo=wo[:, None, None], wi=wi)[..., 0]
    straight = call_glsl(FILE, "woven_view(Woven, vec3)", m=m, wo=wo)["straight"]
    albedo = call_glsl(FILE, "woven_albedo", m=m, wo=wo)[:, 0]
    assert np.abs(albedo + straight - 1).max() < 1e-6
    assert np.abs((f * np.abs(wi[..., 2]) * area).sum(axis=(1, 2)) + straight - 1).max() < 0.04


def test_samples_follow_pdf_and_weigh_eval_over_pdf():
    rng = np.random.default_rng(2)
    bins, inner, draws, tests = 16, 10, 1 << 15, []
    wi, area = sphere(bins, inner)
    for cosine, tilt, alpha, thickness in ((0.8, 0.3, 0.2, 2.0), (0.3, -0.5, 0.5, 0.7), (-0.6, 0.1, 0.15, 5.0)):
        m, wo = yarn(tilt, 1.2, alpha=alpha, thickness=thickness, specular=(0.2, 0.5, 0.3), diffuse=(0.8, 0.3, 0.1)), \
            seen(cosine)
        pdf = call_glsl(FILE, "woven_pdf", m=m, wo=wo, wi=wi) * area
        drawn = call_glsl(FILE, "woven_sample(Woven, vec3, vec3)", m=m, wo=wo, u=rng.random((draws, 3), np.float32))
        kept = (drawn["flags"] & DELTA == 0) & (drawn["flags"] != 0)
        straight = drawn["flags"] & DELTA != 0
        share = pdf.reshape(bins, inner, bins, inner).sum(axis=(1, 3))
        assert share.sum() == pytest.approx(1 - straight.mean(), abs=0.01)
        found = drawn["wi"][kept]
        counts = np.histogram2d(found[:, 2], np.arctan2(found[:, 1], found[:, 0]) % (2 * np.pi), bins,
                                [(-1, 1), (0, 2 * np.pi)])[0]
        tests.append(statistic(counts.ravel(), draws * share.ravel()))
        f = call_glsl(FILE, "woven_eval", m=m, wo=wo, wi=found) * np.abs(found[:, 2:])
        density = call_glsl(FILE, "woven_pdf", m=m, wo=wo, wi=found)
        assert np.quantile(np.abs(drawn["weight"][kept] - f / density[:, None]), 0.999) < 1e-3
        albedo = call_glsl(FILE, "woven_albedo", m=m, wo=wo)
        assert np.abs(np.where(kept[:, None], drawn["weight"], 0).mean(axis=0) - albedo).max() < 0.015
    assert max(chi2 / critical_value(degrees, len(tests)) for chi2, degrees in tests) < 1


def test_what_is_mirrored_is_reciprocal_and_what_is_diffuse_is_not():
    rng = np.random.default_rng(3)
    wo, wi = (f32(unit(rng.normal(size=(4000, 3)))) for _ in range(2))
    steep = np.minimum(np.abs(wo[:, 2]), np.abs(wi[:, 2])) > 0.05
    for diffuse in (0.0, 1.0):
        m = yarn(0.3, 1.0, diffuse=diffuse, specular=0.5)
        forth, back = (call_glsl(FILE, "woven_eval", m=m, wo=a, wi=b)[steep, 0] for a, b in ((wo, wi), (wi, wo)))
        error = np.abs(forth - back) / np.maximum(np.maximum(forth, back), 1e-2)
        assert (np.quantile(error, 0.99) < 1e-3) == (diffuse == 0)


def test_extremes_are_finite():
    rng = np.random.default_rng(4)
    count = 20_000
    m = yarn(rng.choice([0, 0.5, -1.5, np.pi / 2], count), rng.choice([0, 1, np.pi / 2], count),
             alpha=rng.choice([0, *ALPHA], count), thickness=rng.choice(THICKNESS, count),
             specular=rng.choice([0, 0.04, 1], (count, 3)), diffuse=rng.choice([0, 0.5, 1], (count, 3)),
             through=rng.choice([0, 0.5, 1], count))
    wo, wi = (seen(rng.choice(COSINES, count) * rng.choice([1, -1], count), rng.choice([0, 0.7, 2], count))
              for _ in range(2))
    drawn = call_glsl(FILE, "woven_sample(Woven, vec3, vec3)", m=m, wo=wo,
                      u=rng.choice(np.float32([0, 2**-24, 0.5, 1 - 2**-24]), (count, 3)))
    found = {"weight": drawn["weight"], "pdf": drawn["pdf"], "f": call_glsl(FILE, "woven_eval", m=m, wo=wo, wi=wi),
             "of the pdf": call_glsl(FILE, "woven_pdf", m=m, wo=wo, wi=wi),
             "albedo": call_glsl(FILE, "woven_albedo", m=m, wo=wo)}
    for name, values in found.items():
        assert np.isfinite(values).all() and (values >= 0).all(), name
    assert found["albedo"].max() < 1 + 1e-6
