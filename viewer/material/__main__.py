"""`python -m viewer.material` writes the files generated from the declaration of materials: shaders/material/*.glsl and
docs/materials.md."""

from __future__ import annotations

from ..base.resources import resource_folder
from .document import table
from .glsl import files


def main() -> None:
    shaders = resource_folder("shaders")
    for name, text in files().items():
        (shaders / "material" / name).write_text(text, encoding="utf-8")
    page = shaders.parent / "docs" / "materials.md"
    page.write_text(table(), encoding="utf-8")


if __name__ == "__main__":
    main()
