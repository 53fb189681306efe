"""Draws pictures in a process of its own, with the driver that its environment names: `draw.py FILE NAME...`.

FILE gets, pickled: what OpenGL says of itself, whether depth is reversed, the pictures of these names, and for each
class of paths how many texels of path_classes.py are not as they should be. The first line that is printed is the
driver's name for itself.
"""

from __future__ import annotations

import pickle
import sys

from driver_pictures import PICTURES
from path_classes import shaded

from viewer.gpu.context import create_context
from viewer.raster.depth import can_reverse


def main(path: str, *names: str) -> None:
    context = create_context("egl")
    print(context.renderer, flush=True)
    gl = context.gl
    drawn, errors = {}, []
    for picture in PICTURES:
        if picture.name not in names or (picture.is_multisampled and gl.max_samples < 4):
            continue
        image = picture.draw(context)
        drawn[picture.name] = image.linear, image.srgb
        if gl.error != "GL_NO_ERROR":
            errors.append(picture.name)
    found, expected = shaded(context)
    told = {"renderer": context.renderer, "version": context.version, "is_reversed": can_reverse(gl),
            "errors": errors, "pictures": drawn,
            "classes": [int(count) for count in (found != expected).sum(axis=(0, 2, 3))]}
    with open(path, "wb") as file:
        pickle.dump(told, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
