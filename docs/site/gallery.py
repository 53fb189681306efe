"""Makes the pictures of docs/gallery.md by the commands that stand there.

    python docs/site/gallery.py [NAME...]

A picture is made of the command whose `-o` has its name, at SIZE, and stored as docs/images/gallery/NAME.webp.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).resolve().parents[1]
SIZE = "640x400"
PICTURES = DOCS / "images" / "gallery"


def commands() -> dict[str, list[str]]:
    """The arguments of each command of the page, by the name of its picture."""
    text = re.sub(r"\\\n\s*", "", (DOCS / "gallery.md").read_text(encoding="utf-8"))
    found = [shlex.split(line) for line in re.findall(r"^    pbr-viewer (render .+)$", text, re.MULTILINE)]
    return {Path(arguments[arguments.index("-o") + 1]).stem: arguments for arguments in found}


def main(names: list[str]) -> None:
    PICTURES.mkdir(exist_ok=True)
    known = commands()
    for name in names or known:
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder, f"{name}.png")
            arguments = [str(made) if argument == f"{name}.png" else argument for argument in known[name]]
            subprocess.run([sys.executable, "-m", "viewer", *arguments, "--size", SIZE], cwd=DOCS.parent, check=True)
            Image.open(made).convert("RGB").save(PICTURES / f"{name}.webp", quality=85, method=6)
        print(name)


if __name__ == "__main__":
    main(sys.argv[1:])
