"""A scene whose curves are yarns, as the settings `yarn...` ask for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from ...settings import Settings
from ..curves import Curves
from ..fibre import Fibre, gives_color, hair_fibre
from ..scene import Scene
from .fibres import yarn_fibres
from .kind import YARNS, YarnKind

Made = TypeVar("Made")


def spun(scene: Scene, settings: Settings) -> Scene:
    """`scene`, or a copy in which the fibres of yarns stand for its curves. The same curves and settings give the very
    same fibres, also in other scenes. Raises UsageError for too many segments."""
    if settings.yarn == "off" or not scene.curves:
        return scene
    kind = yarn_kind(settings)

    def made(curves: Curves) -> Curves:
        colored = _colored(curves, kind, settings)
        return _kept(curves, "_spun", (kind, colored.fibre, colored.colors is None), lambda: yarn_fibres(colored, kind))

    return replace(scene, curves=tuple(made(curves) for curves in scene.curves))


def as_yarns(scene: Scene, settings: Settings) -> Scene:
    """`scene`, or a copy whose curves, the axes of yarns, have the fibres and colours of their yarn. Calls with one
    scene and the same settings return the same object, and the same curves are the same in all scenes."""
    if settings.yarn == "off" or all(curves.fibre is not None for curves in scene.curves):
        return scene
    kind = yarn_kind(settings)
    key = yarn_fibre(kind, settings), gives_color(settings)

    def colored(curves: Curves) -> Curves:
        return _kept(curves, "_yarn", key, lambda: _colored(curves, kind, settings))

    return _kept(scene, "_yarns", key, lambda: replace(scene, curves=tuple(map(colored, scene.curves))))


def dense_curves(scene: Scene, settings: Settings) -> tuple[Curves, ...]:
    """The curves, of which yarns are as thick as all their fibres beside each other."""
    if settings.yarn == "off":
        return scene.curves
    kind = yarn_kind(settings)
    widths = np.float32(kind.plies * kind.fibres * kind.radius)
    return tuple(replace(curves, radii=widths * curves.radii) for curves in scene.curves)


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


def _colored(curves: Curves, kind: YarnKind, settings: Settings) -> Curves:
    if curves.fibre is not None:
        return curves
    colors = None if gives_color(settings) else curves.colors
    return replace(curves, fibre=yarn_fibre(kind, settings), colors=colors)


def _kept(source: Curves | Scene, name: str, key: object, make: Callable[[], Made]) -> Made:
    """What has been made of `source` last, under the name, or is made if the key differs."""
    known: tuple[object, Made] | None = source.__dict__.get(name)
    if known is None or known[0] != key:
        known = source.__dict__[name] = key, make()
    return known[1]
