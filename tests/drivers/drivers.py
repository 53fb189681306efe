"""Other drivers that Mesa has beside llvmpipe, and how far their pictures may be from its own."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from driver_pictures import PICTURES

from viewer.image.image import Image
from viewer.measure.compare.difference import compare

NAMES = [picture.name for picture in PICTURES]
DRAW = Path(__file__).with_name("draw.py")
TIMEOUT = 300
"""Seconds. A child that has not ended by then hangs."""


@dataclass(frozen=True)
class Driver:
    """`environment` selects it. `renderer` stands in its renderer's string where it is installed. `bound` is the
    largest mean FLIP of a picture against llvmpipe's; 0: no bit differs. `short` are the pictures that `make test`
    draws, `slow` those that run.py does not draw, since they take minutes or have no end."""

    name: str
    environment: Mapping[str, str]
    renderer: str
    bound: float
    short: Sequence[str] = ()
    slow: Sequence[str] = ()
    need: str = ""
    is_reversed: bool = True


REFERENCE = Driver("llvmpipe", {}, "llvmpipe", 0.0, need="llvmpipe")
_WITHOUT = "-GL_ARB_clip_control -GL_ARB_gpu_shader5"
DRIVERS = [
    Driver("llvmpipe as OpenGL 3.3", {"MESA_GL_VERSION_OVERRIDE": "3.3"}, "llvmpipe", 0.0,
           ("spheres, pbr", "maps, path, bvh"), need="llvmpipe"),
    Driver("llvmpipe without optimisation", {"GALLIVM_PERF": "nopt"}, "llvmpipe", 0.0,  # as tests draw: ../conftest.py
           ("textures, pbr", "maps, path, bvh"), need="llvmpipe"),
    Driver("llvmpipe as OpenGL 4.1", {"MESA_GL_VERSION_OVERRIDE": "4.1"}, "llvmpipe", 0.0, need="llvmpipe"),
    Driver("llvmpipe as OpenGL 3.3 without extensions",
           {"MESA_GL_VERSION_OVERRIDE": "3.3", "MESA_EXTENSION_OVERRIDE": _WITHOUT}, "llvmpipe", 0.001,
           ("spheres, pbr", "lights, phong", "multisampled, pbr", "maps, path, bvh"), need="llvmpipe",
           is_reversed=False),
    Driver("softpipe", {"GALLIUM_DRIVER": "softpipe"}, "softpipe", 0.015,
           ("spheres, pbr", "lights, phong", "glass, pbr", "textures, pbr", "maps, path, embree"),
           slow=("every pass, pbr", "maps, path, bvh", "alpha, path, bvh"), need="softpipe"),
    Driver("zink over lavapipe", {"GALLIUM_DRIVER": "zink", "LIBGL_ALWAYS_SOFTWARE": "1"}, "zink", 0.005,
           ("spheres, pbr", "lights, phong", "multisampled, pbr", "maps, path, embree"), need="zink"),
]


@dataclass
class Run:
    """A child process that draws with a driver."""

    driver: Driver
    file: Path
    process: subprocess.Popen[str] = field(repr=False)

    @classmethod
    def start(cls, driver: Driver, folder: Path, names: Sequence[str] = (), skipped: Sequence[str] = ()) -> Run:
        file = folder / f"{driver.name}.pickle"
        mesa = [name for name in os.environ if name.startswith(("MESA_", "GALLIUM_", "GALLIVM_", "LIBGL_"))]
        environment = {name: value for name, value in os.environ.items() if name not in mesa}
        environment |= {"PBR_VIEWER_CACHE": str(folder / "cache"), **driver.environment}
        names = [name for name in names or NAMES if name not in skipped]
        process = subprocess.Popen([sys.executable, str(DRAW), str(file), *names], env=environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return cls(driver, file, process)

    def result(self) -> dict[str, Any] | str:
        """What draw.py stores; or, where it failed, the first line that it printed, which names the driver that was
        found, and why it failed."""
        try:
            printed, _ = self.process.communicate(timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            self.process.kill()
            printed, _ = self.process.communicate()
            printed += f"\nno end within {TIMEOUT} s"
        if self.process.returncode:
            first, *others = printed.strip().splitlines() or [""]
            return f"{first}: {others[-1] if others else f'status {self.process.returncode}'}"
        return pickle.loads(self.file.read_bytes())


def differences(ours: Mapping[str, Any], reference: Mapping[str, Any]) -> dict[str, float]:
    """The mean FLIP of each picture against that of the reference; 0 only where no bit of the radiance differs."""
    found = {}
    for name, picture in ours["pictures"].items():
        theirs = reference["pictures"][name]
        is_equal = all(a.tobytes() == b.tobytes() for a, b in zip(picture, theirs, strict=True))
        found[name] = 0.0 if is_equal else max(compare(Image(*theirs, {}), Image(*picture, {})).flip, 1e-9)
    return found
