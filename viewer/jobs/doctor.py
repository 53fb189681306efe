"""Finds which OpenGL contexts work on this machine, and how to fix those that do not."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from glob import glob
from typing import Any

from ..gpu.context import auto_backends
from ..gpu.probe import probe

_PACKAGES = {
    "egl": "Debian, Ubuntu: apt-get install libegl1 libgl1-mesa-dri; Fedora: dnf install mesa-libEGL mesa-dri-drivers",
    "osmesa": "Debian, Ubuntu: apt-get install libosmesa6; Fedora: dnf install mesa-libOSMesa",
}


@dataclass(frozen=True)
class Finding:
    """The result for one back end. If it works, `problem` is ""; else `problem` says what failed and `fix` how to fix
    it."""

    backend: str
    device: int | None
    renderer: str = ""
    vendor: str = ""
    version: str = ""
    problem: str = ""
    fix: str = ""

    @property
    def works(self) -> bool:
        return not self.problem

    def to_json(self) -> dict[str, Any]:
        return {**asdict(self), "works": self.works}


def diagnose() -> list[Finding]:
    """Try every back end of this system, and EGL once per device. Each runs in its own process; all take 1 to 2 s."""
    findings = []
    for backend in auto_backends():
        devices: Sequence[int | None] = [None]
        if backend == "egl":
            devices = range(probe("egl-devices").get("devices", 0)) or devices
        findings += [_finding(backend, device) for device in devices]
    return findings


def exit_status(findings: Sequence[Finding]) -> int:
    """0 if any back end works, so that pictures can be made; else 3."""
    return 0 if any(finding.works for finding in findings) else 3


def format_findings(findings: Sequence[Finding]) -> str:
    """The findings as text: a line for each, or two if it does not work."""
    lines = []
    for finding in findings:
        name = finding.backend if finding.device is None else f"{finding.backend}, device {finding.device}"
        if finding.works:
            lines.append(f"ok    {name:16} {finding.renderer}; OpenGL {finding.version}; {finding.vendor}")
        else:
            lines.append(f"FAIL  {name:16} {finding.problem}")
            lines.append(f"      {'':16} {finding.fix}")
    working = next((finding.backend for finding in findings if finding.works), None)
    lines.append(
        f"--backend auto takes {working}" if working else "no OpenGL context works here: no picture can be made"
    )
    return "\n".join(lines)


def _finding(backend: str, device: int | None) -> Finding:
    result = {"device": device, **probe(backend, device)}
    fix = _fix(backend) if result["problem"] else ""
    return Finding(backend=backend, fix=fix, **result)


def _fix(backend: str) -> str:
    if backend == "window":
        if sys.platform.startswith("linux") and not {"DISPLAY", "WAYLAND_DISPLAY"} & os.environ.keys():
            return "it is needed only to view models in a window: run it in a desktop session, or under xvfb-run"
        return "update the graphics driver: OpenGL 3.3 is needed"
    fix = f"install Mesa's software OpenGL: {_PACKAGES[backend]}"
    if backend == "egl":
        closed = [file for file in sorted(glob("/dev/dri/renderD*")) if not os.access(file, os.R_OK | os.W_OK)]
        if closed:
            fix = f"no access to {closed[0]}: add the user to its group (render or video); or {fix}"
        elif os.path.exists("/dev/nvidiactl"):
            fix = f"in a container, set NVIDIA_DRIVER_CAPABILITIES=all for NVIDIA's OpenGL; or {fix}"
    return fix
