"""A scene whose curves are yarns, as the settings `yarn...` ask for."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ...settings import Settings
from ..curves import Curves
from ..fibre import Fibre, gives_color, hair_fibre
from ..scene import Scene
from .fibres import yarn_fibres
from .kind import YARNS, YarnKind


def spun(scene: Scene, settings: Settings) -> Scene:
    """`scene`, or a copy in which the fibres of yarns stand for its curves. The same curves and settings give the very
    same fibres, also in other scenes. Raises UsageError for too many segments."""
    if settings.yarn == "off" or not scene.curves:
        return scene
    return replace(scene, curves=tuple(_spun(curves, yarn_kind(settings), settings) for curves in scene.curves))


def yarn_kind(settings: Settings) -> YarnKind:
    """The kind of yarn that the settings describe."""
    given = {"plies": settings.yarn_plies, "fibres": settings.yarn_fibres, "twist": settings.yarn_twist,
             "hairs": settings.yarn_hairs}
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    return replace(YARNS[settings.yarn], **changes)


def yarn_fibre(kind: YarnKind, settings: Settings) -> Fibre:
    """What its fibres do to light. Settings `hair-...` count where they differ from their defaults."""
    default = Settings()
    changes: dict[str, Any] = {}
    if gives_color(settings):
        changes["sigma_a"] = hair_fibre(settings).sigma_a
    if settings.hair_roughness != default.hair_roughness:
        changes["beta_m"], changes["beta_n"] = settings.hair_roughness
    if settings.hair_tilt != default.hair_tilt:
        changes["tilt"] = math.radians(settings.hair_tilt)
    if settings.hair_ior != default.hair_ior:
        changes["ior"] = settings.hair_ior
    return replace(kind.fibre, **changes)


def _spun(curves: Curves, kind: YarnKind, settings: Settings) -> Curves:
    """The fibres of a set of curves. The last ones are kept with it."""
    fibre = curves.fibre or yarn_fibre(kind, settings)
    key = kind, fibre, gives_color(settings)
    known: tuple[object, Curves] | None = curves.__dict__.get("_spun")
    if known is None or known[0] != key:
        colors = None if gives_color(settings) and curves.fibre is None else curves.colors
        made = yarn_fibres(replace(curves, fibre=fibre, colors=colors), kind)
        known = curves.__dict__["_spun"] = key, made
    return known[1]
