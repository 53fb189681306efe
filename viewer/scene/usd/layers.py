"""Opens a stage after a look at all the layers that it is composed of: none may lie outside the model's folder."""

from __future__ import annotations

import os
import re

from pxr import Ar, Sdf, Tf, Usd

_MOST_LAYERS = 4096
_CLIPS = ("clips", "clipSets")


def open_stage(path: str, folder: str, warnings: list[str]) -> Usd.Stage:
    """The stage of a file. Raises ValueError for one that is broken, or asks for what lies outside of `folder`.

    Layers are found before any of them is composed, by the same resolver, so that nothing else is opened. What is not
    there is warned of, and left out by the composition.
    """
    try:
        root = Sdf.Layer.FindOrOpen(path)
        if root is None:
            raise ValueError("is broken")
        held = _layers(root, os.path.realpath(folder), warnings)
        stage = Usd.Stage.Open(root, Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        raise ValueError(f"is broken{_place(error)}") from error
    if any(layer.realPath and layer not in held for layer in stage.GetUsedLayers()):
        raise ValueError("is composed of files that it does not name")
    return stage


def _layers(root: Sdf.Layer, folder: str, warnings: list[str]) -> list[Sdf.Layer]:
    """The root layer and all others; they are kept, so that the stage uses these very ones."""
    found, names = [root], {root.identifier}
    for layer in found:
        _refuse_clips(layer)
        for asset in layer.GetCompositionAssetDependencies():
            if asset.startswith("`"):
                raise ValueError(f"names the layer {asset[-200:]} by an expression, which is not read")
            name = Sdf.ComputeAssetPathRelativeToLayer(layer, asset)
            file = resolved(name)
            if not file:
                warnings.append(f"the layer {asset[-200:]!r} is not there; it is left out")
            elif not is_inside(file, folder):
                raise ValueError(f"asks for {asset[-200:]!r}, which lies outside the model's folder")
            elif name not in names and (opened := Sdf.Layer.FindOrOpen(name)) is not None:
                names.add(name)
                found.append(opened)
        if len(found) > _MOST_LAYERS:
            raise ValueError(f"is composed of more than {_MOST_LAYERS} layers")
    return found


def _refuse_clips(layer: Sdf.Layer) -> None:
    """Raises ValueError for value clips, whose files are found only while values are read."""
    def look(path: Sdf.Path) -> None:
        spec = layer.GetObjectAtPath(path)
        if isinstance(spec, Sdf.PrimSpec) and any(spec.HasInfo(name) for name in _CLIPS):
            raise ValueError(f"has at {path} value clips, which are not read")

    layer.Traverse(Sdf.Path.absoluteRootPath, look)


def resolved(name: str) -> str:
    """The file of an asset, perhaps with its place in a package such as "a.usdz[b.usdc]"; "" if it is not there."""
    return str(Ar.GetResolver().Resolve(name))


def is_inside(file: str, folder: str) -> bool:
    """Whether it is a regular file in the folder, whose path is a real one, when all links are followed."""
    outer, _ = Ar.SplitPackageRelativePathOuter(file)
    real = os.path.realpath(outer)
    return os.path.commonpath([real, folder]) == folder and os.path.isfile(real)


def _place(error: Tf.ErrorException) -> str:
    """Where a text is broken, by the one thing that OpenUSD's words say in terms of the file."""
    found = re.search(r"'[^']*:(\d+):(\d+): ", str(error))
    return f" in line {found[1]}, column {found[2]}" if found else ""
