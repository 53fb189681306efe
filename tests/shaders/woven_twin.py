"""What shaders/bsdf/weave should give, in float64 from Heitz et al. 2015 and Wang et al. 2022."""

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
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    o, i = area(axis, alpha, wo) / np.abs(wo[..., 2]), area(axis, alpha, wi) / np.abs(wi[..., 2])
    back = (1 - np.exp(-thickness * (o + i))) / (o + i)
    forth = (np.exp(-thickness * o) - np.exp(-thickness * i)) / (i - o)
    return density(axis, alpha, h) / (4 * np.abs(wo[..., 2])) * np.where(wo[..., 2] * wi[..., 2] > 0, back, forth)


def straight(axis, alpha, thickness, wo):
    return np.exp(-thickness * area(axis, alpha, wo) / np.abs(wo[..., 2]))
