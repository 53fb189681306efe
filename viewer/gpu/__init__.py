"""OpenGL: contexts, shader programs, textures. Nothing here depends on scenes or materials."""

from .context import Context, open_context
from .program import compile_program

__all__ = ["Context", "compile_program", "open_context"]
