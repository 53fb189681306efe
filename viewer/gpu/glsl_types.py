"""GLSL's value types and their numpy shapes, and a parser for the functions that a GLSL text defines.

A value is a tree (structs) whose leaves are scalars, vectors or matrices. It is passed to the GPU and back as a row of
32-bit words, one word per component.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

_KINDS = {"float": "", "int": "i", "uint": "u", "bool": "b"}
_TO_WORD = {"float": "floatBitsToUint({})", "int": "uint({})", "uint": "{}", "bool": "uint({})"}
_FROM_WORD = {"float": "uintBitsToFloat({})", "int": "int({})", "uint": "{}", "bool": "({} != 0u)"}


@dataclass(frozen=True)
class Basic:
    """A scalar (shape ()), vector (n,) or matrix (rows, columns) of `kind` float, int, uint or bool."""

    name: str
    kind: str
    shape: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """The number of words, which equals the number of components."""
        size = 1
        for extent in self.shape:
            size *= extent
        return size

    def leaves(self) -> list[Basic]:
        return [self]

    def build(self, words: Iterator[str]) -> str:
        """A GLSL expression that builds the value; `words` yields the expressions of its words."""
        parts = [_FROM_WORD[self.kind].format(next(words)) for _ in range(self.size)]
        if not self.shape:
            return parts[0]
        if len(self.shape) == 2:  # numpy stores rows, GLSL columns
            rows, columns = self.shape
            parts = [parts[row * columns + column] for column in range(columns) for row in range(rows)]
        return f"{self.name}({', '.join(parts)})"

    def words(self, value: str) -> list[str]:
        """The GLSL expressions of the words of the value that the expression `value` denotes."""
        if not self.shape:
            parts = [value]
        elif len(self.shape) == 1:
            parts = [f"{value}[{i}]" for i in range(self.shape[0])]
        else:
            parts = [f"{value}[{column}][{row}]" for row in range(self.shape[0]) for column in range(self.shape[1])]
        return [_TO_WORD[self.kind].format(part) for part in parts]


@dataclass(frozen=True)
class Struct:
    name: str
    members: tuple[tuple[str, Type], ...]

    def leaves(self) -> list[Basic]:
        return [leaf for _, member in self.members for leaf in member.leaves()]

    def build(self, words: Iterator[str]) -> str:
        return f"{self.name}({', '.join([member.build(words) for _, member in self.members])})"

    def words(self, value: str) -> list[str]:
        return [word for name, member in self.members for word in member.words(f"{value}.{name}")]


@dataclass(frozen=True)
class Sampler:
    """sampler2D, which is passed as a texture and not as words."""

    name: str = "sampler2D"


Type = Basic | Struct


@dataclass(frozen=True)
class Parameter:
    name: str
    type: Type | Sampler
    is_in: bool
    is_out: bool


@dataclass(frozen=True)
class Function:
    """`result` is None for void; `line` is the line of the definition in the text, counted from 0."""

    name: str
    result: Type | None
    parameters: tuple[Parameter, ...]
    line: int

    @property
    def inputs(self) -> list[Parameter]:
        return [parameter for parameter in self.parameters if parameter.is_in]

    @property
    def outputs(self) -> list[Parameter]:
        return [parameter for parameter in self.parameters if parameter.is_out]

    @property
    def types(self) -> tuple[str, ...]:
        return tuple(parameter.type.name for parameter in self.parameters)

    def __str__(self) -> str:
        named = (("inout " if p.is_in else "out ") * p.is_out + f"{p.type.name} {p.name}" for p in self.parameters)
        return f"{self.name}({', '.join(named)})"


def _basic_types() -> dict[str, Basic]:
    types = {kind: Basic(kind, kind) for kind in _KINDS}
    for kind, prefix in _KINDS.items():
        types |= {f"{prefix}vec{n}": Basic(f"{prefix}vec{n}", kind, (n,)) for n in (2, 3, 4)}
    for columns in (2, 3, 4):
        types |= {f"mat{columns}x{n}": Basic(f"mat{columns}x{n}", "float", (n, columns)) for n in (2, 3, 4)}
        types[f"mat{columns}"] = Basic(f"mat{columns}", "float", (columns, columns))
    return types


BASIC_TYPES = _basic_types()

_STRUCT = re.compile(r"\bstruct\s+(\w+)\s*\{([^{}]*)\}")
_FUNCTION = re.compile(r"\b(\w+)\s+(\w+)\s*\(([^(){};]*)\)\s*\{")
_PARAMETER = re.compile(
    r"(?:(?:const|highp|mediump|lowp|(?P<direction>inout|in|out))\s+)*(?P<type>\w+)\s+(?P<name>\w+)$")
_PRECISION = re.compile(r"\b(?:highp|mediump|lowp)\b")


@lru_cache(maxsize=64)  # the functions of a file are called again and again
def find_functions(text: str) -> list[Function]:
    """The functions that GLSL `text` (without comments) defines, in order, as far as this module has their types.

    Both branches of an `#if` are read. If several definitions have the same name and types, the first one counts.
    """
    text = re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)
    types = _structs(text)
    functions: dict[tuple[str, tuple[str, ...]], Function] = {}
    for match in _FUNCTION.finditer(text):
        result, name, listed = match.groups()
        parameters = _parameters(listed, types)
        if parameters is None or (result not in types and result != "void"):
            continue
        function = Function(name, types.get(result), parameters, text.count("\n", 0, match.start()))
        functions.setdefault((name, function.types), function)
    return list(functions.values())


def _structs(text: str) -> dict[str, Type]:
    types: dict[str, Type] = dict(BASIC_TYPES)
    for name, body in _STRUCT.findall(text):
        members: list[tuple[str, Type]] = []
        for declaration in filter(str.strip, _PRECISION.sub("", body).split(";")):
            type_name, _, names = declaration.strip().partition(" ")
            if type_name not in types or "[" in names:
                break
            members += [(member.strip(), types[type_name]) for member in names.split(",")]
        else:
            types.setdefault(name, Struct(name, tuple(members)))
    return types


def _parameters(listed: str, types: Mapping[str, Type]) -> tuple[Parameter, ...] | None:
    if listed.strip() in ("", "void"):
        return ()
    parameters = []
    for declaration in listed.split(","):
        match = _PARAMETER.match(" ".join(declaration.split()))
        if match is None or (match["type"] not in types and match["type"] != "sampler2D"):
            return None
        direction = match["direction"] or "in"
        type_ = types.get(match["type"], Sampler())
        parameters.append(Parameter(match["name"], type_, is_in=direction != "out", is_out=direction != "in"))
    return tuple(parameters)
