"""The glTF extensions that are supported, those that can be ignored, and warnings and errors about all others."""

from __future__ import annotations

from ..schema import FEATURES
from . import draco, instancing, meshopt, nodes, topology
from .element import Element
from .textures import IMAGE_EXTENSIONS
from .variants import VARIANTS

SUPPORTED = frozenset({
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    *IMAGE_EXTENSIONS,
    draco.EXTENSION,
    instancing.EXTENSION,
    nodes.VISIBILITY,
    topology.RESTART,
    VARIANTS,
    *meshopt.EXTENSIONS,
    *(feature.extension for feature in FEATURES if feature.extension),
})
_WITHOUT_EFFECT = ("FB_ngon_encoding", "KHR_interactivity", "KHR_xmp", "KHR_xmp_json_ld", "MSFT_lod",
                   "EXT_mesh_manifold", "KHR_node_hoverability", "KHR_node_selectability", "pbrMetallicRoughness")
"""These never change how a still picture of the model at full detail looks. The last is no extension but a part of
glTF, which is read; UnityGLTF lists it."""


def check_asset(root: Element) -> None:
    """Raise InputError unless the file is glTF 2.0 and requires only supported extensions. Warn of other extensions
    that it uses."""
    if "asset" not in root:
        raise root.error("is missing; the file is not a glTF", "asset")
    asset = root.object("asset")
    version = asset.string("version")
    needed = asset.string("minVersion", version.split(".")[0] + ".0")
    if version.split(".")[0] != "2":
        raise asset.error(f"glTF {version[:20] or 'of no number'} is not supported; only 2.0 is supported", "version")
    if needed != "2.0":
        raise asset.error(f"the file needs glTF {needed[:20]}; only 2.0 is supported", "minVersion")
    used, required = extension_names(root, "extensionsUsed"), extension_names(root, "extensionsRequired")
    root.document.extensions = frozenset(used) | frozenset(required)
    for k, name in enumerate(required):
        if name not in SUPPORTED and name not in _WITHOUT_EFFECT:
            raise root.error(f"the file needs the extension {name}, which is not supported", f"extensionsRequired[{k}]")
    for name in used:
        if name not in SUPPORTED and name not in _WITHOUT_EFFECT:
            root.document.warn(f"extension {name} is not supported; the model is shown without it")


def extension_names(root: Element, key: str) -> list[str]:
    """The strings of `extensionsUsed` or `extensionsRequired`, each once."""
    names = root.value.get(key, [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise root.error("must be an array of strings", key)
    return list(dict.fromkeys(names))
