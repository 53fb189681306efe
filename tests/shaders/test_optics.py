"""The functions under the lobes, against the papers in float64 over dense tables with all their extremes."""

from __future__ import annotations

import microfacet_twins as twins
import numpy as np
import pytest

from viewer import call_glsl
from viewer.bake.dfg import dfg_table

COSINES = np.concatenate([np.geomspace(1e-4, 1, 60), [0.5, 0.9999]])
ALPHAS = np.array([1e-3, 3e-3, 0.01, 0.1, 0.5, 1.0])


def f32(*arrays):
    """As float32 has them, in float64: what both sides are asked."""
    rounded = tuple(np.asarray(a, np.float32).astype(float) for a in arrays)
    return rounded if len(rounded) > 1 else rounded[0]


def directions(cosines, turns=(0.0, 0.3, 1.5, 2.8)):
    """(cosines, turns, 3), with the sine from the rounded cosine."""
    z, phi = np.meshgrid(f32(cosines), turns, indexing="ij")
    s = np.sqrt(1 - z * z)
    return f32(np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1))


def relative(found, expected):
    return np.abs(found / expected - 1).max()


def test_ggx_distribution():
    """Slopes in float64 for half vectors within 1000 widths of the normal, both roughnesses apart."""
    alpha = f32(np.stack(np.meshgrid(ALPHAS, ALPHAS), axis=-1).reshape(-1, 1, 1, 2))
    theta = np.arctan(np.geomspace(1e-6, 1e3, 80))
    h = np.stack([np.multiply.outer(np.sin(theta), np.cos([0.0, 0.3, 1.5])),
                  np.multiply.outer(np.sin(theta), np.sin([0.0, 0.3, 1.5])),
                  np.repeat(np.cos(theta)[:, None], 3, axis=1)], axis=-1)
    found = call_glsl("bsdf/ggx_local.glsl", "d_ggx_local", h=f32(h), alpha=alpha)
    expected = twins.ggx_d(f32(h), alpha)
    assert relative(found, expected) < 2e-6
    isotropic = call_glsl("bsdf/ggx.glsl", "d_ggx", NoH=h[..., 2], s2=1 - h[..., 2] ** 2, alpha=alpha[..., 0])
    same = np.broadcast_to(alpha[..., 0] == alpha[..., 1], found.shape)
    assert relative(isotropic[same], found[same]) < 1e-4  # 1 - NoH^2 of a rounded NoH


def test_ggx_projected_area_is_one():
    """int D NoH dh = 1 over the hemisphere, for stretched lobes too (Walter et al. 2007, eq. 4)."""
    x, weight = np.polynomial.legendre.leggauss(64)
    tan = np.tan((x + 1) / 2 * np.pi / 2)  # of the stretched angle
    phi = (np.arange(64) + 0.5) / 64 * 2 * np.pi
    for alpha in [(1e-3, 1e-3), (0.01, 0.5), (1, 0.2), (1, 1)]:
        slope = np.stack([np.multiply.outer(tan, a * np.cos(phi + b)) for a, b in zip(alpha, (0, -np.pi / 2))], axis=-1)
        h = twins.unit(np.concatenate([slope, np.ones((64, 64, 1))], axis=-1))
        d = call_glsl("bsdf/ggx_local.glsl", "d_ggx_local", h=h, alpha=np.array(alpha))
        # d slope = alpha_t alpha_b tan dtan dphi, and D NoH dh = D NoH^4 dslope.
        jacobian = alpha[0] * alpha[1] * (tan * (1 + tan**2) * weight * np.pi / 4)[:, None] * 2 * np.pi / 64
        assert (d * h[..., 2] ** 4 * jacobian).sum() == pytest.approx(1, abs=1e-5)


def test_smith():
    alpha = f32(np.stack(np.meshgrid(ALPHAS, ALPHAS), axis=-1).reshape(-1, 1, 1, 1, 1, 2))
    wo, wi = directions(COSINES[::4])[:, :, None, None], directions(COSINES[::4])
    found = call_glsl("bsdf/ggx_local.glsl", "v_smith_ggx_local", wo=wo, wi=wi, alpha=alpha)
    g2 = 1 / (1 + twins.ggx_lambda(wo, alpha) + twins.ggx_lambda(wi, alpha))
    assert relative(found, g2 / (4 * wo[..., 2] * wi[..., 2])) < 2e-6
    small = call_glsl("bsdf/ggx_local.glsl", "lambda_ggx_local", w=wi, alpha=alpha)
    expected = np.broadcast_to(twins.ggx_lambda(wi, alpha), small.shape)
    assert (np.abs(small - expected) <= 3e-6 * expected).all()
    grazing = call_glsl("bsdf/ggx_local.glsl", "lambda_ggx_local", w=[[1, 0, 0], [1, 0, 1e-30], [0, 0, 1]], alpha=1.0)
    assert np.isfinite(grazing).all() and grazing[2] == 0


def test_beta():
    """Relative error where nothing is a denormal number; 1e4 is Smith's Lambda at alpha 1 and a cosine of 5e-5."""
    x = f32(np.concatenate([np.geomspace(1, 1e4, 80), 1 + np.geomspace(1e-6, 1, 20)]))
    found = call_glsl("bsdf/beta.glsl", "beta", x=x[:, None], y=x)
    expected = twins.beta(x[:, None], x + 0 * x[:, None])
    seen = expected > 1e-30
    assert relative(found[seen], expected[seen]) < 6e-5
    usual = (x < 10)[:, None] & (x < 1e4)
    assert relative(found[usual & seen], expected[usual & seen]) < 2e-5
    assert (found[~seen] < 2e-30).all() and np.isfinite(call_glsl("bsdf/beta.glsl", "beta", x=1e6, y=[1, 1e6]))[0]


def test_accurate_functions():
    x = f32(np.concatenate([[0.0], np.geomspace(1e-9, 1e4, 400)]))
    found = call_glsl("bsdf/accurate.glsl", "log_1_plus", x=x)
    assert (np.abs(found - np.log1p(x)) <= 1e-6 * np.log1p(x)).all()
    found = call_glsl("bsdf/accurate.glsl", "one_minus_exp_fast", x=x)
    assert (np.abs(found + np.expm1(-x)) <= 3e-6 * -np.expm1(-x)).all()


def test_f82_tint():
    f0, tint = (f32(a) for a in np.meshgrid([0, 0.04, 0.3, 0.9, 1], [0, 0.5, 0.9, 1], indexing="ij"))
    mu = f32(np.concatenate([[0.0, 1e-6], np.linspace(0.001, 1, 200)]))
    f0, tint = (a.reshape(-1, 1, 1) * np.ones(3) for a in (f0, tint))
    found = call_glsl("bsdf/fresnel_metal.glsl", "f_f82_tint", f0=f0, tint=tint, mu=mu)
    assert np.abs(found - twins.f82_tint(f0, tint, mu)).max() < 1e-6
    at_82 = call_glsl("bsdf/fresnel_metal.glsl", "f_f82_tint", f0=f0, tint=tint, mu=1 / 7)
    assert np.abs(at_82 - tint * twins.schlick(f0, 1.0, np.array(1 / 7))).max() < 1e-6
    mean = call_glsl("bsdf/fresnel_metal.glsl", "f_f82_tint_mean", f0=f0[:, 0], tint=tint[:, 0])
    never_dark = ((f0 >= 0.3) & (tint >= 0.5) | (tint == 1))[:, 0]  # else the curve is cut at 0
    expected = twins.hemispherical_mean(lambda m: twins.f82_tint(f0[:, 0], tint[:, 0], np.array(m)))
    assert np.abs(mean - expected)[never_dark].max() < 2e-6


def test_conductor():
    eta, k = (f32(a) for a in np.meshgrid([0.05, 0.2, 1.0, 1.5, 4.0, 100.0], [0, 1e-4, 0.5, 3, 10, 1000.0]))
    mu = f32(np.concatenate([[0.0, 1e-6], np.geomspace(1e-4, 1, 100)]))
    found = call_glsl("bsdf/fresnel_metal.glsl", "f_conductor(float, float, float)",
                      mu=mu, eta=eta[..., None], k=k[..., None])
    with np.errstate(invalid="ignore"):
        expected = twins.fresnel(mu, (eta + 1j * k)[..., None])
    assert np.isfinite(found).all() and (found >= 0).all() and (found < 1 + 1e-6).all()
    lit = (mu > 0) & ~((eta == 1) & (k < 0.1))[..., None]
    metallic = lit & (k[..., None] >= 0.5)
    assert relative(found[metallic], expected[metallic]) < 2e-5
    assert np.abs(found - expected)[lit].max() < 2e-5


def test_conductor_without_absorption_is_a_dielectric():
    mu, eta = f32(np.linspace(0.05, 1, 50)), f32(np.array([1.2, 1.5, 2.4, 1 / 1.5]))[:, None]
    metal = call_glsl("bsdf/fresnel_metal.glsl", "f_conductor(float, float, float)", mu=mu, eta=eta, k=0.0)
    glass = call_glsl("bsdf/fresnel.glsl", "f_dielectric", mu=mu, eta=eta)
    assert np.abs(metal - glass).max() < 2e-5
    extremes = call_glsl("bsdf/fresnel_metal.glsl", "f_conductor(float, float, float)",
                         mu=[[0.0], [1e-6], [1.0]], eta=[0.0, 1.0, 1.0, 0.5], k=[0.0, 0.0, 1e30, 1e-30])
    assert np.isfinite(extremes).all() and (extremes >= 0).all() and (extremes < 1 + 1e-6).all()


def test_f0_of_eta():
    eta = f32(np.array([1.0, 1.0001, 1.05, 1.5, 2.4, 100.0]))
    f0 = call_glsl("bsdf/fresnel.glsl", "f0_from_eta", eta=eta)
    assert np.abs(f0 - ((eta - 1) / (eta + 1)) ** 2).max() < 1e-6 and f0[0] == 0


def test_mean_loss_is_that_of_the_albedo():
    r = np.array([0.2, 0.35, 0.5, 0.7, 0.85, 1.0])
    found = call_glsl("bsdf/kulla_conty.glsl", "ggx_mean_loss", dfg=dfg_table(), perceptual_roughness=r)
    expected = [1 - twins.ggx_mean_albedo(a * a) for a in r]
    assert np.abs(found - expected).max() < 5e-4


def test_cosine_hemisphere():
    """Moments: a cosine lobe has <z> = 2/3 and <z^2> = 1/2; the disk's <r^2> is 1/2."""
    u = np.random.default_rng(1).random((200_000, 2), np.float32)
    lobe = call_glsl("sample/hemisphere.glsl", "sample_cosine_hemisphere", u=u)
    disk = call_glsl("sample/hemisphere.glsl", "sample_disk", u=u)
    assert np.abs(np.linalg.norm(lobe, axis=1) - 1).max() < 2e-6
    assert np.abs([lobe[:, 2].mean() - 2 / 3, (lobe[:, 2] ** 2).mean() - 1 / 2]).max() < 4e-3
    assert np.abs(lobe[:, :2].mean(axis=0)).max() < 4e-3
    assert (disk**2).sum(axis=1).mean() == pytest.approx(0.5, abs=3e-3) and (disk**2).sum(axis=1).max() <= 1 + 1e-6
    edges = call_glsl("sample/hemisphere.glsl", "sample_cosine_hemisphere",
                      u=[[0, 0], [0.5, 0.5], [1 - 2**-24, 0], [1 - 2**-24, 1 - 2**-24]])
    assert np.isfinite(edges).all() and (edges[:, 2] >= 0).all()
    z = np.array([-1, 0, 0.3, 1])
    w = np.stack([np.sqrt(1 - z * z), 0 * z, z], axis=-1)
    assert np.allclose(call_glsl("sample/hemisphere.glsl", "pdf_cosine_hemisphere", w=w), np.maximum(z, 0) / np.pi)


def test_visible_normals_face_the_viewer():
    """And bounding the cap (Eto & Tokuyoshi 2023) keeps what is reflected above the surface: all at normal view,
    alpha 1."""
    rng = np.random.default_rng(2)
    u = rng.random((20_000, 2), np.float32)
    file = "bsdf/visible_normal.glsl"
    for alpha in (1e-3, 0.1, 1.0):
        for NoV in (1.0, 0.95, 0.1, 1e-6):
            wo = np.array([np.sqrt(1 - NoV**2), 0, NoV])
            h = call_glsl(file, "sample_visible_normal", wo=wo, alpha=np.array([alpha, alpha]), bound=1.0, u=u)
            assert np.isfinite(h).all() and (h @ wo > -1e-6).all() and (h[:, 2] > -1e-6).all()
    wo = np.array([np.sqrt(1 - 0.95**2), 0, 0.95])

    def kept(bound):
        h = call_glsl(file, "sample_visible_normal", wo=wo, alpha=np.ones(2), bound=bound, u=u)
        return ((2 * (h @ wo)[:, None] * h - wo)[:, 2] > 0).mean()

    assert kept(1.0) == pytest.approx(0.51, abs=0.02)
    assert kept(call_glsl(file, "cap_bound", wo=wo, alpha=np.ones(2))) > 0.99


def test_hammersley_fills_every_cell():
    points = call_glsl("sample/lattice.glsl", "hammersley", i=np.arange(256, dtype=np.uint32), n=np.uint32(256))
    cells = (points * 16).astype(int)
    assert len(np.unique(cells[:, 0] * 16 + cells[:, 1])) == 256


def test_luminance():
    c = np.random.default_rng(3).random((50, 3))
    assert np.allclose(call_glsl("sample/luminance.glsl", "luminance", c=c), c @ [0.2126, 0.7152, 0.0722], atol=1e-6)
