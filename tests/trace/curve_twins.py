"""Round segments in float64, without the formulas of shaders/trace/curve.glsl: as the union of all spheres between the
two ends."""

from __future__ import annotations

import numpy as np

_SPHERES = 129


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.sum(a * b, axis=-1)


def _at(segments: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Spheres (n, k, 4) of segments (n, 2, 4) at the places along (n, k)."""
    return segments[:, :1] + along[..., None] * (segments[:, 1:] - segments[:, :1])


def _least(value, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where value(x), (n, 1) each, is least between the bounds (n, 1), by ternary search: it has one minimum there."""
    for _ in range(60):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        left = value(a) <= value(b)
        low, high = np.where(left, low, a), np.where(left, b, high)
    return (low + high) / 2


def entry(o: np.ndarray, d: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The t (n,) at which lines o + t d, (n, 3) each, enter segments (n, 2, 4), infinite where they miss, and the place
    on the axis of the sphere that is entered."""
    o, d, segments = (np.asarray(x, np.float64) for x in (o, d, segments))

    def sphere(along: np.ndarray) -> np.ndarray:
        center = _at(segments, along)
        w = o[:, None] - center[..., :3]
        b, per = _dot(w, d[:, None]), 1 / _dot(d, d)[:, None]
        flat = w - (b * per)[..., None] * d[:, None]
        inside = center[..., 3] ** 2 - _dot(flat, flat)
        return np.where(inside >= 0, -b * per - np.sqrt(np.maximum(inside, 0) * per), np.inf)

    grid = np.broadcast_to(np.linspace(0, 1, _SPHERES), (len(o), _SPHERES))
    # The spheres that the line meets are those in an interval, in which t is convex.
    best = np.take_along_axis(grid, sphere(grid).argmin(axis=1)[:, None], axis=1)
    low, high = np.maximum(best - 1 / (_SPHERES - 1), 0), np.minimum(best + 1 / (_SPHERES - 1), 1)
    along = _least(sphere, low, high)
    along = np.where(sphere(best) < sphere(along), best, along)
    return sphere(along)[:, 0], along[:, 0]


def closeness(o: np.ndarray, d: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """The distance (n,) of the lines from the surfaces, negative for lines that cross."""
    o, d, segments = (np.asarray(x, np.float64) for x in (o, d, segments))

    def distance(along: np.ndarray) -> np.ndarray:
        center = _at(segments, along)
        w = o[:, None] - center[..., :3]
        flat = w - (_dot(w, d[:, None]) / _dot(d, d)[:, None])[..., None] * d[:, None]
        return np.linalg.norm(flat, axis=-1) - center[..., 3]

    along = _least(distance, np.zeros((len(o), 1)), np.ones((len(o), 1)))
    return distance(along)[:, 0]


def depth(p: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """How deep points (n, 3) are in segments, (n,), negative outside."""
    p, segments = np.asarray(p, np.float64), np.asarray(segments, np.float64)

    def distance(along: np.ndarray) -> np.ndarray:
        center = _at(segments, along)
        return np.linalg.norm(p[:, None] - center[..., :3], axis=-1) - center[..., 3]

    return -distance(_least(distance, np.zeros((len(p), 1)), np.ones((len(p), 1))))[:, 0]


def random_rays(count: int, radius: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rays o, d (count, 3) float32 from within 2 of the origin, past segments (count, 2, 4) float32 of about this
    radius in the unit ball: most of them cross, some along the axis."""
    rng = np.random.default_rng(seed)

    def unit() -> np.ndarray:
        v = rng.normal(size=(count, 3))
        return v / np.linalg.norm(v, axis=1, keepdims=True)

    length = radius * 10.0 ** rng.uniform(-1, 3, count)
    length = np.minimum(length, 1.0)
    axis = unit()
    middle = 0.5 * rng.uniform(0, 1, (count, 1)) * unit()
    segments = np.empty((count, 2, 4))
    segments[:, 0, :3], segments[:, 1, :3] = (middle + side * length[:, None] * axis for side in (-0.5, 0.5))
    segments[..., 3] = radius * rng.uniform(0.2, 1, (count, 2))
    segments = segments.astype(np.float32)
    goal = segments[:, 0, :3] + rng.uniform(-0.02, 1.02, (count, 1)) * (segments[:, 1, :3] - segments[:, 0, :3])
    goal = goal + 1.1 * radius * rng.uniform(-1, 1, (count, 1)) * unit()
    direction = unit()
    along = np.arange(count) % 5 == 0  # nearly along the axis
    direction[along] = axis[along] + 10.0 ** rng.uniform(-6, 0, (along.sum(), 1)) * direction[along]
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origin = (goal - 10.0 ** rng.uniform(-2, 0.2, (count, 1)) * direction).astype(np.float32)
    direction = (goal - origin) / np.linalg.norm(goal - origin, axis=1, keepdims=True)
    return origin, direction.astype(np.float32), segments
