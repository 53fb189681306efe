"""What shaders/bsdf/weave should give, in float64: from Heitz et al. 2015, from Wang et al. 2022, and by what
shaders/bsdf/weave/woven.glsl says it is, with means by quadrature."""

from __future__ import annotations

import numpy as np


def matrix(axis, alpha):
    """S of the SGGX distribution, (..., 3, 3): 1 across the axis, alpha^2 along it."""
    outer = axis[..., :, None] * axis[..., None, :]
    return np.eye(3) - outer + np.asarray(alpha)[..., None, None] ** 2 * outer


def area(axis, alpha, w):
    """Heitz et al. 2015, eq. 2."""
    return np.sqrt(np.einsum("...i,...ij,...j", w, matrix(axis, alpha), w))


def density(axis, alpha, h):
    """Heitz et al. 2015, eq. 3."""
    s = matrix(axis, alpha)
    return 1 / (np.pi * np.sqrt(np.linalg.det(s)) * np.einsum("...i,...ij,...j", h, np.linalg.inv(s), h) ** 2)


def mirrored(axis, alpha, thickness, wo, wi):
    """f |cos| of light that the layer mirrors once, for white fibres: Wang et al. 2022, eqs. 10 and 11."""
    h = wo + wi
    h = h / np.linalg.norm(h, axis=-1, keepdims=True)
    o, i = area(axis, alpha, wo) / np.abs(wo[..., 2]), area(axis, alpha, wi) / np.abs(wi[..., 2])
    back = (1 - np.exp(-thickness * (o + i))) / (o + i)
    forth = (np.exp(-thickness * o) - np.exp(-thickness * i)) / (i - o)
    return density(axis, alpha, h) / (4 * np.abs(wo[..., 2])) * np.where(wo[..., 2] * wi[..., 2] > 0, back, forth)


def straight(axis, alpha, thickness, wo):
    return np.exp(-thickness * area(axis, alpha, wo) / np.abs(wo[..., 2]))


def mirrored_share(axis, alpha, thickness, wo, sphere):
    """m(wo), by quadrature over the sphere."""
    wi, weight = sphere
    return (mirrored(axis[..., None, :], alpha, thickness, wo[..., None, :], wi) * weight).sum(axis=-1)


def seen(normal, horizon, w):
    """s(w): of light from w the share that falls on the yarn."""
    slope = np.linalg.norm(normal[:2]) / normal[2]
    lean = w[..., :2] @ normal[:2] / (normal[2] * w[..., 2])
    return np.where(lean > slope * horizon, 0, np.clip(1 + lean, 0, 1))


def diffuse(m, shares, wo, wi, hemisphere):
    """f |cos|, for one channel and wo and wi on the side of the yarn's normal; `shares` is a function that gives m and
    exp(-T Lambda), `hemisphere` nodes and weights for means."""
    nodes, weight = hemisphere
    weight = weight * nodes[:, 2] / np.pi

    def rest(w):
        share, straight = shares(w)
        return 1 - straight - m["specular"] * share

    share, straight = shares(nodes)
    least = (1 - straight).min() * (1 - m["specular"]) + (1 - straight - share).min() * m["specular"]
    mean = rest(nodes) @ weight
    own = [seen(m["normal"], m["horizon"], w) for w in (wo, wi)]
    mean_own = seen(m["normal"], m["horizon"], nodes) @ weight
    # By the cosine to the yarn's normal, what gets away past the next yarn: between its own plane and the horizon
    lean = np.arctan2(np.linalg.norm(m["normal"][:2]), m["normal"][2])
    away = (1 + np.sin(np.arctan(m["horizon"]) - lean)) / 2
    here = m["diffuse"] * away / (1 - m["diffuse"] * (1 - away))
    f = here * least * own[0] * own[1] / mean_own + m["diffuse"] * (
        least * (1 - own[0]) * (1 - own[1]) / (1 - mean_own) + (rest(wo) - least) * (rest(wi) - least) / (mean - least))
    return (1 - m["through"]) * f * wi[..., 2] / np.pi
