"""What the switches leave of a shader: the lines that its compiler sees."""

from __future__ import annotations

import re
from collections.abc import Mapping

from viewer.gpu.source import assemble

_WORD = re.compile(r"\b[A-Za-z_]\w*")


def lines_left(path: str, switches: Mapping[str, int]) -> list[str]:
    """The lines of the shader in `path`, includes among them, without those that an #if leaves out, or blank ones."""
    values: dict[str, str] = {}
    branches: list[tuple[bool, bool]] = []  # of every open #if: whether this branch is on, and whether one was
    lines = []

    def holds(condition: str) -> bool:
        while _WORD.search(condition):  # what a name stands for may have names, too
            condition = _WORD.sub(lambda word: f"({values[word[0]]})", condition)
        condition = condition.replace("&&", " and ").replace("||", " or ")
        return bool(eval(re.sub(r"!(?!=)", " not ", condition)))

    for line in assemble(path, switches).text.splitlines():
        directive, _, rest = line.strip().partition(" ")
        seen = all(on for on, _ in branches)
        if directive in ("#if", "#ifndef"):
            on = seen and (holds(rest) if directive == "#if" else rest not in values)
            branches.append((on, on))
        elif directive in ("#elif", "#else"):
            _, done = branches.pop()
            on = not done and all(on for on, _ in branches) and (directive == "#else" or holds(rest))
            branches.append((on, done or on))
        elif directive == "#endif":
            branches.pop()
        elif seen and directive == "#define":
            name, _, value = rest.partition(" ")
            values[name] = value
        elif seen and line.strip():
            lines.append(line)
    return lines
