"""Contexts in plain memory: Mesa's OSMesa, reached through GLFW's null platform."""

from __future__ import annotations

import glfw

from .context import Context
from .glfw_window import GLFWLoader, create_window


class OSMesaContext(Context):
    """Needs neither a screen nor a graphics device; always the software rasteriser."""

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
