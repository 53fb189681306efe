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


def met_once(axis, alpha, thickness, wo, wi):
    """K: Wang et al. 2022, eqs. 10 and 11, where light that returns finds the way open on which it came: it is shadowed
    by the longer way alone."""
    o, i = area(axis, alpha, wo) / np.abs(wo[..., 2]), area(axis, alpha, wi) / np.abs(wi[..., 2])
    longer = np.maximum(o, i)
    back = (1 - np.exp(-thickness * longer)) / longer
    forth = (np.exp(-thickness * o) - np.exp(-thickness * i)) / (i - o)
    return np.where(wo[..., 2] * wi[..., 2] > 0, back, forth)


def azimuth(axis, wo, wi):
    """Between both directions, about the axis."""
    o, i = (w - (w * axis).sum(axis=-1, keepdims=True) * axis for w in (wo, wi))
    return np.arctan2(np.linalg.norm(np.cross(o, i), axis=-1), (o * i).sum(axis=-1))


def mirrored(axis, alpha, thickness, wo, wi):
    """f |cos| of light that the layer mirrors once, for fibres that mirror all of it at most."""
    h = wo + wi
    h = h / np.linalg.norm(h, axis=-1, keepdims=True)
    fresnel = 0.392 + 0.608 * np.sqrt(2) * np.abs(np.sin(azimuth(axis, wo, wi) / 4))
    return fresnel * density(axis, alpha, h) / (4 * np.abs(wo[..., 2])) * met_once(axis, alpha, thickness, wo, wi)


def entered(axis, alpha, thickness, wo, wi):
    """f |cos| of light that leaves after it has entered one fibre, by a sum over Chebyshev's polynomials of the second
    kind: that of white fibres which mirror nothing; straight through, and reflected inside."""
    s, t = (wo * axis).sum(axis=-1), -(wi * axis).sum(axis=-1)
    phi, a, b = azimuth(axis, wo, wi), np.arccos(s), np.arccos(t)
    found = []
    for r, power, shift, share in ((0.82, 4, np.pi, 0.932), (0.268, 16, 0.0, 0.068)):
        kernel = sum(r**n * np.sin((n + 1) * a) * np.sin((n + 1) * b) for n in range(80))  # times sin a sin b
        x = np.linspace(-np.pi, np.pi, 2000, endpoint=False)
        about = np.cos((phi - shift) / 2)**(2 * power) / (np.cos(x / 2)**(2 * power)).mean() / (2 * np.pi)
        found.append(2 / np.pi * kernel * about * share)
    return sum(found) / np.abs(wo[..., 2]) * met_once(axis, alpha, thickness, wo, wi)


def straight(axis, alpha, thickness, wo):
    return np.exp(-thickness * area(axis, alpha, wo) / np.abs(wo[..., 2]))


def share(light, axis, alpha, thickness, wo, sphere):
    """m(wo) or n(wo), of `mirrored` or `entered`, by quadrature over the sphere."""
    wi, weight = sphere
    return (light(axis[..., None, :], alpha, thickness, wo[..., None, :], wi) * weight).sum(axis=-1)


def seen(normal, horizon, w):
    """s(w): of light from w the share that falls on the yarn."""
    slope = np.linalg.norm(normal[:2]) / normal[2]
    lean = w[..., :2] @ normal[:2] / (normal[2] * w[..., 2])
    return np.where(lean > slope * horizon, 0, np.clip(1 + lean, 0, 1))


def diffuse(m, shares, wo, wi, hemisphere):
    """f |cos|, for one channel and wo and wi on the side of the yarn's normal; `shares` is a function that gives m, n
    and exp(-T Lambda), `hemisphere` nodes and weights for means."""
    nodes, weight = hemisphere
    weight = weight * nodes[:, 2] / np.pi

    def rest(w):
        mirrored, entered, straight = shares(w)
        return 1 - straight - m["specular"] * mirrored - (1 - m["specular"]) * entered

    mirrored, entered, straight = shares(nodes)
    least = (1 - straight - entered).min() * (1 - m["specular"]) + (1 - straight - mirrored).min() * m["specular"]
    mean = rest(nodes) @ weight
    own = [seen(m["normal"], m["horizon"], w) for w in (wo, wi)]
    mean_own = seen(m["normal"], m["horizon"], nodes) @ weight
    # By the cosine to the yarn's normal, what gets away past the next yarn: between its own plane and the horizon
    lean = np.arctan2(np.linalg.norm(m["normal"][:2]), m["normal"][2])
    away = (1 + np.sin(np.arctan(m["horizon"]) - lean)) / 2
    c = m["diffuse"]
    here = away / (1 - c * (1 - away))
    shape = here * own[0] * own[1] / mean_own + (1 - own[0]) * (1 - own[1]) / (1 - mean_own) - 1
    f = least * (layer_back(m, wo, wi) + layer_least(m) * shape)
    f += (c - layers(m)[2]) * (rest(wo) - least) * (rest(wi) - least) / (mean - least)
    return f * wi[..., 2] / np.pi


def layer(c, t):
    """gamma, w, what a half space reflects, what goes through a layer, and what is therefore missing in its
    reflection, for t below 0.6."""
    g = (1 - c) / (1 + 2.5 * c)
    w, r, x = 1 - g * g, (1 - g) / (1 + g), np.exp(-3.5 * g * (7 / (9 * t) - 1))
    through = 7 / 9 * w * (1 - c * c) * x / (1 - c * c * x * x)
    return g, w, r, through, c * x * through


def layers(m):
    """gamma and w of the upper one of two layers, and what is missing in the reflection of both. Light goes to and fro
    between them: a sum over the times it does."""
    g, w, r, through, missing = layer(m["diffuse"], m["through"])
    _, _, r2, _, missing2 = layer(m["below"], m["below_through"])
    lower, upper = r2 - missing2, r - missing
    return g, w, missing - sum(through * lower * (upper * lower)**k * through for k in range(400))


def layer_back(m, wo, wi):
    """pi f of a layer of fibres over another."""
    c = m["diffuse"]
    g, w, missing = layers(m)
    o, i = wo[..., 2], wi[..., 2]
    h = [(1 + 2 * mu) / (1 + 2 * g * mu) for mu in (o, i)]
    scale = 1 / (1.5 * np.log(2))
    half_space = scale * w / 4 * (h[0] * h[1] - (wo[..., :2] * wi[..., :2]).sum(axis=-1)) / (o + i)
    node, weight = (part / 2 for part in np.polynomial.legendre.leggauss(200))
    node = node + 0.5

    def lacking(mu):
        white = (1 + 2 * mu[..., None]) / 2 * (1 + 2 * node) * node / (mu[..., None] + node)
        return 1 - scale * (white * weight).sum(axis=-1)

    mean = 2 * (lacking(node) * node * weight).sum()
    k = [3 / 7 * (1 + 2 * mu) for mu in (o, i)]
    return half_space + c * lacking(o) * lacking(i) / mean - missing * k[0] * k[1]


def layer_least(m):
    """What that exceeds everywhere."""
    g, w, missing = layers(m)
    return max(w * (1 - g) / (1 + 2 * g) / 2 / (1.5 * np.log(2)) - max(missing, 0) * (9 / 7)**2, 0)
