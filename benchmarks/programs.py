"""Who takes part: ours, and what other programs a folder holds."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from . import shot

OURS = "pbr-viewer"
OURS_MULTISAMPLED = "pbr-viewer-deferred-4"
"""Ours as the others are: frames with four samples a pixel, as some of them have, and kept pictures by `draft`, with
light of the environment and four samples, but none of its shadows."""
OURS_EVERYTHING = "pbr-viewer-everything"
"""Ours by the plan that leaves nothing out."""


@dataclass(frozen=True)
class Program:
    """`script` takes MODEL HDR WxH OUT.png [--frames N] and `options`; `image_based` tells whether the HDR lights."""

    name: str
    script: tuple[str, ...]
    options: tuple[str, ...] = ()
    image_based: bool = True
    folder: Path | None = None
    """Where it has to be started; None for its home."""
    render_options: tuple[str, ...] | None = None
    """Of our command line, which takes the screenshots; None for other programs, whose script does."""

    @property
    def is_ours(self) -> bool:
        return self.render_options is not None

    def frames(self, model: str, environment: str, size: tuple[int, int], picture: Path, count: int) -> list[str]:
        """The command that draws one picture, then `count` timed frames in the same process."""
        return [*self.script, model, environment, "{}x{}".format(*size), str(picture),
                *(("--frames", str(count)) if count else ()), *self.options]

    def screenshot(self, model: str, environment: str, size: tuple[int, int], picture: Path) -> list[str]:
        """The command from start to PNG: for ours the command line that users have."""
        if self.render_options is None:
            return self.frames(model, environment, size, picture, 0)
        return [*_render_command(model, environment, size, picture), *self.render_options]


def ours() -> list[Program]:
    script = (sys.executable, "-m", "benchmarks.ours")
    return [
        Program(OURS, script, folder=shot.REPOSITORY, render_options=()),
        Program(OURS_MULTISAMPLED, script, ("--antialias", "deferred-4"), folder=shot.REPOSITORY,
                render_options=("--quality", "draft")),
        Program(OURS_EVERYTHING, script, ("--plan", "everything"), folder=shot.REPOSITORY,
                render_options=("--set", "plan=everything")),
    ]


# name: (virtual environment, script, options, image-based light)
_PEERS: dict[str, tuple[str, str, tuple[str, ...], bool]] = {
    "f3d-egl": ("f3d", "peer_f3d.py", (), True),
    "f3d-osmesa": ("f3d", "peer_f3d.py", ("--backend", "osmesa"), True),
    "panda3d": ("panda3d", "peer_panda3d.py", (), True),
    "pygfx": ("pygfx", "peer_pygfx.py", (), True),
    "pyvista-egl": ("pyvista", "peer_pyvista.py", (), True),
    "open3d": ("open3d", "peer_open3d.py", (), True),
    "pyrender-egl": ("pyrender", "peer_pyrender.py", (), False),
    "pyrender-osmesa": ("pyrender", "peer_pyrender.py", ("--backend", "osmesa"), False),
}


def peers(environments: Path, scripts: Path) -> list[Program]:
    """Those of the programs above whose virtual environment is in one folder and whose script is in the other."""
    found = []
    for name, (environment, script, options, image_based) in _PEERS.items():
        python, file = environments / environment / "bin/python", scripts / script
        if python.exists() and file.is_file():
            found.append(Program(name, (str(python.absolute()), str(file.resolve())), options, image_based))
    return found


def _render_command(model: str, environment: str, size: tuple[int, int], picture: Path) -> list[str]:
    from viewer.scene.load import load_scene

    scene = load_scene(model)
    eye = shot.eye(scene.bounds)
    return [sys.executable, "-m", "viewer", "render", model, "-o", str(picture), "--size", "{}x{}".format(*size),
            "--env", environment, "--background", "env", "--fov", str(shot.FOV_Y),
            "--eye=" + ",".join(f"{x:.6g}" for x in eye), "--target=" + ",".join(f"{x:.6g}" for x in scene.center),
            "-q"]
