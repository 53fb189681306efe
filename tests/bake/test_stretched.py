from __future__ import annotations

import numpy as np
import pytest

from viewer.bake import stretched
from viewer.bake.dfg import directional_albedo
from viewer.bake.stretched import SIZE, compute_levels, correlated_albedo, seen_slopes, stretched_levels

ALBEDOS, MEANS = stretched_levels("smith")


def by_light_direction(alpha_t: float, alpha_b: float, azimuth: float, NoV: float, nodes: int = 400) -> np.ndarray:
    """a and b as the plain integral of D V over light directions."""
    mu, phi = ((np.arange(nodes) + 0.5) / nodes)[:, None], (np.arange(nodes) + 0.5) / nodes * 2 * np.pi
    s = np.sqrt(1 - mu**2)
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), mu + 0 * phi])
    wo = np.array([np.sqrt(1 - NoV**2) * np.cos(azimuth), np.sqrt(1 - NoV**2) * np.sin(azimuth), NoV])
    h = wi + wo[:, None, None]
    h /= np.sqrt((h * h).sum(axis=0))
    VoH = np.einsum("k,kij->ij", wo, h)
    D = 1 / (np.pi * alpha_t * alpha_b * ((h[0] / alpha_t) ** 2 + (h[1] / alpha_b) ** 2 + h[2] ** 2) ** 2)
    t_i, t_o = (np.sqrt((alpha_t * w[0]) ** 2 + (alpha_b * w[1]) ** 2 + w[2] ** 2) for w in (wi, wo))
    f = D / (2 * (t_o * mu + t_i * NoV)) * mu * (2 * np.pi / nodes**2)
    grazing = (f * (1 - VoH) ** 5).sum()
    return np.array([f.sum() - grazing, grazing])


@pytest.mark.parametrize("view", [(0.6, 0.2, 0.5, 0.3), (0.3, 0.3, 1.0, 0.7), (1.0, 0.25, 1.2, 0.15)])
def test_the_quadrature_over_visible_normals(view):
    along, across, rho = seen_slopes(*(np.array([value]) for value in view[:3]))
    found = correlated_albedo("smith", along, across, rho, np.array([view[3]]), 64)
    assert found[0] == pytest.approx(by_light_direction(*view), abs=1e-3)


@pytest.mark.parametrize("masking", ["smith", "smith-separable", "v-cavity"])
def test_without_stretching_it_is_the_isotropic_albedo(masking):
    NoV = np.array([0.15, 0.5, 0.9])
    found = correlated_albedo(masking, 0.4 + 0 * NoV, 0.4, 0.0, NoV, 64)
    assert found == pytest.approx(directional_albedo("ggx", masking, NoV, 0.4, 64), abs=1.5e-3)


def test_the_shipped_levels_are_what_their_script_makes(monkeypatch):
    """With fewer nodes, and means of fewer lobes."""
    monkeypatch.setattr(stretched, "_means", lambda masking, cube: cube)
    found, _ = compute_levels("smith", 16)
    off = np.abs(found - ALBEDOS)
    assert off.mean() < 1e-3 and off[..., :2].max() < 2e-2
    assert found.dtype == ALBEDOS.dtype == MEANS.dtype == np.float32
    assert MEANS.shape == (64, SIZE, 4)


def test_other_maskings_are_computed_once(monkeypatch):
    made = []
    monkeypatch.setattr(stretched, "compute_levels", lambda masking: made.append(masking) or (ALBEDOS, MEANS))
    monkeypatch.setattr(stretched, "key", lambda *parts: '-'.join(parts))
    kept = {}
    monkeypatch.setattr(stretched, "load", kept.get)
    monkeypatch.setattr(stretched, "store", kept.__setitem__)
    for _ in range(2):
        albedos, means = stretched_levels("v-cavity")
        assert (albedos == ALBEDOS).all() and (means == MEANS).all()
    assert made == ["v-cavity"]
