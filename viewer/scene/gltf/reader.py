"""Reads a glTF 2.0 file as a Scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UsageError
from ..animation import Target
from ..camera import Camera
from ..light import Light
from ..mesh import Mesh
from ..moving_curves import Mover, MovingCurves
from ..rig import Deformed, Rig, Skin
from ..scene import Instance, Scene
from ..specular_glossiness import Factors
from .accessors import Accessors
from .animations import read_animations
from .buffers import Buffers
from .cameras import read_camera
from .container import read_container
from .curves import Lines, is_curves, placed, read_lines
from .element import Document, Element
from .extensions import check_asset, extension_names
from .instancing import EXTENSION, instance_offsets
from .lights import Lights
from .materials import Materials
from .nodes import Nodes
from .primitives import read_primitive
from .skins import Skins
from .textures import Textures

MAX_INSTANCES = 1 << 20
_TOGETHER = ("emissive", "emissive_strength"), Factors._fields
"""Names of targets of which a material needs all where tracks move any."""


def load_gltf(path: Path, data: bytes, scene: int | str | None = None) -> Scene:
    """Read a scene of a .gltf or .glb file, by its number or name, at rest and with its animations and variants.

    Without `scene` it is the file's default one. `data` is the file's content. `path` is for messages and to find the
    files that it refers to. Raises InputError for a violation of glTF 2.0, and for a scene that is not there;
    violations that can be ignored become warnings of the scene.
    """
    value, binary, kind = read_container(path, data)
    document = Document(path, binary)
    root = Element(document, value)
    check_asset(root)
    return _Reader(root, kind).scene(scene)


class _Reader:
    def __init__(self, root: Element, kind: str) -> None:
        self.root, self.kind = root, kind
        self.buffers = Buffers(root)
        self.accessors = Accessors(root, self.buffers)
        self.textures = Textures(root, self.buffers)
        self.materials = Materials(root, self.textures)
        self.nodes = Nodes(root)
        self.skins = Skins(root, self.nodes, self.accessors)
        self.mesh_items, self.camera_items = root.array("meshes"), root.array("cameras")
        self.lights = Lights(root)
        self.meshes: list[Mesh] = []
        self.animations = read_animations(root, self.accessors, self.nodes)
        self.materials.moved_by(self.animations)
        self._weighted = {track.target.number for animation in self.animations for track in animation.tracks
                          if track.target.name.startswith("weights")}
        self._shown: set[int] = {track.target.number for animation in self.animations for track in animation.tracks
                                 if track.target.name == "visible"}
        """Nodes whose visibility changes in time."""
        self._placed_by: list[int] = []
        self._skinned: list[bool] = []
        self._offsets: dict[int, np.ndarray] = {}
        self._drawn: list[int] = []
        self._deformed: dict[int, Deformed] = {}
        self._known: dict[tuple, list[int]] = {}
        self._lines: dict[tuple[int, int | None], list[Lines]] = {}
        """Of each mesh and skin."""
        self._curves: list[MovingCurves] = []

    def scene(self, wanted: int | str | None) -> Scene:
        name, nodes = self._scene_nodes(wanted)
        lights: list[Light] = []
        cameras: list[Camera] = []
        light_nodes, camera_nodes, light_items, camera_items = [], [], [], []
        never = self._never_visible()
        hidden = self.nodes.hierarchy.hidden(self.nodes.hierarchy.visible)
        for number in nodes:
            node, world = self.nodes.items[number], self.nodes.world[number]
            if "mesh" in node and not never[number]:
                self._add_instances(number, node)
            item = None if never[number] else self.lights.number(node)
            light = None if item is None else self.lights.at_node(item, node, world)
            if item is not None and light is not None:
                lights.append(light)
                light_nodes.append(number)
                light_items.append(item)
            if "camera" in node:
                item = node.index("camera", len(self.camera_items))
                element = self.camera_items[item]
                camera = read_camera(element, world, node.string("name", "") or element.string("name", ""))
                if camera is not None:
                    cameras.append(camera)
                    camera_nodes.append(number)
                    camera_items.append(item)
        if not self._drawn and not self._curves:
            self.root.document.warn("the scene contains nothing to draw")
        variants = self.materials.variants()
        rig = Rig(self.nodes.hierarchy, np.array(self._placed_by, np.intp), tuple(light_nodes), tuple(camera_nodes),
                  self._deformed, tuple(light_items), tuple(camera_items), variants[0].numbers,
                  self._at_rest(dict(zip(light_items, lights)), dict(zip(camera_items, cameras))),
                  np.array(self._skinned, bool), self._all_offsets(), tuple(self._curves))
        lights = [replace(light, intensity=0.0) if hidden[node] else light for light, node in zip(lights, light_nodes)]
        return Scene(name, tuple(self.meshes), variants[0].materials,
                     self._instances(rig, hidden), tuple(lights), tuple(cameras),
                     warnings=tuple(self.root.document.warnings), facts=self._facts(), animations=self.animations,
                     rig=rig if self.animations else None, variants=variants if len(variants) > 1 else (),
                     curves=tuple(moving.at_rest for moving in self._curves))

    def _at_rest(self, lights: dict[int, Light], cameras: dict[int, Camera]) -> dict[Target, np.ndarray]:
        """The values of all that tracks move of materials, lights and cameras that are there."""
        targets = {track.target for animation in self.animations for track in animation.tracks}
        targets |= {target._replace(name=name) for target in targets for names in _TOGETHER if target.name in names
                    for name in names}
        targets |= {Target("light", number, "intensity") for number in lights if self._shown}
        values = {}
        drawn = self.materials.drawn | {curves.material for curves in self._curves}
        for target in sorted(targets):
            kind, number, name = target
            if kind == "material" and number in drawn:
                values[target] = self.materials.value(number, name)
            elif kind in ("light", "camera") and number in (found := lights if kind == "light" else cameras):
                thing: Any = found[number]
                value = (thing.height or 0.0) / 2 if name == "ymag" else getattr(thing, name)
                values[target] = np.array([np.nan if value is None else value], np.float64).ravel()
        return values

    def _scene_nodes(self, wanted: int | str | None) -> tuple[str, list[int]]:
        """A name for the scene to show, and its nodes, parents first.

        The name is that of the file, as in all formats: most exporters name every scene "Scene". One of several gets
        its own name behind it."""
        scenes, stem = self.root.array("scenes"), self.root.document.path.stem
        if wanted is None and not scenes:
            return stem, self.nodes.reachable(self.nodes.roots(), self.root)
        names = [scene.string("name", "") for scene in scenes]
        if wanted is None:
            index = self.root.index("scene", len(scenes), 0)
        elif isinstance(wanted, str) and wanted and wanted in names:
            index = names.index(wanted)
        elif isinstance(wanted, int) and 0 <= wanted < len(scenes):
            index = wanted
        else:
            known = ", ".join(name or str(k) for k, name in enumerate(names)) or "none"
            raise self.root.error(f"there is no scene {wanted!r}; there are, counted from 0: {known}", "scenes")
        scene = scenes[index]
        roots = scene.indices("nodes", len(self.nodes.items))
        name = f"{stem} - {names[index]}" if len(scenes) > 1 and names[index] else stem
        return name, self.nodes.reachable(roots, scene)

    def _never_visible(self) -> np.ndarray:
        """The nodes, (N,) bool, whose meshes and lights are hidden at all times."""
        visible = self.nodes.hierarchy.visible.copy()
        visible[sorted(self._shown)] = True
        return self.nodes.hierarchy.hidden(visible)

    def _add_instances(self, number: int, node: Element) -> None:
        mesh = node.index("mesh", len(self.mesh_items))
        skin: int | None = node.index("skin", len(self.skins.items), None)
        if skin is not None:
            self.skins.skin(skin)
            if not self._has_joints(mesh):
                node.warn("the mesh has no joints; the skin is not used", "skin")
                skin = None
        given = node.numbers("weights")
        weights = tuple(given if given is not None else self.mesh_items[mesh].numbers("weights") or ())
        # Nodes share the vertices of a mesh unless these come to differ.
        key = (mesh, skin, weights, number if number in self._weighted else None)
        if key not in self._known:
            self._known[key] = self._read_mesh(mesh, skin, weights, number)
        offsets = instance_offsets(self.accessors, node)
        if offsets is not None and skin is not None:
            node.warn(f"{EXTENSION} is for meshes without a skin; the mesh is drawn once")
            offsets = None
        for lines in self._lines[mesh, skin]:
            self._add_curves(number, node, lines, None if skin is None else self.skins.skin(skin), offsets)
        times = 1 if offsets is None else len(offsets)
        count = len(self._known[key]) * times
        if len(self._drawn) + count > MAX_INSTANCES:
            raise node.error(f"more than {MAX_INSTANCES} instances of primitives")
        if offsets is not None:
            self._offsets[len(self._drawn)] = offsets.repeat(len(self._known[key]), axis=0)
        self._drawn += self._known[key] * times
        self._placed_by += [number] * count
        self._skinned += [skin is not None] * count  # only the joints place a skinned mesh (glTF 2.0, 3.7.3.3)

    def _add_curves(self, number: int, node: Element, lines: Lines, skin: Skin | None,
                    offsets: np.ndarray | None) -> None:
        """Add the curves of a mesh, as the node or the skin places them at rest."""
        hierarchy = self.nodes.hierarchy
        mover = Mover(number, np.eye(4)[None] if offsets is None else offsets, skin)
        matrices = mover.matrices(self.nodes.world, hierarchy.hidden(hierarchy.visible))
        name = node.string("name", "") or node.place
        try:
            at_rest = placed(self.accessors, lines, name, matrices, len(mover.offsets))
        except UsageError as error:
            raise lines.primitive.error(str(error)) from error
        self._curves.append(MovingCurves(at_rest, lines.strands, mover, lines.material))

    def _all_offsets(self) -> np.ndarray | None:
        """The matrices of all instances to their nodes, (I, 4, 4); None if all are at their nodes."""
        if not self._offsets:
            return None
        out = np.tile(np.eye(4), (len(self._drawn), 1, 1))
        for first, offsets in self._offsets.items():
            out[first:first + len(offsets)] = offsets
        return out

    def _instances(self, rig: Rig, hidden: np.ndarray) -> tuple[Instance, ...]:
        names = [node.string("name", "") for node in self.nodes.items]
        transforms = rig.transforms(self.nodes.world, hidden)
        transforms.flags.writeable = False  # or each instance would have a copy
        return tuple(Instance(mesh, transform, names[node])
                     for mesh, transform, node in zip(self._drawn, transforms, self._placed_by, strict=True))

    def _has_joints(self, mesh: int) -> bool:
        primitives = self.mesh_items[mesh].array("primitives")
        return all("JOINTS_0" in primitive.object("attributes") for primitive in primitives)

    def _read_mesh(self, index: int, skin: int | None, weights: tuple[float, ...], node: int) -> list[int]:
        """Read the primitives of a mesh, as the node deforms it at rest. Returns their indices in `meshes`."""
        element = self.mesh_items[index]
        name = element.string("name", "") or element.place
        bound = None if skin is None else self.skins.skin(skin)
        numbers: list[int] = []
        joint_count = 0 if bound is None else len(bound.joints)
        lines = self._lines[index, skin] = []
        for primitive in element.array("primitives"):
            if is_curves(primitive):
                strands = read_lines(self.accessors, primitive, self.root.array("materials"), joint_count)
                lines += [strands] if strands is not None else []
                continue
            material = self.materials.number(primitive)
            wanted: Sequence[float] = [1.0] * len(primitive.array("targets")) if node in self._weighted else weights
            read = read_primitive(self.accessors, primitive, name, material, self.materials.looks(material), wanted,
                                  joint_count)
            if read is None:
                continue
            mesh, deformation = read
            if deformation is not None:
                deformed = Deformed(mesh, deformation, node, weights, bound)
                try:
                    mesh = deformed.at(weights, self.nodes.world)
                except UsageError as error:
                    raise primitive.error(str(error)) from error
                if self.animations:
                    self._deformed[len(self.meshes)] = deformed
            numbers.append(len(self.meshes))
            self.meshes.append(mesh)
        return numbers

    def _facts(self) -> dict[str, object]:
        root, asset = self.root, self.root.object("asset")
        facts: dict[str, object] = {"format": f"{self.kind} 2.0"}
        facts.update({key: asset.string(key) for key in ("generator", "copyright") if key in asset})
        facts["extensions_used"] = extension_names(root, "extensionsUsed")
        facts["extensions_required"] = extension_names(root, "extensionsRequired")
        facts["scenes"] = [scene.string("name", "") for scene in root.array("scenes")]
        for key in ("nodes", "meshes", "materials", "skins"):
            facts[key] = len(root.array(key))
        facts["images"] = [{"name": image.name, "format": image.format, "width": image.width, "height": image.height,
                            "bits": image.bits} for image in self.textures.opened.values()]
        return facts
