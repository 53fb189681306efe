"""What there is to show, and the readers of files.

The package itself can be called: `viewer.scene(vertices, faces)` makes a scene (`from_arrays.make_scene`).
"""

import sys
from types import ModuleType
from typing import Any


class _Package(ModuleType):
    def __call__(self, *arguments: Any, **more: Any) -> Any:
        """See `viewer.scene.from_arrays.make_scene`."""
        from .from_arrays import make_scene

        return make_scene(*arguments, **more)


sys.modules[__name__].__class__ = _Package
