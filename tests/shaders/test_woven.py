"""Layers of fibres in a woven cloth: against float64, no light created, reciprocal, and sampled as they say."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
import woven_twin as twin

from viewer import call_glsl
from viewer.bake.entered import entered_share
from viewer.bake.yarn import SLICES, max_rise, mirrored_share, weave_table
from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.scene.weave import WEAVES, Weave, Yarn

FILE = "bsdf/weave/woven.glsl"
ALPHA, THICKNESS = (0.02, 0.1, 0.4, 1.0), (0.0, 1e-6, 0.5, 4.0, 1e4)
COSINES = (1.0, 0.6, 0.2, 0.01, 1e-6)
DELTA = 4
NONE = np.zeros((385, 24, 4), np.float32)
"""A table where nothing leaves at once."""
WARP, WEFT = Yarn(roughness=0.15, thickness=4.0, bend=40.0), Yarn(roughness=1.0, thickness=0.7, bend=40.0)


@lru_cache(maxsize=1)
def table():
    return weave_table(Weave(WEAVES["plain"].draft, WARP, WEFT))


def f32(values):
    return np.asarray(values, np.float32).astype(float)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def cloth(yarn=WARP, tilt=0.0, turn=0.0, lean=None, **parameters):
    """A white yarn whose fibres rise by `tilt` from the plane, in the direction `turn`; its normal leans by `lean` (two
    components of a vector), or is perpendicular to the fibres."""
    tilt, turn = np.broadcast_arrays(tilt, turn)
    axis = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1)
    normal = np.stack([-np.sin(tilt) * np.cos(turn), -np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
    if lean is not None:
        normal = unit(np.array([*lean, 1.0]))
    rise = np.minimum(np.abs(axis[..., 2]) / max_rise(yarn), 1)
    slice_ = (0 if yarn is WARP else SLICES) + rise * (SLICES - 1)
    return {"axis": f32(axis), "normal": f32(normal), "alpha": yarn.roughness, "thickness": yarn.thickness,
            "specular": 0.5, "passed": 1.0, "returned": 1.0, "diffuse": 1.0, "through": 0.3,
            "below": np.ones(3), "below_through": 0.4,
            "slice": f32(slice_), "horizon": 1e6, "gap": np.array([-1.0, -1.0]),
            **{name: f32(value) for name, value in parameters.items()}}


CLOTHS = (cloth(tilt=0.4), cloth(tilt=-0.5, turn=1.2, lean=(0.8, -0.3), horizon=0.7),
          cloth(WEFT, lean=(0.2, 0.1), horizon=3), cloth(WEFT, tilt=0.7, turn=2.0),
          cloth(gap=(0.4, 2.5), turn=0.4), cloth(lean=(0.0, -3.0), horizon=0.3))
"""Flat and steep yarns, dense and thin, and a gap."""


def columns(m):
    return {name: np.asarray(value) for name, value in m.items()}


def call(function, m, **arrays):
    return call_glsl(FILE, f"woven_{function}", m=columns(m), table=table(), **arrays)


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


def test_what_meets_one_fibre_against_float64():
    rng = np.random.default_rng(1)
    count = 20_000
    m = cloth(tilt=rng.uniform(-1, 1, count), turn=rng.uniform(0, 7, count), alpha=rng.uniform(0.05, 1, count),
              thickness=rng.exponential(2, count), diffuse=0.0,
              specular=np.repeat([[1.0] * 3, [0.0] * 3], count // 2, axis=0))
    wo, wi = (f32(unit(rng.normal(size=(count, 3)))) for _ in range(2))
    usable = (np.abs(wo[:, 2]) > 0.02) & (np.abs(wi[:, 2]) > 0.02) & (np.linalg.norm(wo + wi, axis=-1) > 0.05)
    found = call_glsl(FILE, "woven_eval", m=m, wo=wo, wi=wi, table=NONE)[usable] * np.abs(wi[usable, 2:])
    axis = unit(m["axis"])
    parts = (part(axis, m["alpha"], m["thickness"], wo, wi) for part in (twin.mirrored, twin.entered))
    expected = np.where(m["specular"][:, 0] == 1, *parts)[usable, None]
    assert (np.abs(found - expected) / np.maximum(expected, 1e-2)).max() < 1e-3
    view = call_glsl(FILE, "woven_view(Woven, vec3, sampler2D)", m=m, wo=wo, table=NONE)
    assert np.abs(view["straight"] - twin.straight(axis, m["alpha"], m["thickness"], wo)).max() < 2e-5


def test_the_table_holds_the_shares_that_leave_at_once():
    """Against quadrature; and never so much less that light would be created."""
    rng = np.random.default_rng(5)
    wo = seen(rng.uniform(0.1, 1, 24), rng.uniform(0, 7, 24)) * rng.choice([-1, 1], 24)[:, None]
    for yarn, error in ((WARP, 0.02), (WEFT, 5e-3)):
        m = cloth(yarn, tilt=rng.uniform(-0.7, 0.7, 24), turn=rng.uniform(0, 7, 24))
        view = call_glsl(FILE, "woven_view(Woven, vec3, sampler2D)", m=m, wo=wo, table=table())
        nodes = [part.reshape(-1, *part.shape[2:]) for part in sphere(16, 12)]
        for name, count in (("mirrored", 24), ("entered", 6)):
            exact = twin.share(getattr(twin, name), unit(m["axis"])[:count], yarn.roughness, yarn.thickness, wo[:count],
                               nodes)
            assert (view[name][:count] - exact).max() < error and (view[name][:count] - exact).min() > -0.008, name


def test_what_is_diffuse_against_float64():
    rng = np.random.default_rng(6)
    wi, area = (part.reshape(-1, *part.shape[2:]) for part in sphere(12, 8))
    above = wi[:, 2] > 0
    for m in CLOTHS[:4]:
        m = {**m, "diffuse": f32(0.7), "specular": f32(0.4), "below": f32(0.9)}
        yarn = WARP if m["alpha"] == WARP.roughness else WEFT

        def shares(w, m=m, yarn=yarn):
            x, y, z = np.where(m["axis"][2] < 0, -1, 1) * m["axis"]
            azimuth = np.arctan2(np.abs(x * w[:, 1] - y * w[:, 0]), x * w[:, 0] + y * w[:, 1])
            mirrored, straight = mirrored_share(yarn.roughness, yarn.thickness, z, azimuth, w[:, 2], 512)
            return mirrored, entered_share(yarn.roughness, yarn.thickness, z, azimuth, w[:, 2]), straight

        o, i = (unit(rng.normal(size=(200, 3))) for _ in range(2))
        o[:, 2], i[:, 2] = np.abs(o[:, 2]) + 0.05, np.abs(i[:, 2]) + 0.05
        o, i = f32(unit(o)), f32(unit(i))
        view = call("view(Woven, vec3, sampler2D)", m, wo=o)
        found = call_glsl(FILE, "woven_diffuse", m=columns(m), v=view, wo=o, wi=i, table=table())[:, 0]
        expected = twin.diffuse(m, shares, o, i, (wi[above], area[above]))
        error = np.abs(found - expected) / expected.clip(0.02)
        assert error.max() < 0.1 and np.median(error) < 0.02


def test_no_light_is_created_and_white_yarns_lose_none():
    """What is mirrored or diffuse, by quadrature, and what goes straight on are all the light, for white fibres."""
    wi, area = sphere(24, 12)
    wo = np.stack([seen(cosine, turn) for cosine in COSINES[:4] for turn in (0.1, 1.5, 3.0)])
    for m in CLOTHS:
        straight = call("view(Woven, vec3, sampler2D)", m, wo=wo)["straight"]
        assert np.abs(call("albedo", m, wo=wo)[:, 0] + straight - 1).max() < 1e-5
        f = call("eval", m, wo=wo[:, None, None], wi=wi)[..., 0] * np.abs(wi[..., 2])
        total = (f * area).sum(axis=(1, 2)) + straight
        assert total.max() < 1 + 5e-3 and total.min() > 1 - 0.03


def test_light_may_be_reversed():
    rng = np.random.default_rng(3)
    wo, wi = (f32(unit(rng.normal(size=(4000, 3)))) for _ in range(2))
    steep = np.minimum(np.abs(wo[:, 2]), np.abs(wi[:, 2])) > 0.05
    for m in CLOTHS:
        m = {**m, "passed": np.array([1.0, 0.5, 0.1]), "diffuse": np.array([1.0, 0.5, 0.1])}
        forth, back = (call("eval", m, wo=a, wi=b)[steep] for a, b in ((wo, wi), (wi, wo)))
        assert (np.abs(forth - back) / np.maximum(np.maximum(forth, back), 1e-2)).max() < 2e-3


def test_light_passes_gaps_as_it_passes_cylinders():
    """At `across` radii from the axis of a cylinder, and as far from one across it: whether a ray meets either."""
    rng = np.random.default_rng(8)
    w = f32(unit(rng.normal(size=(500, 3))))
    for across in (1.05, 1.5, 2.0):
        m = cloth(gap=[np.sqrt(across**2 - 1)] * 2, turn=0.6)
        found = call("view(Woven, vec3, sampler2D)", m, wo=w)["straight"]
        axes = m["axis"], np.cross([0, 0, 1], m["axis"])
        near = [across * np.abs(w[:, 2]) / np.linalg.norm(np.cross(w, axis), axis=-1) for axis in axes]
        assert np.array_equal(found > 0.5, np.minimum(*near) > 1)
    assert call_glsl(FILE, "woven_open", gap=[1e6, 1e6]) == pytest.approx(1, abs=1e-5)


def test_samples_follow_pdf_and_weigh_eval_over_pdf():
    rng = np.random.default_rng(2)
    bins, inner, draws, tests = 16, 10, 1 << 15, []
    wi, area = sphere(bins, inner)
    for m, wo in zip(CLOTHS, (seen(0.8), seen(0.3), seen(0.9), seen(-0.6), seen(0.4), seen(0.95))):
        m = {**m, "specular": np.array((0.2, 0.5, 0.3)), "passed": np.array((0.9, 0.6, 0.4)),
             "returned": np.array((0.8, 0.5, 0.2)), "diffuse": np.array((0.8, 0.3, 0.1))}
        m["normal"] = m["normal"] * np.sign(wo[2])
        pdf = call("pdf", m, wo=wo, wi=wi) * area
        drawn = call("sample(Woven, vec3, vec3, sampler2D)", m, wo=wo, u=rng.random((draws, 3), np.float32))
        kept = (drawn["flags"] & DELTA == 0) & (drawn["flags"] != 0)
        straight = drawn["flags"] & DELTA != 0
        share = pdf.reshape(bins, inner, bins, inner).sum(axis=(1, 3))
        assert share.sum() == pytest.approx(1 - straight.mean(), abs=0.01)
        found = drawn["wi"][kept]
        counts = np.histogram2d(found[:, 2], np.arctan2(found[:, 1], found[:, 0]) % (2 * np.pi), bins,
                                [(-1, 1), (0, 2 * np.pi)])[0]
        tests.append(statistic(counts.ravel(), draws * share.ravel()))
        f = call("eval", m, wo=wo, wi=found) * np.abs(found[:, 2:])
        density = call("pdf", m, wo=wo, wi=found)
        assert np.quantile(np.abs(drawn["weight"][kept] - f / density[:, None]), 0.999) < 1e-3
        albedo = call("albedo", m, wo=wo)
        assert np.abs(np.where(kept[:, None], drawn["weight"], 0).mean(axis=0) - albedo).max() < 0.02
    assert max(chi2 / critical_value(degrees, len(tests)) for chi2, degrees in tests) < 1


def test_extremes_are_finite():
    rng = np.random.default_rng(4)
    count = 20_000
    m = cloth(tilt=rng.choice([0, 0.5, -1.5, np.pi / 2], count), turn=rng.choice([0, 1, np.pi / 2], count),
              alpha=rng.choice([0, *ALPHA], count), thickness=rng.choice(THICKNESS, count),
              specular=rng.choice([0, 0.04, 1], (count, 3)), passed=rng.choice([0, 1], (count, 3)),
              returned=rng.choice([0, 1], (count, 3)), diffuse=rng.choice([0, 0.5, 1], (count, 3)),
              through=rng.choice([0, 0.5, 1], count), below=rng.choice([0, 0.5, 1], (count, 3)),
              below_through=rng.choice([0, 0.5, 1], count), horizon=rng.choice([0, 1, 1e6], count),
              gap=rng.choice([-1, 0, 1, 1e3], (count, 2)))
    wo, wi = (seen(rng.choice(COSINES, count) * rng.choice([1, -1], count), rng.choice([0, 0.7, 2], count))
              for _ in range(2))
    drawn = call("sample(Woven, vec3, vec3, sampler2D)", m, wo=wo,
                 u=rng.choice(np.float32([0, 2**-24, 0.5, 1 - 2**-24]), (count, 3)))
    found = {"weight": drawn["weight"], "pdf": drawn["pdf"], "f": call("eval", m, wo=wo, wi=wi),
             "of the pdf": call("pdf", m, wo=wo, wi=wi), "albedo": call("albedo", m, wo=wo)}
    for name, values in found.items():
        assert np.isfinite(values).all() and (values >= 0).all(), name
    assert found["albedo"].max() < 1 + 1e-5
