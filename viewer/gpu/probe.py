"""Tests in a separate process whether a back end works: `python -m viewer.gpu.probe egl 0` answers in JSON.

A broken driver may crash, hang or print; in a separate process it does no harm.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from ..errors import ContextError

_TIMEOUT = 60  # seconds; a software driver on a busy machine takes a few

_VERTEX = """#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
_FRAGMENT = """#version 330 core
out vec4 color;
void main() { color = vec4(0.0, 0.2, 1.0, 1.0); }
"""


def probe(backend: str, device: int | None = None) -> dict[str, Any]:
    """Try `backend` in a child process, by drawing a triangle.

    Returns a dict. `problem` is "" if the back end works, else the reason in one line; if it works, `device`,
    `renderer`, `vendor` and `version` describe it.
    """
    arguments = [backend] if device is None else [backend, str(device)]
    path = os.pathsep.join([str(Path(__file__).resolve().parents[2]), os.environ.get("PYTHONPATH", "")])
    try:
        child = subprocess.run(
            [sys.executable, "-m", "viewer.gpu.probe", *arguments],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_TIMEOUT,
            env={**os.environ, "PYTHONPATH": path.rstrip(os.pathsep)},
        )
    except subprocess.TimeoutExpired:
        return {"problem": f"the driver does not answer within {_TIMEOUT} s"}
    answer = child.stdout.strip().rpartition("\n")[2]  # the last line; the driver may have printed others
    if child.returncode == 0 and answer.startswith("{"):
        return json.loads(answer)
    if child.returncode < 0:
        return {"problem": f"the driver crashed ({signal.Signals(-child.returncode).name})"}
    return {"problem": child.stderr.strip().rpartition("\n")[2] or f"the process ended with status {child.returncode}"}


def _draw(backend: str, device: int | None) -> dict[str, Any]:
    from .context import create_context

    try:
        context = create_context(backend, device)
    except ContextError as error:
        return {"problem": str(error).removeprefix(f"{backend}: ")}
    with context:
        gl = context.gl
        target = gl.simple_framebuffer((4, 4))
        target.use()
        program = gl.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        gl.vertex_array(program, []).render(vertices=3)
        right = target.read(components=4) == bytes([0, 51, 255, 255]) * 16
        return {
            "device": context.device_index,
            "renderer": context.renderer,
            "vendor": context.vendor,
            "version": context.version,
            "problem": "" if right else "it draws wrong pixels",
        }


def _count_devices() -> dict[str, Any]:
    from .egl import device_count

    try:
        return {"devices": device_count(), "problem": ""}
    except ContextError as error:
        return {"devices": 0, "problem": str(error).removeprefix("egl: ")}


if __name__ == "__main__":
    name, *index = sys.argv[1:]
    print(json.dumps(_count_devices() if name == "egl-devices" else _draw(name, int(index[0]) if index else None)))
