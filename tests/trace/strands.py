"""Strands that bend, taper and cross each other."""

from __future__ import annotations

import numpy as np

from viewer.scene.curves import Curves


def strands(count: int = 8, points: int = 6, radius: float = 0.1, seed: int = 0) -> tuple[Curves, ...]:
    """Two sets of bent strands that taper to the tip and cross each other, one of them closed."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0, 1, points)[None, :, None]
    start, step, bend = (rng.normal(size=(count, 1, 3)) for _ in range(3))
    at = 0.3 * start + 0.8 * step * (s - 0.5) + 0.3 * np.sin(4 * s + start) * bend
    sets = []
    for k, part in enumerate((slice(0, count // 2), slice(count // 2, count))):
        line = at[part].reshape(-1, 3)
        number = len(line) // points
        radii = np.tile(radius * (1 - 0.6 * s.ravel()), number)
        closed = (np.arange(number) == 0) & (k == 1)
        sets.append(Curves(f"set {k}", line, radii, points * np.arange(number + 1), closed))
    return tuple(sets)


def straight(radius: float, *, y: float = 0.0, half: float = 1.0, colors: object = None) -> Curves:
    """One fibre along x, its tip at +x."""
    points = np.float32([[-half, y, 0], [half, y, 0]])
    given = None if colors is None else np.float32([colors, colors])
    return Curves("fibre", points, np.full(2, radius, np.float32), np.array([0, 2]), np.array([False]), colors=given)
