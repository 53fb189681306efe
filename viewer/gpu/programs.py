"""The shader programs of a renderer. Each is compiled once, and again when its files have changed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from ..errors import ShaderError
from .context import Context
from .program import compile_program
from .source import source_files

Key = tuple[str, str, tuple[tuple[str, float], ...]]


class Programs:
    """Compiled programs; the key is vertex file, fragment file and switches."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._programs: dict[Key, moderngl.Program] = {}
        self._owners: dict[moderngl.Program, object] = {}
        self.generation = 0
        """The number of reloads so far. Vertex arrays that were made for a program are invalid after a reload."""

    def get(self, vertex: str, fragment: str, switches: Mapping[str, float]) -> moderngl.Program:
        key = (vertex, fragment, tuple(sorted(switches.items())))
        if key not in self._programs:
            self._programs[key] = self._compile(key)
        return self._programs[key]

    def claim(self, program: moderngl.Program, owner: object) -> bool:
        """Whether another than `owner` claimed the program last, so that its uniforms have to be set anew."""
        is_new = self._owners.get(program) is not owner
        self._owners[program] = owner
        return is_new

    def __len__(self) -> int:
        return len(self._programs)

    def files(self) -> set[Path]:
        """Every shader file in use, for watching them."""
        return set(source_files(*dict.fromkeys(path for key in self._programs for path in key[:2])))

    def reload(self) -> str | None:
        """Compile everything again and return None. On an error the programs stay as they are; returns its text."""
        fresh: dict[Key, moderngl.Program] = {}
        try:
            for key in self._programs:
                fresh[key] = self._compile(key)
        except ShaderError as error:
            for program in fresh.values():
                program.release()
            return str(error)
        self.release()
        self._programs = fresh
        self.generation += 1
        return None

    def release(self) -> None:
        for program in self._programs.values():
            if program.extra is not None:  # the vertex array of a fullscreen pass
                program.extra.release()
            program.release()
        self._programs = {}
        self._owners = {}

    def _compile(self, key: Key) -> moderngl.Program:
        vertex, fragment, switches = key
        return compile_program(self._context, vertex=vertex, fragment=fragment, defines=dict(switches))


def set_uniform(program: moderngl.Program, name: str, value: object) -> None:
    """Set a uniform. A uniform that the driver has removed, because no pixel depends on it, is skipped."""
    member: Any = program.get(name, None)  # the type stubs also allow attributes, varyings and blocks
    if member is None:
        return
    if isinstance(value, bytes):
        member.write(value)
    else:
        member.value = value


def matrix_uniform(matrix: np.ndarray) -> bytes:
    """A matrix as the bytes of a float32 uniform, which are in column order."""
    return np.ascontiguousarray(matrix.T, np.float32).tobytes()
