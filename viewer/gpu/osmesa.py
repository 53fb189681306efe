"""Contexts that render into main memory: Mesa's OSMesa, opened through GLFW's null platform."""

from __future__ import annotations

import glfw

from .context import Context
from .glfw_window import GLFWLoader, create_window


class OSMesaContext(Context):
    """A context of Mesa's software rasteriser. It needs neither a screen nor a graphics device."""

    backend = "osmesa"

    def __init__(self) -> None:
        super().__init__(self._create)

    def _create(self) -> GLFWLoader:
        window = create_window(
            self.backend,
            null_platform=True,
            hints={glfw.CONTEXT_CREATION_API: glfw.OSMESA_CONTEXT_API, glfw.VISIBLE: glfw.FALSE},
            versions=((3, 3),),
            size=(1, 1),
            title="",
        )
        return GLFWLoader(window)
