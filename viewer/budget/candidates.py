"""The pictures of the raster that a time budget is spent on, one after the other."""

from __future__ import annotations

from dataclasses import replace

from ..measure.report.ladder import PLAIN, SHADOWS, Method
from ..scene.scene import Scene
from ..settings import Settings

HELD = Method(*SHADOWS, {"environment_shadows": "64", "antialias": "none"})
"""Is cheap as long as its shadow maps are there, from a picture before."""
CANDIDATES = (
    Method(PLAIN.name, PLAIN.title, {"antialias": "none"}),
    Method(PLAIN.name, PLAIN.title, {"antialias": "ssaa-4"}),
    HELD,
    *(Method(*SHADOWS, {"environment_shadows": count, "antialias": antialias})
      for count, antialias in (("16", "ssaa-4"), ("64", "ssaa-4"), ("64", "ssaa-9"))),
)
"""The methods of the raster that a picture is made by in turn while there is time, each better than the one before at a
small price, but for HELD. Supersampling needs no programs beyond those of the first; MSAA does, on Mesa."""


def candidates_for(scene: Scene, settings: Settings) -> list[tuple[str, Settings]]:
    """The title and the settings of those of CANDIDATES that apply to `scene`. What the user has set stays as it is."""
    default = Settings()
    is_lit = scene.environment is not None
    found: dict[Settings, str] = {}
    for method in CANDIDATES:
        changes = {name: value for name, value in method.changes.items()
                   if getattr(settings, name) == getattr(default, name)
                   and (name != SHADOWS[0].replace("-", "_") or (is_lit and scene.instances))}
        if method is HELD and len(changes) < len(method.changes):
            continue
        title = method.title if len(changes) == len(method.changes) else PLAIN.title
        found.setdefault(replace(settings, **changes),
                         replace(method, title=title if is_lit else "raster", changes=changes).label)
    return [(title, changed) for changed, title in found.items()]
