"""KHR_animation_pointer: what a JSON pointer moves. Those of materials follow from the declaration of materials."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

from ..animation import Target
from ..material import METALLIC_ROUGHNESS, SPECULAR_GLOSSINESS
from ..parameter import Feature
from ..schema import MAPS, PARAMETERS
from .element import Element
from .nodes import VISIBILITY
from .specular_glossiness import FACTORS

_TRANSFORM = "extensions/KHR_texture_transform"
_GLOSSY = f"extensions/{SPECULAR_GLOSSINESS.extension}"
_STRENGTH = "extensions/KHR_materials_emissive_strength/emissiveStrength"


@dataclass(frozen=True)
class Property:
    """A property of a kind of things: its name in `Target`, the type of its values, and how many numbers they have.
    `needs` is the JSON object, below the thing, without which the file does not have it, and `unless` the one that
    takes its place. A property without a name is one that no picture depends on.
    """

    name: str
    kind: str
    size: int
    needs: str = ""
    unless: str = ""


def _of_materials() -> dict[str, Property]:
    """By the pointer below the material."""
    found = {_STRENGTH: Property("emissive_strength", "SCALAR", 1, _STRENGTH.rpartition("/")[0])}
    for parameter in PARAMETERS.values():
        place = _place(parameter.info.feature)
        path = "/".join([*place, *parameter.info.key.split(".")])
        texture = parameter.info.key.rpartition(".")[0]
        unless = _GLOSSY if parameter.info.feature is METALLIC_ROUGHNESS or parameter.name == "specular_color" else ""
        found[path] = Property(parameter.name, _kind(parameter.size), parameter.size,
                               _needs([*place, *[texture] * bool(texture)]), unless)
    for name, source in MAPS.items():
        info = "/".join([*_place(source.info.feature), source.info.key])
        found |= _of_texture(name, info, _GLOSSY if source.info.feature is METALLIC_ROUGHNESS else "")
    found |= _of_texture("base_color", f"{_GLOSSY}/diffuseTexture")
    for key, (name, size) in FACTORS.items():
        found[f"{_GLOSSY}/{key}"] = Property(name, _kind(size), size, _GLOSSY)
    return found


def _of_texture(name: str, info: str, unless: str = "") -> dict[str, Property]:
    """Those of the transform of a map, whose texture info is at `info`."""
    return {f"{info}/{_TRANSFORM}/{key}": Property(f"{name}_texture.{key}", _kind(size), size, f"{info}/{_TRANSFORM}",
                                                   unless)
            for key, size in (("offset", 2), ("rotation", 1), ("scale", 2))}


def _kind(size: int) -> str:
    return "SCALAR" if size == 1 else f"VEC{size}"


def _place(feature: Feature) -> list[str]:
    return ["extensions", feature.extension] * bool(feature.extension) + [feature.place] * bool(feature.place)


def _needs(place: list[str]) -> str:
    """The part of glTF 2.0 itself may be missing: all of its properties have defaults."""
    return "" if place == ["pbrMetallicRoughness"] else "/".join(place)


_LIGHT = {
    "color": Property("color", "VEC3", 3), "intensity": Property("intensity", "SCALAR", 1),
    "range": Property("range", "SCALAR", 1), "spot/innerConeAngle": Property("inner_cone", "SCALAR", 1),
    "spot/outerConeAngle": Property("outer_cone", "SCALAR", 1),
}
_CAMERA = {
    "perspective/yfov": Property("fov_y", "SCALAR", 1, "perspective"),
    "perspective/znear": Property("near", "SCALAR", 1, "perspective"),
    "orthographic/ymag": Property("ymag", "SCALAR", 1, "orthographic"),
} | {f"{kind}/{key}": Property("", "SCALAR", 1, kind)  # what cameras.py ignores
     for kind, keys in (("perspective", ("aspectRatio", "zfar")), ("orthographic", ("xmag", "znear", "zfar")))
     for key in keys}
_NODE = {
    "translation": Property("translation", "VEC3", 3), "rotation": Property("rotation", "VEC4", 4),
    "scale": Property("scale", "VEC3", 3), "weights": Property("weights", "SCALAR", 0),
    f"extensions/{VISIBILITY}/visible": Property("visible", "SCALAR", 1, f"extensions/{VISIBILITY}"),
}
_KINDS: tuple[tuple[str, str, dict[str, Property]], ...] = (
    ("node", "nodes", _NODE), ("mesh", "meshes", {"weights": _NODE["weights"]}),
    ("material", "materials", _of_materials()), ("camera", "cameras", _CAMERA),
    ("light", "extensions/KHR_lights_punctual/lights", _LIGHT),
)


class Pointers:
    """The pointers of a file, of whose JSON `root` is the root."""

    def __init__(self, root: Element) -> None:
        self._root = root

    def resolve(self, pointer: str) -> tuple[list[Target], Property] | None:
        """The targets of a pointer and what they take; None if the file has nothing there, or nothing that is drawn.
        There are no targets if no node shows the thing, or no picture depends on its property.

        The weights of a mesh are those of all nodes that show it and have none of their own.
        """
        for kind, array, properties in _KINDS:
            match = re.fullmatch(rf"/{array}/(0|[1-9][0-9]{{0,8}})/(.+)", pointer)
            if match is None:
                continue
            number, path = int(match[1]), match[2]
            items = _at(self._root.value, array)
            if not isinstance(items, list) or number >= len(items):
                return None
            weight = re.fullmatch(r"weights/(0|[1-9][0-9]{0,8})", path) if kind in ("node", "mesh") else None
            found = Property(f"weights[{int(weight[1])}]", "SCALAR", 1) if weight else properties.get(path)
            if (found is None or (found.needs and not isinstance(_at(items[number], found.needs), dict))
                    or (found.unless and isinstance(_at(items[number], found.unless), dict))):
                return None
            if not found.name:
                return [], found
            if found.name.startswith("weights"):
                mesh = number if kind == "mesh" else self._meshes[number]
                if self._target_counts.get(mesh, 0) <= (int(weight[1]) if weight else 0):
                    return None
            if kind == "mesh":
                return [Target("node", k, found.name) for k in self._shown.get(number, [])], found
            return [Target(kind, number, found.name)], found
        return None

    @cached_property
    def _shown(self) -> dict[int, list[int]]:
        """By mesh, the nodes that show it and have no weights of their own."""
        shown: dict[int, list[int]] = {}
        for k, node in enumerate(self._root.array("nodes")):
            if "weights" not in node:
                shown.setdefault(self._meshes[k], []).append(k)
        return shown

    @cached_property
    def _meshes(self) -> list[int]:
        """The mesh of each node, -1 for none."""
        count = len(self._root.array("meshes"))
        return [node.index("mesh", count) if "mesh" in node else -1 for node in self._root.array("nodes")]

    @cached_property
    def _target_counts(self) -> dict[int, int]:
        """By mesh, how many morph targets it has."""
        return {k: max((len(primitive.array("targets")) for primitive in mesh.array("primitives")), default=0)
                for k, mesh in enumerate(self._root.array("meshes"))}


def _at(value: object, path: str) -> object:
    for key in path.split("/"):
        value = value.get(key) if isinstance(value, dict) else None
    return value
