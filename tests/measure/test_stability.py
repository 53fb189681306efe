"""The stability checks: their figures are what is computed here from scratch, and the extremes are looked at."""

from __future__ import annotations

from dataclasses import replace
from decimal import Context, Decimal, localcontext

import numpy as np
import pytest
from contexts import open_or_skip

from viewer.measure.check import reference
from viewer.measure.check.extremes import check_extremes, not_finite
from viewer.measure.check.lobe_stability import check_lobe_stability
from viewer.measure.check.stability import Sweep, check_sweep, measure, relative_error, sweeps


def test_relative_error_of_zero_and_of_what_is_not_finite():
    found, exact = np.array([0.0, 1.0, np.nan, np.inf, 1.1]), np.array([0.0, 0.0, 1.0, 1.0, 1.0])
    assert relative_error(found, exact) == pytest.approx([0, np.inf, np.inf, np.inf, 0.1])


def test_every_function_keeps_its_bound():
    checks = [check_sweep(sweep) for sweep in sweeps()]
    assert not [check for check in checks if check.is_defect]
    names = ("d_ggx", "v_smith_ggx", "f_schlick", "f_dielectric")
    promised = [check for check in checks if check.case.startswith(names)]
    assert len(promised) >= 9
    assert all(check.bound <= 1e-5 for check in promised if "critical" not in check.case)
    assert all("ulp" in check.note for check in checks)


def test_every_lobe_keeps_its_bound():
    assert not [check for check in check_lobe_stability() if check.is_defect]


def test_an_error_is_measured_and_placed(tmp_path):
    """A function that is wrong by 1 in 1000 at one end of its axis."""
    file = tmp_path / "wrong.glsl"
    file.write_text("float wrong(float x) { return x * (1.0 + 0.001 * x); }\n")
    axis = np.linspace(0.1, 1, 10)
    sweep = Sweep("wrong", str(file), "on a line", {"x": axis}, lambda x: x, 1e-4)
    check = check_sweep(sweep)
    assert check.value == pytest.approx(1e-3, rel=1e-3) and not check.passed and "worst at x 1" in check.note
    errors = measure(replace(sweep, exact=lambda x: x * (1 + np.float32(0.001) * x)))
    assert errors.relative.max() < 2e-7 and errors.ulp.max() <= 2
    assert errors.limit.max() == pytest.approx(2**-24, rel=0.01)


@pytest.mark.parametrize(("sine", "alpha"), [("0", "0.001"), ("0.001", "0.001"), ("0.3", "0.1"), ("0.999", "0.5")])
def test_reference_distribution(sine, alpha):
    """The textbook denominator, 1 + cos^2 (alpha^2 - 1), which in 40 digits may cancel."""
    with localcontext(Context(prec=40)):
        a2, cos2 = Decimal(alpha) ** 2, 1 - Decimal(sine) ** 2
        expected = float(a2 / (1 + cos2 * (a2 - 1)) ** 2) / np.pi
    theta, alpha = np.arcsin(float(sine)), float(alpha)
    assert reference.d_ggx(theta, alpha) == pytest.approx(expected, rel=1e-12)
    h = np.array([np.sin(theta) * 0.6, np.sin(theta) * 0.8, np.cos(theta)])
    assert reference.d_ggx_anisotropic(h, np.array([alpha, alpha])) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("mu", ["1", "0.8", "0.0001"])
@pytest.mark.parametrize("eta", ["1", "1.0001", "1.5", "100", "0.7"])
def test_reference_dielectric(mu, eta):
    """Fresnel's equations by Snell's law, in 40 digits."""
    with localcontext(Context(prec=40)):
        c, n = Decimal(mu), Decimal(eta)
        cos2_t = 1 - (1 - c * c) / (n * n)
        cos_t = max(cos2_t, Decimal(0)).sqrt()
        r_s, r_p = (c - n * cos_t) / (c + n * cos_t), (n * c - cos_t) / (n * c + cos_t)
        expected = float((r_s**2 + r_p**2) / 2) if cos2_t >= 0 else 1.0
    assert reference.f_dielectric(float(mu), float(eta)) == pytest.approx(expected, rel=1e-11, abs=1e-25)
    assert reference.f_conductor(float(mu), float(eta), 0.0) == pytest.approx(expected, rel=1e-11, abs=1e-25)


@pytest.mark.parametrize("mu", [1.0, 0.5, 1e-3])
@pytest.mark.parametrize(("eta", "k"), [(0.2, 3.0), (4.0, 1.0), (1.0, 0.1)])
def test_reference_conductor(mu, eta, k):
    """In real numbers: Born & Wolf 1999, section 14.2, with a + ib the root of n^2 - sin^2."""
    s2 = 1 - mu**2
    t = eta**2 - k**2 - s2
    w = np.hypot(t, 2 * eta * k)
    a = np.sqrt((w + t) / 2)
    f_s = (w + mu**2 - 2 * a * mu) / (w + mu**2 + 2 * a * mu)
    f_p = f_s * (w * mu**2 + s2**2 - 2 * a * mu * s2) / (w * mu**2 + s2**2 + 2 * a * mu * s2)
    assert reference.f_conductor(mu, eta, k) == pytest.approx((f_s + f_p) / 2, rel=1e-9)


@pytest.mark.parametrize("NoV", [1.0, 0.3, 0.05])
@pytest.mark.parametrize("alpha", [0.05, 0.5, 1.0])
def test_reference_masking(NoV, alpha):
    """Smith's G1 makes the facets seen fill the view: int D G1 max(v.h, 0) dh = NoV (Heitz 2014, eq. 14)."""
    s, ds = np.polynomial.legendre.leggauss(400)
    t = (s + 1) / 2 * np.pi / 2
    theta = np.arctan(alpha * np.tan(t))
    d_theta = ds * np.pi / 4 * alpha * np.cos(theta) ** 2 / np.cos(t) ** 2
    phi = (np.arange(400) + 0.5) / 400 * 2 * np.pi
    VoH = NoV * np.cos(theta)[:, None] + np.sqrt(1 - NoV**2) * np.sin(theta)[:, None] * np.cos(phi)
    d = reference.d_ggx(theta, alpha) * np.sin(theta) * d_theta
    seen = (d[:, None] * np.maximum(VoH, 0)).sum() * 2 * np.pi / 400
    assert seen / (1 + reference.lambda_ggx(NoV, alpha)) == pytest.approx(NoV, rel=2e-4)


def test_extremes():
    from viewer.raster.renderer import Renderer

    with open_or_skip() as context:
        checks = list(check_extremes(Renderer(context, use_cache=False)))
    assert not [check for check in checks if check.is_defect]
    assert {check.check for check in checks} == {"no NaN, no Inf", "light kept", "linear in light", "same picture",
                                                 "right one in front"}
    assert len(checks) > 40


def test_what_is_not_finite_is_counted():
    from viewer.image.image import Image

    pixels = np.zeros((2, 2, 4), np.float32)
    pixels[0, 1, 2], pixels[1, 0, 0] = np.nan, np.inf
    check = not_finite("broken", Image.from_linear(pixels))
    assert check.value == 2 and not check.passed
