"""Assembles shader sources from files: `#include`, switches, and a map from each line back to its file.

    #include "bsdf/ggx.glsl"

includes a file of the shaders folder, at most once per program. A user's own shader outside that folder may also
include files of its own folder, and may declare the `#version` that it needs. Switches choose the features of a
program: they are numbers, defined by `#define` at its top and tested with `#if`. Testing a switch that is not defined
is an error, so that a misspelt one is noticed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ..base.resources import resource_folder
from ..errors import ShaderError

_MAX_DEPTH = 32

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DIRECTIVE = re.compile(r"\s*#\s*(\w+)\s*(.*)")
_INCLUDE = re.compile(r'"([^"]+)"\s*$')
_IDENTIFIER = re.compile(r"\b[A-Za-z_]\w*")
_PREDEFINED = re.compile(r"GL_\w+|__\w+__|defined")


class _Block(NamedTuple):
    """Lines without a directive, each with its origin, and the directive that ends them: the number of its line, the
    line, its name, and what follows the name. In the last block of a file the name is empty."""

    lines: list[str]
    origins: list[tuple[Path, int]]
    number: int
    code: str
    name: str
    rest: str


@dataclass
class ProgramSource:
    """One shader ready to compile: its text, its files, and for each line of the text the file and line it comes from.

    `#line` directives cannot replace `origins`: Mesa (22.3) loses the source-string number in expressions, and before
    GLSL 3.30 the directive is off by one line.
    """

    text: str
    files: list[Path]
    origins: list[tuple[Path, int]]


def assemble(path: str | Path, defines: Mapping[str, float] | None = None, version: int = 330) -> ProgramSource:
    """The shader in `path` with its includes, after a header with `defines`.

    `path` is absolute or relative to the shaders folder. Raises ShaderError, with file and line, for an include that is
    missing, malformed or circular, and for a switch that neither `defines` nor a `#define` in the sources defines.
    """
    defines = defines or {}
    file = _find(path)
    assembly = _assembled(file)
    assembly.check_switches(defines)
    switches = [f"#define {name} {value + 0}" for name, value in defines.items()]  # + 0 turns True into a number
    header = [f"#version {max(version, assembly.version)} core", *switches]
    return ProgramSource("\n".join([*header, *assembly.lines]) + "\n", list(assembly.files),
                         [(file, 1)] * len(header) + assembly.origins)


def source_files(*paths: str | Path) -> list[Path]:
    """The files in `paths` and every file that they include, directly or indirectly, for watching them."""
    assembly = _Assembly()
    for path in paths:
        assembly.add(_find(path), [], conditional=False)
    return list(assembly.files)


@cache
def display_name(file: Path) -> str:
    """A source file's name for messages: relative ("shaders/...") inside the shaders folder, else the full path."""
    folder = resource_folder("shaders")
    return file.relative_to(folder.parent).as_posix() if file.is_relative_to(folder) else str(file)


class _File(NamedTuple):
    """A file of a program: its guard, its name for messages, whether it is in the shaders folder, its blocks, and its
    `_state` before it was read."""

    guard: str
    shown: str
    is_ours: bool
    blocks: list[_Block]
    state: tuple[int, ...]


@dataclass
class _Assembly:
    lines: list[str] = field(default_factory=list)
    origins: list[tuple[Path, int]] = field(default_factory=list)
    files: dict[Path, _File] = field(default_factory=dict)
    complete: set[Path] = field(default_factory=set)  # files that are in the text for any values of the switches
    defined: set[str] = field(default_factory=set)
    used: dict[str, str] = field(default_factory=dict)  # switch -> the place that first tests it
    found: dict[tuple[str, Path | None], Path] = field(default_factory=dict)  # by what is included, and by whose shader
    shaders: Path = field(default_factory=lambda: resource_folder("shaders"))
    version: int = 0  # the #version of a user's own shader; 0 for OpenGL ES, which has other numbers

    def emit(self, text: str, file: Path, line: int) -> None:
        self.lines.append(text)
        self.origins.append((file, line))

    def add(self, file: Path, chain: list[Path], conditional: bool) -> None:
        """Append `file`. `chain` are the files that include it, outermost first; `conditional` is true if one of them
        includes it inside an #if."""
        if file in self.complete:
            return
        if file in chain:
            circle = [*chain[chain.index(file) :], file]
            raise ShaderError(f"#include is circular: {' -> '.join(map(display_name, circle))}")
        if len(chain) == _MAX_DEPTH:
            raise ShaderError(f"{display_name(chain[-1])}: #include is nested more than {_MAX_DEPTH} deep")
        if file not in self.files:
            is_ours = file.is_relative_to(self.shaders)
            state = _state(file)
            self.files[file] = _File(f"INCLUDED_{len(self.files)}", display_name(file), is_ours,
                                     _parsed(file, _read(file)), state)
        guard, shown, is_ours, blocks, _ = self.files[file]
        # A copy inside an #if may be skipped by the preprocessor, so a later copy is needed too. The guard makes the
        # first copy that is compiled the only one.
        self.emit(f"#ifndef {guard}", file, 1)
        self.emit(f"#define {guard}", file, 1)
        depth = 0
        for lines, origins, line, code, name, rest in blocks:
            self.lines += lines
            self.origins += origins
            if not name:
                break
            place = f"{shown}:{line}"
            if name == "include":
                included = _INCLUDE.match(rest)
                if not included:
                    raise ShaderError(f'{place}: expected #include "file", found {code.strip()}')
                root = None if is_ours else chain[0] if chain else file
                self.add(self._find_include(included[1], root, place), [*chain, file], conditional or depth > 0)
                continue
            if name == "version" and not chain and not is_ours:
                number, _, profile = rest.strip().partition(" ")
                self.version = int(number) if number.isdigit() and profile.strip() != "es" else 0
                self.emit("", file, line)
                continue
            if name == "version":
                raise ShaderError(f"{place}: #version is not allowed here; it is set for the whole program")
            depth += name in ("if", "ifdef", "ifndef")
            depth -= name == "endif"
            self._note_switches(name, rest, place)
            self.emit(code, file, line)
        self.emit("#endif", file, line)
        if not conditional:
            self.complete.add(file)

    def _find_include(self, name: str, root: Path | None, place: str) -> Path:
        """The file that a shader of ours includes; or that the user's shader `root` does, or what it includes."""
        if (name, root) not in self.found:
            for folder in ([root.parent] if root else []) + [self.shaders]:
                with suppress(FileNotFoundError):
                    self.found[name, root] = _resolved(folder / name)
                    break
            else:
                raise ShaderError(f"{place}: there is no shader file {name}")
        return self.found[name, root]

    def _note_switches(self, directive: str, rest: str, place: str) -> None:
        if directive == "define":
            self.defined.update(_IDENTIFIER.findall(rest)[:1])
        elif directive in ("if", "elif", "ifdef", "ifndef"):
            for name in _IDENTIFIER.findall(rest):
                self.used.setdefault(name, place)

    def check_switches(self, defines: Mapping[str, float]) -> None:
        for name, place in self.used.items():
            if name not in defines and name not in self.defined and not _PREDEFINED.fullmatch(name):
                raise ShaderError(f"{place}: no switch {name} is defined for this program")


_assemblies: dict[Path, _Assembly] = {}
"""Of shaders of ours."""


def _assembled(file: Path) -> _Assembly:
    """The shader without a header. Programs that differ in their switches share it, until one of its files changes. A
    user's own shader is put together each time: a new file may take the place of one that it includes."""
    kept = _assemblies.get(file)
    if kept is not None and all(_state(path) == included.state for path, included in kept.files.items()):
        return kept
    assembly = _Assembly()
    assembly.add(file, [], conditional=False)
    if assembly.files[file].is_ours:
        _assemblies[file] = assembly
    return assembly


def _state(file: Path) -> tuple[int, ...]:
    """Another one when the file has changed."""
    with suppress(OSError):
        state = os.stat(file)
        return state.st_ino, state.st_size, state.st_mtime_ns
    return ()


def _find(path: str | Path) -> Path:
    file = (resource_folder("shaders") / path).resolve()
    if not file.is_file():
        raise ShaderError(f"there is no shader file {path}")
    return file


@cache  # resolving asks the system about each folder on the way
def _resolved(file: Path) -> Path:
    if not file.is_file():
        raise FileNotFoundError(file)
    return file.resolve()


@cache  # a file of many programs is parsed once
def _parsed(file: Path, text: str) -> list[_Block]:
    """The lines of a file without comments, in blocks."""
    code = _COMMENT.sub(lambda match: "\n" * match[0].count("\n") or " ", text)
    blocks: list[_Block] = []
    lines: list[str] = []
    origins: list[tuple[Path, int]] = []
    for number, line in enumerate(code.split("\n"), start=1):
        if found := _DIRECTIVE.match(line):
            blocks.append(_Block(lines, origins, number, line, found[1], found[2]))
            lines, origins = [], []
        else:
            lines.append(line)
            origins.append((file, number))
    return [*blocks, _Block(lines, origins, number, "", "", "")]


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8").replace("\r\n", "\n")
    except (OSError, UnicodeDecodeError) as error:
        raise ShaderError(f"{display_name(file)}: {error}") from error
