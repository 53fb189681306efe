"""shaders/display/: tone curves and sRGB against the papers' forms in float64, to a quarter of a level of 255."""

from __future__ import annotations

import numpy as np
import pytest

LEVEL = 1 / 255


def srgb(linear):
    """IEC 61966-2-1."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def neutral(color):
    """Khronos PBR Neutral Tone Mapper, specification of 2024."""
    f90, kd, ks = 0.04, 0.15, 0.8 - 0.04
    x = color.min(axis=-1, keepdims=True)
    offset = np.where(x <= 2 * f90, x - x**2 / (4 * f90), f90)
    color = color - offset
    p = color.max(axis=-1, keepdims=True)
    pn = 1 - (1 - ks) ** 2 / (p + 1 - 2 * ks)
    g = 1 / (kd * (p - pn) + 1)
    with np.errstate(invalid="ignore"):
        compressed = color * pn / p * g + pn * (1 - g)
    return np.where(p <= ks, color, compressed)


AGX_INSET = np.array([[0.842479062253094, 0.0784335999999992, 0.0792237451477643],
                      [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
                      [0.0423756549057051, 0.0784336, 0.879142973793104]])


def agx(color, curve):
    """Sobotka 2022: log2 about middle grey from -10 to +6.5 stops, between a rotation inwards and its inverse."""
    stops = np.log2(np.maximum(color @ AGX_INSET.T, 1e-10) / 0.18)
    shown = curve(np.clip((stops + 10) / 16.5, 0, 1)) @ np.linalg.inv(AGX_INSET).T
    return np.clip(shown, 0, 1) ** 2.2


def agx_polynomial(x):
    """Wrensch 2023, "Minimal AgX Implementation"."""
    return np.polynomial.polynomial.polyval(x, [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5])


def agx_sigmoid(x):
    """Sobotka's own curve: slope 2 at the pivot (10 / 16.5, 1/2), powers 3 below it and 3.25 above."""
    pivot_x, pivot_y, slope = 10 / 16.5, 0.5, 2.0
    power = np.where(x < pivot_x, 3.0, 3.25)
    reach_x, reach_y = np.where(x < pivot_x, pivot_x, 1 - pivot_x), np.where(x < pivot_x, pivot_y, 1 - pivot_y)
    scale = ((slope * reach_x) ** -power * ((slope * reach_x / reach_y) ** power - 1)) ** (-1 / power)
    t = slope * np.abs(x - pivot_x) / scale
    return pivot_y + np.sign(x - pivot_x) * scale * t / (1 + t**power) ** (1 / power)


def aces(color):
    """Hill's fit of ACES' RRT and ODT (Pettineo & Hill, BakingLab), exposed by 1 / 0.6 as three.js does."""
    inward = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
    outward = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
    v = color / 0.6 @ inward.T
    fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.clip(fitted @ outward.T, 0, 1)


@pytest.fixture
def colors() -> np.ndarray:
    """Radiances from black to a sun, grey and saturated."""
    value = np.concatenate([[0.0], 2.0 ** np.linspace(-14, 20, 300)])
    tint = np.array([[1, 1, 1], [1, 0.2, 0.05], [0, 1, 0.3], [0.1, 0, 1]])
    rows = (value[:, None, None] * tint).reshape(-1, 3)
    return np.c_[rows, np.zeros(len(rows))].astype("f4").astype(float)


def shown(evaluate, tonemap: int, colors: np.ndarray) -> np.ndarray:
    return evaluate("display/tonemap", "vec4(tonemap(i.rgb), 0.0)", colors, defines={"TONEMAP": tonemap})[:, :3]


def test_srgb(evaluate):
    x = np.concatenate([np.linspace(-0.1, 1.1, 500), np.linspace(0, 0.01, 500)])
    found = evaluate("display/srgb", "vec4(srgb_from_linear(i.rgb), 0.0)", np.stack([x] * 4, axis=-1))[:, 0]
    assert np.abs(found - srgb(x)).max() < LEVEL / 4
    assert found[np.abs(x) < 1e-12].tolist() == [0.0] and found[x >= 1].min() > 1 - LEVEL / 100


@pytest.mark.parametrize(("tonemap", "twin"), [
    (0, lambda color: color), (1, neutral), (2, lambda color: agx(color, agx_polynomial)), (3, aces)],
    ids=["none", "neutral", "agx", "aces"])
def test_tone_curve(evaluate, colors, tonemap, twin):
    found = shown(evaluate, tonemap, colors)
    assert np.isfinite(found).all()
    assert np.abs(srgb(found) - srgb(twin(colors[:, :3]))).max() < LEVEL / 4


def test_agx_follows_sobotkas_own_curve(evaluate, colors):
    """The polynomial is a fit, good to two levels of 255 of what is shown."""
    difference = srgb(shown(evaluate, 2, colors)) - srgb(agx(colors[:, :3], agx_sigmoid))
    assert np.abs(difference).max() < 2.5 * LEVEL


def test_neutral_keeps_base_colors(evaluate):
    """A base colour under white light of radiance 1, its Fresnel reflectance of 0.04 included, comes back as it is."""
    base = np.random.default_rng(2).uniform(0.05, 0.75, (256, 4))
    assert np.abs(shown(evaluate, 1, base + 0.04) - base[:, :3]).max() < 1e-6


@pytest.mark.parametrize("tonemap", [1, 2, 3])
def test_tone_curves_rise_and_end_at_white(evaluate, tonemap):
    grey = np.repeat(2.0 ** np.linspace(-14, 60, 600)[:, None], 4, axis=1)
    found = shown(evaluate, tonemap, grey)
    assert (np.diff(found[:, 1]) > -1e-4).all()
    assert found[-1].min() > 0.97 and found.max() <= 1 + 1e-6
