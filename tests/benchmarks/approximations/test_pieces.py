"""Each piece's errors: known figures, and less of them where more is spent."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from contexts import is_software

from benchmarks.approximations import curves, dfg, floats, fresnel, irradiance, light, prefilter, split_sum
from viewer.bake.dfg import directional_albedo


def test_a_larger_table_errs_less_and_a_fit_more(errors):
    found = errors(dfg.dfg_piece((8, 16, 32, 64)))
    rms = {name: np.sqrt(np.mean(error**2)) for name, error in found.items()}
    sizes = [rms[f"table {size} x {size}, float"] for size in (8, 16, 32, 64)]
    # Linear between entries: a fourth of the error for twice the size, until the quadrature's own is left.
    assert all(coarse / fine > 3 for coarse, fine in pairwise(sizes))
    assert sizes[-1] < 1e-4 and np.abs(found["table 64 x 64, float"]).max() < 2e-3
    assert np.abs(found["table 64 x 64, half"] - found["table 64 x 64, float"]).max() < 2 * 2.0**-11
    assert 0.005 < rms["fit, MaterialX"] < 0.01
    assert 0.02 < rms["fit, Narkowicz 2014"] < rms["fit, Lazarov 2013"] < 0.06
    assert 0.08 < rms["fit, Karis 2014"] < 0.1


def test_schlick_is_wrong_by_what_is_known(errors):
    piece = fresnel.dielectric_piece()
    shape = piece.cases[0].parameters.shape[:2]
    found = {name: error.reshape(shape) for name, error in errors(piece).items()}
    index = piece.cases[0].parameters[0, :, 1]
    for at, least in ((1.5, 0.036), (1.05, 0.32), (1.33, 0.06)):
        column = np.abs(found["Schlick"][:, np.abs(index - at).argmin()])
        assert column.max() == pytest.approx(least, rel=0.1)
    assert np.abs(found["exact"]).max() < 1e-6
    assert np.abs(found["Schlick"] - found["Schlick by pow()"]).max() < 1e-6
    assert np.abs(found["Schlick"] - found["spherical Gaussian"]).max() < 0.01


def test_metals_need_more_than_one_colour(rms):
    found = rms(fresnel.metal_piece())
    assert found["exact"] < 1e-6 < 100 * found["exact"] < found["F82-tint"] < 0.01 < found["Schlick"] < 0.1


def test_small_functions(errors):
    found = errors(curves.srgb_piece())
    assert np.abs(found["piecewise"]).max() < 1e-3 and 7 < np.abs(found["gamma 2.2"]).max() < 9
    assert 1 < np.abs(found["square roots"]).max() < 3
    found = errors(curves.equirect_piece())
    assert max(np.abs(error).max() for error in found.values()) < 0.04
    found = errors(curves.distribution_piece())
    assert np.abs(found["by the cross product"]).max() < 1e-5
    assert 0.01 < np.abs(found["textbook"]).max() < 0.1
    found = errors(curves.masking_piece())
    assert np.abs(found["height-correlated"]).max() < 1e-6
    assert 0.2 < np.abs(found["Hammon's fit"]).max() < 0.4 < np.abs(found["separable"]).max() < 1


def test_irradiance(errors):
    found = errors(irradiance.irradiance_piece((16, 64)))
    rms = {name: np.sqrt(np.mean(error**2)) for name, error in found.items()}
    assert rms["4 harmonics to degree 1"] > 3 * rms["9 harmonics to degree 2"] > 9 * rms["18 harmonics to degree 4"]
    assert rms["18 harmonics to degree 4"] > 5 * rms["map 128 x 64, half"] and rms["map 32 x 16, half"] > 1e-3
    assert np.abs(found["map 128 x 64, half"]).max() < 4e-3
    # A window takes from what is there.
    assert rms["9 harmonics to degree 2, windowed"] > rms["9 harmonics to degree 2"]


def test_the_filtered_environment(rms):
    maps = rms(prefilter.lookup_piece((128, 512)))
    assert maps["levels from 256 x 128, half"] > 2 * maps["levels from 1024 x 512, half"]
    assert maps["levels from 1024 x 512, half"] < 0.02 and maps["64 samples in the shader"] > 0.04
    bake = rms(prefilter.bake_piece())
    samples = [bake[f"{count} samples a texel"] for count in (16, 64, 256)]
    assert samples[0] > 2 * samples[1] > 4 * samples[2] > 4 * bake["spherical harmonics"]
    assert bake["spherical harmonics"] < 0.006


def test_the_split_sum(rms):
    dielectric, metal = rms(split_sum.dielectric_piece()), rms(split_sum.metal_piece())
    two, one = "two lookups and the irradiance", "one lookup and the irradiance"
    parts, common = "each part's mean direction", "the parts' common mean direction"
    assert 1.6 * dielectric[two] < dielectric[one] < dielectric[parts] < 0.7 * dielectric[common]
    assert 2 * metal[two] < metal[one] < 0.9 * metal[common] < metal[parts] < 0.15
    for found in (dielectric, metal):
        assert 3 * found[two] < found["mirror direction"] < 0.4 and found[common] < found["Frostbite's fit of the peak"]


def test_its_reference_is_the_albedo_where_light_is_1(monkeypatch):
    monkeypatch.setattr(split_sum, "seen", lambda _, directions: np.ones_like(directions))
    n, v, roughness = split_sum._views()
    for f0 in (0.04, 0.9):
        found = split_sum._integrals("none", n, v, roughness, f0)[0, ..., 0]
        for column, r in enumerate(roughness[0, 0]):
            ab = directional_albedo("ggx", "smith", split_sum._NOV, r * r, 64)
            assert found[:, column] == pytest.approx(ab[:, 0] * f0 + ab[:, 1], rel=3e-3)


def test_formats(rms):
    found = rms(floats.storage_piece())
    most = 1.1 if is_software() else 1.5
    assert found["half, 16 bits a channel"] < most * found["float, 32 bits a channel"] < 2e-3
    assert found["shared exponent, 9 + 5 bits"] < 2e-3
    assert (5e-3 if is_software() else 2e-3) < found["small floats, 11, 11 and 10 bits"] < 2e-2


def test_what_is_seen_between_texels():
    pixels = light.radiance("sky")
    theta, phi = np.pi * 100.5 / 512, 2 * np.pi * (1024 / 1024 - 0.5)  # the seam, between the last column and the first
    direction = np.array([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)])
    assert light.seen("sky", direction) == pytest.approx((pixels[100, 1023] + pixels[100, 0]) / 2, rel=1e-6)
