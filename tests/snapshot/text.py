"""What a compiler sees of a shader: its code without comments, blank lines and what switches leave out."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence

from internals import ProgramSource, display_name

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DIRECTIVE = re.compile(r"#\s*(\w+)\s*(.*)")
_GUARD = re.compile(r"INCLUDED_\d+\b")


def code_lines(text: str) -> list[str]:
    """The lines of code that the conditions of `text` keep; macros that it defines stay, guards of includes do not.

    A name that nothing defines is 0, as for any preprocessor, so that extensions of a driver count as not there.
    """
    macros: dict[str, str] = {}
    kept: list[str] = []
    open_ifs: list[tuple[bool, bool]] = []  # of each #if around: whether this branch is read, and whether one was
    for line in map(str.strip, _COMMENT.sub(" ", text).split("\n")):
        directive = _DIRECTIVE.match(line)
        name, rest = directive.groups() if directive else ("", "")
        is_read = all(now for now, _ in open_ifs)
        if name in ("if", "ifdef", "ifndef"):
            holds = is_read and _holds(name, rest, macros)
            open_ifs.append((holds, holds or not is_read))
        elif name in ("elif", "else"):
            _, was = open_ifs.pop()
            holds = not was and (name == "else" or _holds("if", rest, macros))
            open_ifs.append((holds, was or holds))
        elif name == "endif":
            open_ifs.pop()
        elif is_read and line:
            if name == "define":
                macro, _, value = rest.partition(" ")
                macros[macro] = value.strip()
            if not _GUARD.search(line):
                kept.append(" ".join(line.split()))
    return kept


def _holds(directive: str, rest: str, macros: dict[str, str]) -> bool:
    if directive != "if":
        return (rest.strip() in macros) == (directive == "ifdef")
    expression = re.sub(r"defined\s*\(?\s*(\w+)\s*\)?", lambda match: str(int(match[1] in macros)), rest)
    while names := re.findall(r"\b[A-Za-z_]\w*", expression):
        for name in set(names):
            expression = re.sub(rf"\b{name}\b", f"({macros.get(name) or 0})", expression)
    expression = re.sub(r"!(?!=)", " not ", expression.replace("&&", " and ").replace("||", " or "))
    return bool(eval(expression))  # whole numbers and operators are all that is left


def program_entries(programs: Sequence[Sequence[ProgramSource]]) -> dict[str, dict[str, object]]:
    """Digest and number of code lines of each program, by its files and the switches that are not 0."""
    entries = {}
    for sources in programs:
        bodies, switches = [], {}
        for source in sources:
            lines = code_lines(source.text)
            header = next((k for k, line in enumerate(source.text.split("\n")[1:], 1)
                           if not line.startswith("#define ")), 0)
            defines = [line.split(None, 2)[1:] for line in source.text.split("\n")[1:header]]
            switches |= {name: value for name, value in defines if float(value)}
            bodies.append([lines[0], *lines[header:]])
        files = " + ".join(display_name(source.files[0]).removeprefix("shaders/") for source in sources)
        key = " ".join([files, *(f"{name}={value}" for name, value in sorted(switches.items()))])
        entries[key] = {"sha256": hashlib.sha256("\n".join(sum(bodies, [])).encode()).hexdigest(),
                        "lines": sum(map(len, bodies))}
    return dict(sorted(entries.items()))
