"""A reader of glTF 2.0 that uses only json and numpy."""

from .reader import load_gltf

__all__ = ["load_gltf"]
