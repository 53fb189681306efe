"""Our own reader of glTF 2.0, over json and numpy."""

from .reader import load_gltf

__all__ = ["load_gltf"]
