"""The choice of a light by the tree in float64, from the texels that shaders/trace/light_tree.glsl reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from viewer.trace import layout

CORE, LEAST_COSINE, NORMAL_SLACK = 0.4, 0.1, 0.003


@dataclass(frozen=True, eq=False)
class Nodes:
    """N nodes, decoded."""

    center: np.ndarray
    radius: np.ndarray
    intensity: np.ndarray
    axis: np.ndarray
    spread: np.ndarray
    reach: np.ndarray
    is_two_sided: np.ndarray
    is_narrow: np.ndarray
    has_lamp: np.ndarray
    link: np.ndarray


def decode(texels: np.ndarray) -> Nodes:
    t = texels.reshape(-1, 2, 4)
    floats = t.view(np.float32).astype(np.float64)
    bits = t[:, 1, 2].astype(np.int64)
    flags, reach = bits >> layout.LIGHT_FLAG_SHIFT & 7, bits >> 16
    p = np.column_stack([t[:, 1, 1] & 0xFFFF, t[:, 1, 1] >> 16]) / 32767.0 - 1
    z = 1 - np.abs(p).sum(axis=1)
    folded = (1 - np.abs(p[:, ::-1])) * np.where(p >= 0, 1, -1)
    axis = np.column_stack([np.where(z[:, None] < 0, folded, p), z])
    cosine = (bits & layout.LIGHT_COSINE_STEPS) * 2 / layout.LIGHT_COSINE_STEPS - 1
    return Nodes(floats[:, 0, :3], floats[:, 0, 3], floats[:, 1, 0], axis / np.linalg.norm(axis, axis=1, keepdims=True),
                 np.arccos(cosine), np.where(reach == 0xFFFF, np.inf, 2.0 ** (
                     reach / layout.LIGHT_REACH_STEPS - layout.LIGHT_REACH_LOW)),
                 flags & layout.LIGHT_TWO_SIDED > 0, flags & layout.LIGHT_NARROW > 0, flags & layout.LIGHT_LAMP > 0,
                 t[:, 1, 3].astype(np.int64))


def at_point(nodes: Nodes, p: np.ndarray, n: np.ndarray) -> np.ndarray:
    """The importance of each node for a point (3,) with a normal (3,), which may be 0; by angles."""
    to_center = nodes.center - p
    distance = np.maximum(np.linalg.norm(to_center, axis=1), 1e-15)
    way = to_center / distance[:, None]
    sphere = np.where(nodes.radius < distance, np.arcsin(np.minimum(nodes.radius / distance, 1)), np.pi)
    core = CORE * nodes.radius / distance
    cosine = -(nodes.axis * way).sum(axis=1)
    cosine = np.clip(np.where(nodes.is_two_sided, np.abs(cosine), cosine), -1, 1)
    beyond = np.maximum(np.arccos(cosine) - nodes.spread, 0)
    ramp = (np.minimum(cosine + core, 1) - np.cos(nodes.spread)) / np.maximum(1 - np.cos(nodes.spread), 1e-4)
    leaving = np.where(nodes.is_narrow, ramp, np.cos(beyond) + core)
    is_lit = np.where(nodes.is_narrow, beyond <= sphere, beyond - sphere < np.pi / 2)
    arriving = np.ones(len(distance))
    if n.any():
        is_lit &= (way @ n + NORMAL_SLACK) * distance > -nodes.radius
        arriving = np.clip(way @ n + core, LEAST_COSINE, 1)
    window = np.maximum(1 - (np.maximum(distance - nodes.radius, 0) / nodes.reach) ** 4, 0)
    weight = nodes.intensity * np.clip(leaving, LEAST_COSINE, 1) * arriving * window
    return np.where(is_lit, weight / np.maximum(np.maximum(distance, CORE * nodes.radius) ** 2, 1e-8), 0)


def along_ray(nodes: Nodes, o: np.ndarray, d: np.ndarray, way: float) -> np.ndarray:
    """The importance of each node for a ray of that length."""
    t = (nodes.center - o) @ d
    h = np.maximum(np.linalg.norm(nodes.center - o - t[:, None] * d, axis=1), 1e-5 * way)
    closest = np.maximum(h, CORE * nodes.radius)
    angle = np.arctan((way - t) / closest) + np.arctan(t / closest)
    nearest = np.linalg.norm(o + np.clip(t, 0, way)[:, None] * d - nodes.center, axis=1) - nodes.radius
    window = np.maximum(1 - (np.maximum(nearest, 0) / nodes.reach) ** 4, 0)
    return np.where(nodes.has_lamp, nodes.intensity * angle / closest * window, 0)


def probabilities(nodes: Nodes, importance: np.ndarray) -> tuple[dict[int, float], float]:
    """That of each light, by its number, and that of none."""
    both = importance.reshape(-1, 2)
    total = both.sum(axis=1, keepdims=True)
    chance = np.where(total > 0, both / np.where(total > 0, total, 1), 0)
    found, nothing, level = {}, 0.0, [(0, 1.0)]
    while level:
        below = []
        for pair, probability in level:
            nothing += probability * (1 - chance[pair].sum())
            for side in (0, 1):
                link = int(nodes.link[2 * pair + side])
                if link & layout.LIGHT_LEAF:
                    found[link & ~layout.LIGHT_LEAF] = probability * chance[pair, side]
                else:
                    below.append((link, probability * chance[pair, side]))
        level = below
    return found, nothing
