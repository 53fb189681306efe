"""Show 3D models physically based, from Python.

    import viewer
    scene = viewer.load("helmet.glb", environment="studio.hdr")
    image = viewer.render(scene, size=(1280, 720))
    image.save("helmet.png")
    viewer.show(scene)
"""

from .api import load, render, show
from .errors import ContextError, InputError, OutputError, ShaderError, UsageError, ViewerError
from .image import Image
from .scene.camera import Camera
from .scene.environment import Environment
from .scene.light import Light
from .scene.material import Material
from .scene.mesh import Mesh
from .scene.scene import Instance, Scene
from .settings import Settings

__all__ = [
    "Camera",
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
    "load",
    "render",
    "show",
]
