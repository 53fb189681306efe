"""Show 3D models with physically based shading, from Python.

    import viewer
    scene = viewer.load("helmet.glb", environment="studio.hdr")
    image = viewer.render(scene, size=(1280, 720))
    image.save("helmet.png")
    viewer.show(scene)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .api import join, load, render, show
    from .errors import ContextError, InputError, OutputError, ShaderError, UsageError, ViewerError
    from .gpu.call import call_glsl
    from .image.image import Image
    from .scene.camera import Camera
    from .scene.camera_file import CameraFrame, read_cameras, write_cameras
    from .scene.environment import Environment
    from .scene.from_arrays import make_scene as scene  # noqa: F401  the package of this name can be called
    from .scene.light import Light
    from .scene.material import Material
    from .scene.mesh import Mesh
    from .scene.scene import Instance, Scene
    from .scene.volume import Volume
    from .settings import Settings

__all__ = [
    "Camera",
    "CameraFrame",
    "ContextError",
    "Environment",
    "Image",
    "InputError",
    "Instance",
    "Light",
    "Material",
    "Mesh",
    "OutputError",
    "Scene",
    "Settings",
    "ShaderError",
    "UsageError",
    "ViewerError",
    "Volume",
    "call_glsl",
    "join",
    "load",
    "read_cameras",
    "render",
    "show",
    "write_cameras",
]

_MODULES = {
    "Camera": "scene.camera", "CameraFrame": "scene.camera_file", "Environment": "scene.environment",
    "Image": "image.image", "Instance": "scene.scene", "Light": "scene.light", "Material": "scene.material",
    "Mesh": "scene.mesh", "Scene": "scene.scene", "Settings": "settings", "Volume": "scene.volume",
    "call_glsl": "gpu.call", "join": "api", "load": "api", "read_cameras": "scene.camera_file", "render": "api",
    "show": "api", "write_cameras": "scene.camera_file",
}


def __getattr__(name: str) -> object:
    # Modules are imported on first access, because pytest loads this package for its plugin in every project.
    if name == "scene":
        return import_module(".scene", __name__)
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_MODULES.get(name, 'errors')}", __name__), name)


def __dir__() -> list[str]:
    return [*__all__, "scene"]
