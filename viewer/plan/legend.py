"""What the colours of a view mean, in words with numbers: for the window, `--stats` and `-v`."""

from __future__ import annotations

from ..scene.camera import Camera
from ..scene.depth_span import depth_span
from ..scene.scene import Scene
from ..settings import Settings, Show

VIEW_NAMES: dict[Show, str] = {
    "shaded": "Shaded", "base-color": "Base colour", "normal": "Shading normals",
    "geometric-normal": "Normals of triangles", "roughness": "Roughness", "metalness": "Metalness",
    "uv": "Texture coordinates", "depth": "Depth"}
_NORMALS = "red, green and blue are (n + 1) / 2 of x, y and z"
_MEANINGS: dict[Show, str] = {
    "normal": _NORMALS, "geometric-normal": _NORMALS, "roughness": "black 0, white 1", "metalness": "black 0, white 1",
    "uv": "red u, green v, blue a checker of eighths"}


def legend(scene: Scene, camera: Camera, settings: Settings) -> tuple[str, ...]:
    """A line for each thing in the picture that needs one; none for a shaded picture."""
    show = settings.show
    if show == "shaded":
        return ()
    meaning = _MEANINGS.get(show, "")
    if show == "depth":
        near, far = depth_span(scene, camera)
        meaning = f"white at {near:.4g} m, black at {far:.4g} m"
    return (f"{VIEW_NAMES[show]}{': ' if meaning else ''}{meaning}",)
