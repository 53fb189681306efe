"""The ground below a scene, on which shadows fall."""

from __future__ import annotations

from .scene import Scene


def ground_height(scene: Scene) -> float:
    """Where its plane lies along +Y: under the box of all that is drawn, by a hundred-thousandth of its radius."""
    return float(scene.bounds[0, 1]) - 1e-5 * scene.radius
