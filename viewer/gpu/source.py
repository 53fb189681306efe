"""Shader sources put together from files: `#include`, switches, and the way back from a line to its file.

    #include "bsdf/ggx.glsl"

takes a file of the shaders folder, once per program however often it is named. A user's own shader, outside that
folder, may also include what lies in its folder, and may name the `#version` it needs. Features are chosen by switches,
numbers that every program gets as `#define`s and asks for with `#if`; one that is misspelt is an error, not off.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..base.resources import resource_folder
from ..errors import ShaderError

_MAX_DEPTH = 32

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DIRECTIVE = re.compile(r"\s*#\s*(\w+)\s*(.*)")
_INCLUDE = re.compile(r'"([^"]+)"\s*$')
_IDENTIFIER = re.compile(r"\b[A-Za-z_]\w*")
_PREDEFINED = re.compile(r"GL_\w+|__\w+__|defined")


@dataclass
class ProgramSource:
    """One shader ready to compile: its text, the files it is from, and for each line of the text its file and line.

    The lines are kept here because `#line` cannot say it: Mesa (22.3) forgets the source-string number in expressions,
    and before GLSL 3.30 the directive numbers from the line after the next.
    """

    text: str
    files: list[Path]
    origins: list[tuple[Path, int]]


def assemble(path: str | Path, defines: Mapping[str, float] | None = None, version: int = 330) -> ProgramSource:
    """The shader in `path`, relative to the shaders folder or absolute, with its includes and a header of `defines`.

    Raises ShaderError, naming file and line, for an include that is missing, malformed or goes in a circle, and for a
    switch that neither `defines` nor a `#define` in the sources knows.
    """
    defines = defines or {}
    file = _find(path)
    assembly = _Assembly()
    assembly.emit(f"#version {version} core", file, 1)
    for name, value in defines.items():
        assembly.emit(f"#define {name} {value + 0}", file, 1)  # + 0 makes numbers of True and False
    assembly.add(file, [], conditional=False)
    assembly.lines[0] = f"#version {max(version, assembly.version)} core"
    assembly.check_switches(defines)
    return ProgramSource("\n".join(assembly.lines) + "\n", assembly.files, assembly.origins)


def source_files(*paths: str | Path) -> list[Path]:
    """Every file that goes into the shaders in `paths`, themselves among them: what to watch for a reload."""
    assembly = _Assembly()
    for path in paths:
        assembly.add(_find(path), [], conditional=False)
    return assembly.files


def display_name(file: Path) -> str:
    """A source file's name for messages: from `shaders/` on for our own, in full for others."""
    folder = resource_folder("shaders")
    return file.relative_to(folder.parent).as_posix() if file.is_relative_to(folder) else str(file)


@dataclass
class _Assembly:
    lines: list[str] = field(default_factory=list)
    origins: list[tuple[Path, int]] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    complete: set[Path] = field(default_factory=set)  # what is in the text whatever the switches are
    defined: set[str] = field(default_factory=set)
    used: dict[str, str] = field(default_factory=dict)  # switch -> where it is first asked for
    version: int = 0  # that a user's own shader names; OpenGL ES counts its own way

    def emit(self, text: str, file: Path, line: int) -> None:
        self.lines.append(text)
        self.origins.append((file, line))

    def add(self, file: Path, chain: list[Path], conditional: bool) -> None:
        """Append `file`, which `chain` of files led to; `conditional` is true inside an #if of one of them."""
        if file in self.complete:
            return
        if file in chain:
            circle = [*chain[chain.index(file) :], file]
            raise ShaderError(f"#include goes in a circle: {' -> '.join(map(display_name, circle))}")
        if len(chain) == _MAX_DEPTH:
            raise ShaderError(f"{display_name(chain[-1])}: #include is nested more than {_MAX_DEPTH} deep")
        if file not in self.files:
            self.files.append(file)
        # Inside an #if this copy may be skipped and a later one needed, so there may be several of which the first
        # that the switches reach counts.
        guard = f"INCLUDED_{self.files.index(file)}"
        self.emit(f"#ifndef {guard}", file, 1)
        self.emit(f"#define {guard}", file, 1)
        depth, shown = 0, display_name(file)
        for line, code in enumerate(_without_comments(_read(file)).split("\n"), start=1):
            directive = _DIRECTIVE.match(code)
            name, rest = directive.groups() if directive else ("", "")
            place = f"{shown}:{line}"
            if name == "include":
                included = _INCLUDE.match(rest)
                if not included:
                    raise ShaderError(f'{place}: expected #include "file", found {code.strip()}')
                self.add(self._find_include(included[1], file, chain, place), [*chain, file], conditional or depth > 0)
                continue
            if name == "version" and not chain and not file.is_relative_to(resource_folder("shaders")):
                number, _, profile = rest.strip().partition(" ")
                self.version = int(number) if number.isdigit() and profile.strip() != "es" else 0
                self.emit("", file, line)
                continue
            if name == "version":
                raise ShaderError(f"{place}: #version is not for the file to say, it comes before all includes")
            depth += name in ("if", "ifdef", "ifndef")
            depth -= name == "endif"
            self._note_switches(name, rest, place)
            self.emit(code, file, line)
        self.emit("#endif", file, line)
        if not conditional:
            self.complete.add(file)

    def _find_include(self, name: str, includer: Path, chain: list[Path], place: str) -> Path:
        shaders = resource_folder("shaders")
        root = chain[0] if chain else includer
        for folder in [shaders] if includer.is_relative_to(shaders) else [root.parent, shaders]:
            file = (folder / name).resolve()
            if file.is_file():
                return file
        raise ShaderError(f"{place}: there is no shader file {name}")

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


def _find(path: str | Path) -> Path:
    file = (resource_folder("shaders") / path).resolve()
    if not file.is_file():
        raise ShaderError(f"there is no shader file {path}")
    return file


def _without_comments(text: str) -> str:
    return _COMMENT.sub(lambda match: "\n" * match[0].count("\n") or " ", text)


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8").replace("\r\n", "\n")
    except (OSError, UnicodeDecodeError) as error:
        raise ShaderError(f"{display_name(file)}: {error}") from error
