"""Programs from shader files, with compile errors that name the real file and line."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import moderngl

from ..base.signals import unbroken
from ..errors import ShaderError
from .context import Context
from .source import ProgramSource, assemble, display_name

# An error in a driver's log: a source-string number, which is always the same here, then the line and the text.
_MESSAGE = re.compile(
    r"""^\s*(?:
        \d+:(\d+)\(\d+\):\s*(?:preprocessor\s)?error:\s*  # Mesa:              0:12(5): error: ...
      | \d+\((\d+)\)\s*:\s*error\s*(?=\w*:)             # NVIDIA:            0(12) : error C1008: ...
      | ERROR:\s*\d+:(\d+):\s*                           # AMD, Apple, Intel: ERROR: 0:12: ...
    )(.*)$""",
    re.VERBOSE | re.MULTILINE | re.IGNORECASE,
)
_STAGE = re.compile(r"^(\w+)_shader\s*$", re.MULTILINE)


def compile_program(
    context: Context,
    *,
    vertex: str | Path,
    fragment: str | Path | None = None,
    defines: Mapping[str, float] | None = None,
    version: int = 330,
) -> moderngl.Program:
    """Compile and link shader files, each assembled with the same `defines` (see `viewer.gpu.source`).

    Raises ShaderError with file and line, such as ``shaders/bsdf/ggx.glsl:12: ...``, if the driver rejects the program.
    """
    stages = {"vertex": vertex, "fragment": fragment}
    sources = {stage: assemble(path, defines, version) for stage, path in stages.items() if path is not None}
    return compile_sources(context, sources)


def compile_sources(
    context: Context, sources: Mapping[str, ProgramSource], varyings: Sequence[str] = ()
) -> moderngl.Program:
    """As `compile_program`, for assembled shaders; the keys are the stages vertex and fragment. `varyings` are the
    vertex shader's outputs to capture by transform feedback."""
    context.make_current()
    try:
        shaders: dict[str, Any] = {f"{stage}_shader": source.text for stage, source in sources.items()}
        with unbroken():  # moderngl 5.13 makes the uniforms' objects in Python, from C that crashes where that raises
            return context.gl.program(**shaders, varyings=tuple(varyings))
    except moderngl.Error as error:
        raise ShaderError(_explain(str(error), sources)) from error


def _explain(log: str, sources: Mapping[str, ProgramSource]) -> str:
    """The first error in the driver's log, as moderngl reports it, with the file and line that it is in."""
    stage = _STAGE.search(log)
    message = _MESSAGE.search(log)
    if stage and message and stage[1] in sources:
        line, text = (group for group in message.groups() if group is not None)
        origins = sources[stage[1]].origins
        if 0 < int(line) <= len(origins):
            file, file_line = origins[int(line) - 1]
            return f"{display_name(file)}:{file_line}: {text.strip()}"
    names = ", ".join(display_name(source.files[0]) for source in sources.values())
    return f"{names}: {' '.join(log.split())}"
