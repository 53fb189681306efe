"""Reads a glTF 2.0 file as a Scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..camera import Camera
from ..light import Light
from ..mesh import Mesh
from ..scene import Instance, Scene
from .accessors import Accessors
from .animations import check_animations
from .buffers import Buffers
from .cameras import read_camera
from .container import read_container
from .deform import Skins
from .element import Document, Element
from .extensions import check_asset, extension_names
from .lights import Lights
from .materials import Materials
from .nodes import Nodes
from .primitives import Pose, read_primitive
from .textures import Textures

MAX_INSTANCES = 1 << 20


def load_gltf(path: Path, data: bytes, scene_index: int | None = None) -> Scene:
    """Read a scene of a .gltf or .glb file in its static pose, by default the file's default scene.

    `data` is the file's content. `path` is for messages and to find the files that it refers to. Raises InputError for
    a violation of glTF 2.0; violations that can be ignored become warnings of the scene.
    """
    value, binary, kind = read_container(path, data)
    document = Document(path, binary)
    root = Element(document, value)
    check_asset(root)
    return _Reader(root, kind).scene(scene_index)


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
        self.instances: list[Instance] = []
        self._known: dict[tuple, list[int]] = {}

    def scene(self, index: int | None) -> Scene:
        name, nodes = self._scene_nodes(index)
        lights: list[Light] = []
        cameras: list[Camera] = []
        for number in nodes:
            node, world = self.nodes.items[number], self.nodes.world[number]
            if "mesh" in node:
                self._add_instances(node, world)
            light = self.lights.at_node(node, world) if "extensions" in node else None
            if light is not None:
                lights.append(light)
            if "camera" in node:
                element = self.camera_items[node.index("camera", len(self.camera_items))]
                camera = read_camera(element, world, node.string("name", "") or element.string("name", ""))
                if camera is not None:
                    cameras.append(camera)
        check_animations(self.root, self.accessors)
        if not self.instances:
            self.root.document.warn("the scene contains nothing to draw")
        return Scene(name or self.root.document.path.stem, tuple(self.meshes), tuple(self.materials.used),
                     tuple(self.instances), tuple(lights), tuple(cameras),
                     warnings=tuple(self.root.document.warnings), facts=self._facts())

    def _scene_nodes(self, index: int | None) -> tuple[str, list[int]]:
        """The name of the scene to show and its nodes, parents first."""
        scenes = self.root.array("scenes")
        if index is not None and not 0 <= index < len(scenes):
            raise self.root.error(f"there is no scene {index}; the file has {len(scenes)}", "scenes")
        if not scenes:
            return "", self.nodes.reachable(self.nodes.roots(), self.root)
        if index is None:
            index = self.root.index("scene", len(scenes), 0)
        scene = scenes[index]
        roots = scene.indices("nodes", len(self.nodes.items))
        return scene.string("name", ""), self.nodes.reachable(roots, scene)

    def _add_instances(self, node: Element, world: np.ndarray) -> None:
        mesh = node.index("mesh", len(self.mesh_items))
        skin: int | None = node.index("skin", len(self.skins.items), None)
        if skin is not None:
            self.skins.joint_matrices(skin)
            if not self._has_joints(mesh):
                node.warn("the mesh has no joints; the skin is not used", "skin")
                skin = None
        given = node.numbers("weights")
        weights = tuple(given if given is not None else self.mesh_items[mesh].numbers("weights") or ())
        key = (mesh, skin, weights)
        if key not in self._known:
            self._known[key] = self._read_mesh(mesh, skin, weights)
        if skin is not None:
            world = np.eye(4)  # only the joints place a skinned mesh (glTF 2.0, 3.7.3.3)
        name = node.string("name", "")
        self.instances += [Instance(number, world, name) for number in self._known[key]]
        if len(self.instances) > MAX_INSTANCES:
            raise node.error(f"more than {MAX_INSTANCES} instances of primitives")

    def _has_joints(self, mesh: int) -> bool:
        primitives = self.mesh_items[mesh].array("primitives")
        return all("JOINTS_0" in primitive.object("attributes") for primitive in primitives)

    def _read_mesh(self, index: int, skin: int | None, weights: tuple[float, ...]) -> list[int]:
        """Read the primitives of a mesh in a pose. Returns their indices in `meshes`."""
        element = self.mesh_items[index]
        name = element.string("name", "") or element.place
        pose = Pose(weights, None if skin is None else self.skins.joint_matrices(skin))
        numbers = []
        for primitive in element.array("primitives"):
            material = self.materials.number(primitive)
            mesh = read_primitive(self.accessors, primitive, name, material, self.materials.used, pose)
            if mesh is not None:
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
        for key in ("nodes", "meshes", "materials", "animations", "skins"):
            facts[key] = len(root.array(key))
        facts["images"] = [{"name": image.name, "format": image.format, "width": image.width, "height": image.height,
                            "bits": image.bits} for image in self.textures.opened.values()]
        return facts
