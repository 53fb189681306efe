"""shaders/light/punctual.glsl and bsdf/phong.glsl against KHR_lights_punctual and their integrals."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.scene.light import Light

DEFINES = {"LIGHT_COUNT": 3, "DIRECTIONAL_COUNT": 1, "POINT_COUNT": 1}


def test_inverse_square_and_its_window(evaluate):
    """1 / d^2 max(min(1 - (d / range)^4, 1), 0)."""
    d = np.concatenate([np.geomspace(1e-3, 1e3, 300)] * 2)
    inv_range = np.repeat([0.0, 1 / 3.0], 300)
    inputs = np.stack([d**2, inv_range**2, d, d], axis=-1)
    found = evaluate("light/punctual", "vec4(distance_attenuation(i.x, i.y, 1e-8))", inputs, defines=DEFINES)[:, 0]
    expected = np.clip(1 - (d * inv_range) ** 4, 0, 1) / d**2
    assert np.abs(found - expected).max() <= 1e-5 * expected.max()
    assert np.allclose(found, expected, rtol=1e-5, atol=1e-6)
    assert (found[(d > 3) & (inv_range > 0)] == 0).all()
    touching = evaluate("light/punctual", "vec4(distance_attenuation(0.0, 0.0, 1e-8))", inputs[:1], defines=DEFINES)
    assert np.isfinite(touching).all()


@pytest.mark.parametrize(("inner", "outer"), [(0.3, 0.5), (0.0, np.pi / 2), (0.5, 0.5), (1e-3, 2e-3), (1e-5, 1.1e-5)])
def test_cone(evaluate, inner, outer):
    """clamp((cos - cos_outer) / (cos_inner - cos_outer))^2: 1 within the inner cone, 0 without the outer, also where
    the cosines are 1 in float32."""
    scale, offset = Light("spot", inner_cone=inner, outer_cone=outer).cone
    angle = np.float32(np.linspace(0, 2 * outer, 400)).astype(np.float64)
    inputs = np.stack([np.sin(angle), np.cos(angle), 0 * angle + scale, 0 * angle + offset], axis=-1)
    call = "vec4(angular_attenuation(vec3(i.x, 0.0, i.y), vec3(0.0, 0.0, 1.0), i.zw))"
    found = evaluate("light/punctual", call, inputs, defines=DEFINES)[:, 0]
    versine = 2 * np.sin(angle / 2) ** 2
    low, high = (2 * np.sin(edge / 2) ** 2 for edge in (inner, outer))
    expected = np.clip((high - versine) / max(high - low, min(1e-4, 1e-3 * high)), 0, 1) ** 2
    assert np.abs(found - expected).max() < 1e-4 if inner < outer else (found != expected).sum() <= 1
    assert (found[angle < 0.99 * inner] == 1).all() and (found[angle > 1.01 * outer] == 0).all()


@pytest.mark.parametrize("shininess", [0.0, 1.0, 10.0, 100.0, 1e4])
def test_phong_reflects_about_what_arrives(evaluate, shininess):
    """Seen along the normal the albedo is 1 for Phong (Lafortune & Willems 1994); Blinn's stays within 8 % of it."""
    x, weight = np.polynomial.legendre.leggauss(200)
    width = 1 / np.sqrt(1 + shininess)
    theta = np.minimum(np.arctan(width * np.tan((x + 1) * np.pi / 4)), np.pi / 2)
    jacobian = width * np.cos(theta) ** 2 / np.cos((x + 1) * np.pi / 4) ** 2 * weight * np.pi / 4
    inputs = np.stack([np.cos(theta), np.cos(theta / 2), 0 * theta + shininess, theta], axis=-1)
    found = evaluate("bsdf/phong", "vec4(f_phong(i.x, i.z), f_blinn(i.y, i.z), 0.0, 0.0)", inputs)
    phong, blinn = 2 * np.pi * (found[:, :2] * (np.cos(theta) * np.sin(theta) * jacobian)[:, None]).sum(axis=0)
    assert phong == pytest.approx(1, abs=5e-4)
    assert 0.99 < blinn < 1.08
