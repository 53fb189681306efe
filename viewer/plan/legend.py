"""What the colours of a view mean, in words with numbers: for the window, `--stats` and `-v`."""

from __future__ import annotations

import numpy as np

from ..image.magma import magma
from ..scene.camera import Camera
from ..scene.depth_span import depth_span
from ..scene.ground_grid import GroundGrid
from ..scene.scene import Scene
from ..settings import Settings, Show

VIEW_NAMES: dict[Show, str] = {
    "shaded": "Shaded", "base-color": "Base colour", "normal": "Shading normals",
    "geometric-normal": "Normals of triangles", "roughness": "Roughness", "metalness": "Metalness",
    "uv": "Texture coordinates", "depth": "Depth", "overdraw": "Overdraw", "wireframe": "Wireframe"}
_NORMALS = "red, green and blue are (n + 1) / 2 of x, y and z"
_MEANINGS: dict[Show, str] = {
    "normal": _NORMALS, "geometric-normal": _NORMALS, "roughness": "black 0, white 1", "metalness": "black 0, white 1",
    "uv": "red u, green v, blue a checker of eighths",
    "overdraw": "fragments drawn in a pixel, dark 1 to pale 8 or more"}


def legend(scene: Scene, camera: Camera, settings: Settings) -> tuple[str, ...]:
    """A line for each thing in the picture that needs one; none for a shaded picture."""
    show = settings.show
    if show in ("shaded", "wireframe"):
        spacing = f"{GroundGrid.under(scene).spacing:g}" if settings.grid == "on" else ""
        return (f"Grid: {spacing} m; x red, y green, z blue",) if spacing else ()
    meaning = _MEANINGS.get(show, "")
    if show == "depth":
        near, far = depth_span(scene, camera)
        meaning = f"white at {near:.4g} m, black at {far:.4g} m"
    return (f"{VIEW_NAMES[show]}{': ' if meaning else ''}{meaning}",)


def overdraw_colors() -> np.ndarray:
    """The sRGB codes of the counts 1, 2, … of fragments, (8, 3) uint8. The last one is also that of greater counts."""
    return magma(np.linspace(0.2, 1.0, 8)[None])[0]
