"""A scene some of whose materials are woven, as the setting `weave` asks for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..errors import UsageError
from ..settings import Settings
from .material import Material
from .scene import Scene
from .weave import WEAVES, Weave, read_weave

_last: list[tuple[tuple[Material, ...], Weave, str, tuple[Material, ...]]] = []
"""The last materials that were woven: scenes that share materials, as the poses of one do, share woven ones, too."""


def woven(scene: Scene, settings: Settings) -> Scene:
    """`scene`, or a copy whose materials, or the one that the setting names, are woven of the setting's weave.

    Raises InputError for a weave's file that cannot be read, UsageError for a material that does not exist or meshes
    without texture coordinates.
    """
    if settings.weave == "off" or settings.mode == "phong":
        return scene
    which, _, name = settings.weave.partition(",")
    weave = WEAVES.get(which) or read_weave(Path(which))
    if any(scene.materials is made for *_, made in _last):
        return scene
    known: dict[tuple[Weave, str], Scene] = scene.__dict__.setdefault("_woven", {})
    if (weave, name) not in known:
        known.clear()
        known[weave, name] = replace(scene, materials=_shared(scene, weave, name))
    return known[weave, name]


def _shared(scene: Scene, weave: Weave, name: str) -> tuple[Material, ...]:
    for source, held, only, made in _last:
        if source is scene.materials and held == weave and only == name:
            return made
    made = _materials(scene, weave, name)
    _last[:] = [(scene.materials, weave, name, made)]
    return made


def _materials(scene: Scene, weave: Weave, name: str) -> tuple[Material, ...]:
    names = [material.name for material in scene.materials]
    if name and name not in names:
        listed = ", ".join(repr(known) for known in names if known)
        raise UsageError(f"weave: there is no material {name!r} in {scene.name!r}; "
                         + (f"there are {listed}" if listed else "none of its materials has a name"))
    chosen = {k for k, known in enumerate(names) if not name or known == name}
    for mesh in scene.meshes:
        if mesh.material in chosen and not mesh.uvs and mesh.topology == "triangles":
            raise UsageError(f"weave: mesh {mesh.name!r} has no texture coordinates, by which yarns are laid")
    # The colour is for passes that know no weaves: traced reflections, and the guides of denoisers.
    cloth = Material(base_color=(*weave.mean_color, 1.0), metallic=0.0, perceptual_roughness=1.0, double_sided=True,
                     weave=weave, alpha_mode="blend" if weave.has_gaps else "opaque")
    return tuple(replace(cloth, name=names[k]) if k in chosen else material
                 for k, material in enumerate(scene.materials))
