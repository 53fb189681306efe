"""The model of these tests, and options that make a report of it in a second or two."""

from __future__ import annotations

from command_line import SCENES

MODEL = SCENES / "spheres.glb"
QUICK = ("--size", "24", "--within", "1.5", "--env", "furnace", "--quiet")
