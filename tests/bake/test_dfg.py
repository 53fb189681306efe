from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.dfg import SIZE, albedo_table, compute_dfg_table, dfg_albedos, dfg_table, directional_albedo
from viewer.bake.lobe_samples import lobe_samples
from viewer.settings import MASKINGS, NDFS


def by_light_direction(ndf: str, masking: str, NoV: float, alpha: float, nodes: int = 400) -> np.ndarray:
    """a, b and their first moments as the plain integral of D V Fc NoL over light directions, midpoints in (mu, phi):
    an independent way. With 400 nodes it is good to 2e-6."""
    mu = (np.arange(nodes) + 0.5) / nodes
    phi = (np.arange(nodes) + 0.5) / nodes * np.pi
    NoL, sin_l = mu[:, None], np.sqrt(1 - mu**2)[:, None]
    h = np.stack([np.sqrt(1 - NoV**2) + sin_l * np.cos(phi), sin_l * np.sin(phi), NoV + NoL + 0 * phi])
    h /= np.sqrt((h * h).sum(axis=0))
    NoH, VoH = h[2], np.sqrt(1 - NoV**2) * h[0] + NoV * h[2]
    tan2 = 1 / NoH**2 - 1
    if ndf == "ggx":
        D = alpha**2 / (np.pi * NoH**4 * (alpha**2 + tan2) ** 2)
    elif ndf == "beckmann":
        D = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * NoH**4)
    else:
        s = 2 / alpha**2 - 2
        D = (s + 2) / (2 * np.pi) * NoH**s

    def smith(c):
        if ndf == "ggx":
            return (np.sqrt(1 + alpha**2 * (1 - c * c) / (c * c)) - 1) / 2
        a = c / (alpha * np.sqrt(1 - c * c))
        return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0)

    G = {
        "smith": lambda: 1 / (1 + smith(NoV) + smith(NoL)),
        "smith-separable": lambda: 1 / ((1 + smith(NoV)) * (1 + smith(NoL))),
        "v-cavity": lambda: np.minimum(1, 2 * NoH * np.minimum(NoV, NoL) / VoH),
        "none": lambda: 1.0,
    }[masking]()
    f = D * G / (4 * NoV) * (2 * np.pi / nodes**2)
    fresnel = (1 - VoH) ** 5
    toward_mirror = -sin_l * np.cos(phi)
    return np.array([[(f * part * term).sum() for term in (1, NoL, toward_mirror)] for part in (1 - fresnel, fresnel)])


@pytest.mark.parametrize("ndf", NDFS)
@pytest.mark.parametrize("masking", MASKINGS)
def test_against_the_integral_over_light_directions(ndf, masking):
    for NoV, alpha in ((0.15, 0.3), (0.5, 0.15), (0.9, 1.0), (0.4, 0.6)):
        [directions], [parts] = lobe_samples(ndf, masking, np.array([NoV]), alpha, 24)
        found = parts.T @ np.column_stack([np.ones(len(parts)), directions[:, :2]])
        assert found == pytest.approx(by_light_direction(ndf, masking, NoV, alpha), abs=1e-3)


def test_the_mirror_column_is_schlick():
    NoV = (np.arange(SIZE) / (SIZE - 1)) ** 2
    NoV[0] = 1e-4
    b = (1 - NoV) ** 5
    assert dfg_table()[:SIZE, 0, :2] == pytest.approx(np.stack([1 - b, b], axis=-1), abs=1e-5)
    alone, *pair = dfg_table().reshape(4, SIZE, SIZE, 4)[1:, :, 0]
    assert alone[1:] == pytest.approx(np.tile([1, 0, 1, 1], (SIZE - 1, 1)), abs=1e-3)
    assert sum(half[..., 2:] for half in pair) == pytest.approx(alone[..., 2:], abs=1e-6)


def test_levels_grow_by_the_square_of_the_roughness_from_the_mirror_on():
    """The table's columns 2 and 4 are below the first roughness that is fitted."""
    levels = dfg_table().reshape(4, SIZE, SIZE, 4)[1:, 1:, :, 1]
    assert levels[..., 2] == pytest.approx(levels[..., 4] / 4, rel=0.02)


def test_almost_a_mirror_is_almost_a_mirror():
    NoV = np.array([0.1, 0.5, 1.0])
    near, mirror = directional_albedo("ggx", "smith", NoV, 1e-4), directional_albedo("ggx", "smith", NoV, 0.0)
    assert near == pytest.approx(mirror, abs=1e-4)


def test_smith_ggx_loses_what_single_scattering_loses_at_normal_view():
    lost = [1 - directional_albedo("ggx", "smith", np.array([1.0]), alpha)[0].sum() for alpha in (0.25, 0.5, 1.0)]
    assert lost == pytest.approx([0.08, 0.31, 0.69], abs=0.005)


def test_the_means_are_those_over_the_hemisphere():
    """2 int E mu dmu by other nodes than the table's rows; a mirror's are 20/21 and 1/21."""
    means = dfg_table()[:SIZE, :, 2:]
    assert np.ptp(means, axis=0).max() == 0
    x, weight = np.polynomial.legendre.leggauss(48)
    mu = (x + 1) / 2
    for column in (0, 16, 40, 63):
        albedo = directional_albedo("ggx", "smith", mu, (column / (SIZE - 1)) ** 2, 64)
        assert means[0, column] == pytest.approx(weight * mu @ albedo, abs=2e-4)
    assert means[0, 0] == pytest.approx([20 / 21, 1 / 21], abs=2e-4)


def test_without_masking_no_light_is_missing():
    assert albedo_table("ggx", "none", SIZE)[..., 2:].sum(axis=-1).max() <= 1 + 1e-6


@pytest.mark.parametrize("masking", ["smith", "smith-separable", "v-cavity"])
def test_no_more_light_than_came(masking):
    table = albedo_table("ggx", masking, SIZE)[..., :2]
    assert table.min() >= 0
    assert table.sum(axis=2).max() <= 1 + 2e-3


def test_the_shipped_table_is_what_its_script_makes():
    off = np.abs(compute_dfg_table("ggx", "smith", SIZE) - dfg_table())
    assert off[:SIZE, :, :2].max() < 1.5e-3
    assert off[:SIZE, :, :2].mean() < 1e-4
    assert off.mean() < 1e-3
    assert dfg_table().dtype == np.float32


def test_without_lookups_the_albedos_are_the_same(monkeypatch):
    """Made anew, and from the cache."""
    monkeypatch.setattr("viewer.bake.dfg.fit_lookups", lambda *_: [np.ones((2, 2, count, 4)) for count in (1, 2)])
    whole = compute_dfg_table("beckmann", "none", SIZE)
    for _ in range(2):
        dfg_albedos.cache_clear()
        alone = dfg_albedos("beckmann", "none")
        assert alone.shape == whole.shape and alone.dtype == whole.dtype and not alone.flags.writeable
        assert (alone[:SIZE] == whole[:SIZE]).all() and not alone[SIZE:].any() and whole[SIZE:].any()
    assert dfg_albedos("ggx", "smith") is dfg_table()


def test_the_lookup_between_texels_is_close():
    table = dfg_table()[:SIZE, :, :2].astype(np.float64)
    NoV = np.linspace(0.1, 1, 91)
    for r in np.linspace(0.1, 1, 37):
        x, y = r * (SIZE - 1), np.sqrt(NoV) * (SIZE - 1)
        i, j = min(int(x), SIZE - 2), np.minimum(y.astype(int), SIZE - 2)
        s, t = x - i, (y - j)[:, None]
        found = (table[j, i] * (1 - s) + table[j, i + 1] * s) * (1 - t)
        found += (table[j + 1, i] * (1 - s) + table[j + 1, i + 1] * s) * t
        assert found == pytest.approx(directional_albedo("ggx", "smith", NoV, r * r, 48), abs=2e-3)
