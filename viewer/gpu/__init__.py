"""The only code that knows the driver: contexts and shader programs. It does not know what a material is."""

from .context import Context, open_context
from .program import compile_program

__all__ = ["Context", "compile_program", "open_context"]
