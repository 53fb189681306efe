"""glslangValidator as a second compiler, strict where Mesa is lenient, and what OpenGL 3.3 grants a program."""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from compiled import Sources

from viewer.gpu.source import ProgramSource, display_name

GRANTED = {"textures of a stage": 16, "uniform components of a stage": 1024, "varying components": 60,
           "vertex attributes": 16, "outputs": 8, "uniform blocks of a stage": 12, "bytes of a uniform block": 16384}
"""The least that a driver of OpenGL 3.3 may have (OpenGL 3.3 Core Specification, tables 6.44 to 6.49)."""

_ENDINGS = {"vertex": "vert", "fragment": "frag"}
_COMPONENTS = {"float": 1, "int": 1, "uint": 1, "bool": 1}
_DECLARATION = re.compile(r"^(?:layout\s*\([^)]*\)\s*)?(?:(?:flat|smooth|centroid)\s+)*"
                          r"(in|out|uniform)\s+(\w+)\s*([^;{}()]*)(;|\{)", re.MULTILINE)
_FILE = re.compile(r"(\w+)\.(?:vert|frag)")
_LOCATED = re.compile(r"(?:ERROR|WARNING): \d+:(\d+): (.*)")
_BLOCK = re.compile(r"uniform\s+\w+\s*\{\s*(\w+)\s+\w+\s*\[\s*(\d+)\s*\]\s*;\s*\}")
# In GLSL 3.30 glslang has this extension but not its qualifier `precise`. It gets what a driver without it gets.
_EXTENSION = re.compile(r"#extension GL_ARB_gpu_shader5 : enable|\|\| defined\(GL_ARB_gpu_shader5\)")


def as_330(program: Sources) -> Sources:
    """The program as a driver gets it that has no later GLSL and no extension."""
    return {stage: replace(source, text=_EXTENSION.sub("", _versioned(source.text, 330)))
            for stage, source in program.items()}


def as_400(program: Sources) -> Sources:
    return {stage: replace(source, text=_versioned(source.text, 400)) for stage, source in program.items()}


def _versioned(text: str, version: int) -> str:
    return re.sub(r"\A#version \d+", f"#version {version}", text)


def problems(programs: Iterable[Sources]) -> tuple[list[str], dict[str, int]]:
    """What the compiler refuses, a line each, and the most that a program takes of what `GRANTED` names.

    All stages are compiled by one process. Linking takes a process for each program, so of the programs whose stages
    declare the same to one another one is linked.
    """
    unique = {tuple((stage, source.text) for stage, source in program.items()): program for program in programs}
    stages = {key: (f"s{number}", source) for number, (key, source) in enumerate(
        {(stage, source.text): source for program in unique.values() for stage, source in program.items()}.items())}
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for (stage, text), (name, _) in stages.items():
            files.append(f"{name}.{_ENDINGS[stage]}")
            Path(folder, files[-1]).write_text(text)
        found = _located(_run(folder, files), dict(stages.values()))
        if found:
            return found, {}
        plain = re.split(r"^(?=#version )", _run(folder, ["-E", *files]), flags=re.MULTILINE)
        plain = [text for text in plain if text.startswith("#version")]
        assert len(plain) == len(files)
        plain_of = dict(zip(stages, plain, strict=True))
        declared = {key: _declarations(text) for key, text in plain_of.items()}
        most, linked = dict.fromkeys(GRANTED, 0), {}
        for key, (_, source) in stages.items():
            for name, count in _taken(key[0], declared[key], plain_of[key]).items():
                most[name] = max(most[name], count)
                if count > GRANTED[name]:
                    found.append(f"{display_name(source.files[0])}: {count} {name}; OpenGL 3.3 grants {GRANTED[name]}")
        for key, program in unique.items():
            title = " + ".join(display_name(source.files[0]) for source in program.values())
            linked.setdefault(_interface([declared[part] for part in key]), (key, title))
        for key, title in linked.values():
            told = _run(folder, ["-l", *(f"{stages[part][0]}.{_ENDINGS[part[0]]}" for part in key)])
            found += [f"{title}: {line}" for line in told.splitlines() if line.startswith(("ERROR", "WARNING"))]
    return list(dict.fromkeys(found)), most


def _interface(stages: Sequence[Sequence[tuple[str, str, str]]]) -> tuple[object, ...]:
    """What the stages of a program declare to one another: outputs, inputs, and uniforms that several of them name."""
    uniforms = [{declared for declared in stage if declared[0] == "uniform"} for stage in stages]
    names = [{name for _, _, name in stage} for stage in uniforms]
    shared = set.intersection(*names)
    return tuple(frozenset(declared for declared in stage if declared[0] != "uniform" or declared[2] in shared)
                 for stage in stages)


def _run(folder: str, arguments: Sequence[str]) -> str:
    done = subprocess.run(["glslangValidator", *arguments], cwd=folder, capture_output=True, text=True)
    return done.stdout + (done.stderr if "-E" not in arguments else "")


def _located(output: str, sources: dict[str, ProgramSource]) -> list[str]:
    """The messages of a run, at the places in our own files. They follow the name of the file that they are about."""
    found, name = [], ""
    for line in output.splitlines():
        file, message = _FILE.fullmatch(line), _LOCATED.match(line)
        name = file[1] if file else name
        if message:
            origin, number = sources[name].origins[int(message[1]) - 1]
            if not message[2].endswith(("missing #endif ", "compilation terminated ")):
                found.append(f"{display_name(origin)}:{number}: {message[2].strip()}")
    return list(dict.fromkeys(found))


def _declarations(text: str) -> list[tuple[str, str, str]]:
    """Storage, type and declared names of what a preprocessed stage shares with other stages and with the program."""
    return [(storage, type_, " ".join(names.split()))
            for storage, type_, names, _ in _DECLARATION.findall(text)]


def _count(type_: str, names: str, rounded: bool) -> int:
    """The components of a declaration: of a matrix or vector as whole vec4s where `rounded`, as some drivers do."""
    vector = re.fullmatch(r"[iub]?vec(\d)", type_)
    matrix = re.fullmatch(r"mat(\d)(?:x(\d))?", type_)
    if vector:
        columns, rows = 1, int(vector[1])
    elif matrix:
        columns, rows = int(matrix[1]), int(matrix[2] or matrix[1])
    elif type_ in _COMPONENTS:
        columns, rows = 1, 1
    else:
        return 0  # a sampler, or a block
    each = columns * (4 if rounded else rows)
    return each * _number(names)


def _number(names: str) -> int:
    """Of variables that a declaration makes, an array's elements counted one by one."""
    lengths = [re.search(r"\[\s*(\d+)\s*\]", name) for name in names.split(",")]
    return sum(int(length[1]) if length else 1 for length in lengths)


def _taken(stage: str, declared: list[tuple[str, str, str]], text: str) -> dict[str, int]:
    """What one stage takes of what `GRANTED` names."""
    of = {wanted: [(type_, names) for storage, type_, names in declared if storage == wanted]
          for wanted in ("in", "out", "uniform")}
    count = {wanted: sum(len(names.split(",")) for _, names in of[wanted]) for wanted in of}
    blocks = _blocks(text)
    taken = {"textures of a stage": sum(_number(names) for type_, names in of["uniform"] if "sampler" in type_),
             "uniform components of a stage": sum(_count(*uniform, rounded=True) for uniform in of["uniform"]),
             "uniform blocks of a stage": len(blocks), "bytes of a uniform block": max(blocks, default=0)}
    if stage == "vertex":
        return taken | {"vertex attributes": count["in"],
                        "varying components": sum(_count(*output, rounded=False) for output in of["out"])}
    return taken | {"outputs": count["out"]}


def _blocks(text: str) -> list[int]:
    """The bytes of each uniform block of a preprocessed stage. Each is an array of a struct of vec4 and mat4."""
    found = []
    for type_, count in _BLOCK.findall(text):
        members = re.search(rf"struct {type_}\s*\{{([^}}]*)\}}", text)
        assert members
        sizes = [{"vec4": 16, "mat4": 64}[kind] * len(names.split(",")) for kind, names in
                 re.findall(r"(\w+)\s+([\w\s,]+);", members[1])]
        found.append(sum(sizes) * int(count))
    return found
