"""The walls of glass that are drawn apart, so that they show each other."""

from __future__ import annotations

from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .model import SOLID, THIN_WALLED, Draw, Plan

MOST_WALLS = 256
"""Of more of a kind in the picture, all share one layer: to sort them would take longer than to draw them."""


def has_two_walls(draw: Draw, mesh: Mesh) -> bool:
    """Whether it is a thin wall that may turn both of its sides to the camera: it is no plane."""
    return draw.transmits == THIN_WALLED and draw.surface.double_sided and not _is_plane(mesh)


def walls_in_one_layer(plan: Plan, scene: Scene) -> list[str]:
    """What to say of walls that show none of their kind behind them, since there are too many in sight of all."""
    lines = []
    for kind, name in ((THIN_WALLED, "thin walls"), (SOLID, "solids")):
        draws = [draw for draw in plan.draws if draw.transmits == kind and draw.alpha_mode != "blend"]
        count = sum(1 + has_two_walls(draw, scene.meshes[draw.mesh]) for draw in draws)
        if count > MOST_WALLS:
            lines.append(f"{name} of glass behind others, where more than {MOST_WALLS} of {count} are in the picture")
    return lines


def _is_plane(mesh: Mesh) -> bool:
    """Whether its box has no depth along an axis, so that it turns one side to the camera."""
    low, high = mesh.bounds
    return bool(((high - low) <= 1e-6 * (high - low).max()).any())
