"""Calls GLSL functions from Python on arrays, so that shader code can be tested and plotted."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ..base.expect import expect, expect_number, expect_path
from ..base.resources import resource_folder
from ..errors import UsageError
from .context import Context, current_context, open_context
from .float_texture import float_texture
from .glsl_types import Function, Parameter, Sampler, find_functions
from .marshal import broadcast_shape, from_words, to_words
from .program import compile_sources
from .source import ProgramSource, assemble, display_name

_CHUNK = 1 << 18  # evaluations per transfer; it limits the buffers to 64 MiB for arrays of any length
_MAX_WORDS = 64  # OpenGL 3.3 guarantees 16 attributes of 4 components, and 64 captured components

_MAIN = re.compile(r"\bvoid\s+main\s*\(\s*(?:void)?\s*\)\s*\{")


def call_glsl(
    file: str | Path,
    function: str,
    /,
    *,
    defines: Mapping[str, float] | None = None,
    context: Context | None = None,
    **arrays: Any,
) -> Any:
    """Call a function of a GLSL file on the GPU, in float32, for each element of `arrays`.

    `file` is in the shaders folder ("bsdf/ggx.glsl") or a path to a file of your own. `defines` are the switches to
    compile it with. `function` is the function's name. If several functions have that name, the one whose parameters
    have the names of `arrays` is called; the parameter types may be given too: "square(vec3)".

    Each of `arrays` has the name of a parameter. Its shape ends in the shape of the parameter's type: () for a scalar,
    (3,) for a vec3, (rows, columns) for a matrix. The axes before that broadcast against one another. A plain number
    is used for all components. A struct takes a dict of its members, or an array with all their components on its last
    axis. int, uint and bool are passed exactly. A sampler2D takes a picture (H, W) or (H, W, 1 to 4), which is filtered
    linearly and clamped at its edges; row 0 is at texture coordinate 0. A tuple of arrays has its mip levels,
    each half as large as the one before.

    Returns the result with the same leading axes as float32, int32, uint32 or bool; a struct is returned as a dict. For
    a function with out parameters it returns a dict of those, and "return" is the function's return value.

    `context` is the context to compute in (`viewer.gpu.context.open_context`). By default all calls of a thread share
    one. Raises ShaderError, with file and line, for a file that does not compile, and UsageError for a function that
    does not exist or an argument that does not fit.
    """
    expect_path(file, "file")
    expect(function, str, "function", "the name of one")
    expect(defines, (Mapping, type(None)), "defines", "a dict")
    for name, value in (defines or {}).items():
        expect(name, str, f"defines: {name!r}", "the name of a switch")
        if not isinstance(value, bool):
            expect_number(value, f"defines[{name!r}]")
    expect(context, (Context, type(None)), "context", "a Context")
    packaged = (resource_folder("shaders") / file).is_file()
    source = _without_main(assemble(file if packaged else Path(file).absolute(), defines))
    chosen = _choose(find_functions(source.text), function, arrays, display_name(source.files[0]))
    words = [(parameter.name, leaf) for parameter in chosen.inputs if not isinstance(parameter.type, Sampler)
             for leaf in to_words(parameter.type, arrays[parameter.name], parameter.name)]
    shape = broadcast_shape(words)
    # A value that is the same for all elements is passed as a uniform: as an attribute it would need an array.
    constant = tuple(leaf.ndim == 1 for _, leaf in words)
    layout = _Layout.of(chosen, [leaf.shape[-1] for _, leaf in words], constant)
    with _current(context) as gl_context:
        program = _program(gl_context, source, layout)
        for unit, parameter in enumerate(p for p in chosen.inputs if isinstance(p.type, Sampler)):
            _bind(gl_context.gl, program, unit, parameter, arrays[parameter.name])
        varying = [np.broadcast_to(leaf, (*shape, leaf.shape[-1])).reshape(-1, leaf.shape[-1])
                   for (_, leaf), fixed in zip(words, constant) if not fixed]
        fixed_words = [leaf for (_, leaf), fixed in zip(words, constant) if fixed]
        if fixed_words and "call_constants" in program:
            uniform: Any = program["call_constants"]
            uniform.write(np.concatenate(fixed_words)[: uniform.array_length].tobytes())
        columns = _run(gl_context.gl, program, layout, varying, int(np.prod(shape, dtype=int)))
    leaves = iter([column.reshape(*shape, column.shape[-1]) for column in columns])
    results = {name: from_words(type_, leaves) for name, type_ in layout.results}
    return results if chosen.outputs else results["return"]


@dataclass(frozen=True)
class _Layout:
    """How a call's arguments and results are stored as 32-bit words.

    `widths` has the number of words of each leaf of the arguments, and `constant` whether that leaf is a uniform.
    """

    function: Function
    widths: tuple[int, ...]
    constant: tuple[bool, ...]

    @classmethod
    def of(cls, function: Function, widths: Sequence[int], constant: tuple[bool, ...]) -> _Layout:
        layout = cls(function, tuple(widths), constant)
        for words, verb in ((layout.inputs, "takes"), (layout.outputs, "returns")):
            if words > _MAX_WORDS:
                raise UsageError(f"{function}: it {verb} {words} components that vary; OpenGL 3.3 passes at most "
                                 f"{_MAX_WORDS}")
        if not layout.results:
            raise UsageError(f"{function}: it returns nothing")
        return layout

    @property
    def inputs(self) -> int:
        return sum(width for width, fixed in zip(self.widths, self.constant) if not fixed)

    @property
    def constants(self) -> int:
        return sum(self.widths) - self.inputs

    @property
    def outputs(self) -> int:
        return sum(self.result_widths)

    @property
    def result_widths(self) -> list[int]:
        return [leaf.size for _, type_ in self.results for leaf in type_.leaves()]

    @property
    def results(self) -> list[tuple[str, Any]]:
        returned = [("return", self.function.result)] if self.function.result else []
        return returned + [(parameter.name, parameter.type) for parameter in self.function.outputs]

    def main(self) -> list[str]:
        """The lines of GLSL that call the function."""
        lines = [f"in {_vector(size)} call_in_{i};" for i, size in enumerate(_sizes(self.inputs))]
        lines += [f"flat out {_vector(size)} call_out_{i};" for i, size in enumerate(_sizes(self.outputs))]
        lines += [f"uniform uint call_constants[{self.constants}];"] if self.constants else []
        lines += [f"uniform sampler2D call_{p.name};" for p in self.function.inputs if isinstance(p.type, Sampler)]
        lines += ["void main() {"]
        words = self._input_words()
        for parameter in self.function.parameters:
            if not isinstance(parameter.type, Sampler):
                value = f" = {parameter.type.build(words)}" if parameter.is_in else ""
                lines.append(f"{parameter.type.name} call_{parameter.name}{value};")
        call = f"{self.function.name}({', '.join(f'call_{p.name}' for p in self.function.parameters)});"
        lines.append(f"{self.function.result.name} call_return = {call}" if self.function.result else call)
        found = [word for name, type_ in self.results for word in type_.words(f"call_{name}")]
        for i, size in enumerate(_sizes(self.outputs)):
            lines.append(f"call_out_{i} = {_vector(size)}({', '.join(found[4 * i : 4 * i + size])});")
        return [*lines, "}"]

    def _input_words(self) -> Iterator[str]:
        varying = (f"call_in_{i}" + (f"[{j}]" if size > 1 else "")
                   for i, size in enumerate(_sizes(self.inputs)) for j in range(size))
        constants = (f"call_constants[{i}]" for i in range(self.constants))
        for width, fixed in zip(self.widths, self.constant):
            yield from (next(constants if fixed else varying) for _ in range(width))


def _sizes(words: int) -> list[int]:
    """The sizes of the vectors, of up to four components, that hold so many words."""
    return [min(4, words - first) for first in range(0, words, 4)]


def _vector(size: int) -> str:
    return "uint" if size == 1 else f"uvec{size}"


def _run(gl: moderngl.Context, program: moderngl.Program, layout: _Layout, varying: list[np.ndarray],
         count: int) -> list[np.ndarray]:
    """Run the program: from the leaves of the varying arguments to those of the results, each (count, n) uint32."""
    columns = [np.empty((count, width), np.uint32) for width in layout.result_widths]
    length = min(count, _CHUNK)
    if not length:
        return columns
    rows = np.empty((length, layout.inputs), np.uint32)
    # OpenGL needs a complete framebuffer even though transform feedback draws nothing into it.
    target, drawn_to = gl.simple_framebuffer((1, 1)), gl.fbo
    target.use()
    captured = gl.buffer(reserve=4 * length * layout.outputs)
    attributes = gl.buffer(reserve=max(rows.nbytes, 4))
    # The driver removes an attribute from the program if the result does not depend on it.
    sizes = _sizes(layout.inputs)
    names = [f"call_in_{i}" for i in range(len(sizes)) if f"call_in_{i}" in program]
    formats = " ".join(f"{size}u" if f"call_in_{i}" in program else f"{4 * size}x" for i, size in enumerate(sizes))
    vertices = gl.vertex_array(program, [(attributes, formats, *names)] if names else [])
    for first in range(0, count, length):
        n = min(length, count - first)
        _interleave(rows, [leaf[first : first + n] for leaf in varying])
        attributes.write(rows[:n])
        vertices.transform(captured, mode=moderngl.POINTS, vertices=n)
        found = np.frombuffer(captured.read(4 * n * layout.outputs), np.uint32).reshape(n, layout.outputs)
        start = 0
        for column in columns:
            column[first : first + n] = found[:, start : start + column.shape[1]]
            start += column.shape[1]
    if drawn_to is not None and not isinstance(drawn_to.mglo, moderngl.InvalidObject):
        drawn_to.use()
    for resource in (vertices, attributes, captured, target):
        resource.release()
    return columns


def _interleave(rows: np.ndarray, leaves: list[np.ndarray]) -> None:
    start = 0
    for leaf in leaves:
        rows[: len(leaf), start : start + leaf.shape[1]] = leaf
        start += leaf.shape[1]


def _choose(functions: list[Function], asked: str, arrays: Mapping[str, Any], file: str) -> Function:
    name, _, types = asked.partition("(")
    named = [function for function in functions if function.name == name.strip()]
    if types:
        wanted = tuple(part.strip() for part in types.rstrip(") ").split(",") if part.strip())
        named = [function for function in named if function.types == wanted]
    if not named:
        names = ", ".join(sorted({function.name for function in functions if function.name != "main"})) or "none"
        raise UsageError(f"{file}: there is no function {asked} that can be called; there are {names}")
    fitting = [function for function in named if {p.name for p in function.inputs} == set(arrays)]
    if len(fitting) == 1:
        return fitting[0]
    listed = "; ".join(map(str, named))
    if fitting:
        raise UsageError(f"{file}: several functions fit; name the types of one, {name}(...): {listed}")
    raise UsageError(f"{file}: {asked} was given {', '.join(arrays) or 'nothing'}, but its parameters are {listed}")


def _without_main(source: ProgramSource) -> ProgramSource:
    """The source without the `main` of a whole shader, which uses variables of its stage. Line numbers stay as is."""
    match = _MAIN.search(source.text)
    if match is None:
        return source
    end, depth = match.end(), 1
    while depth and end < len(source.text):
        depth += {"{": 1, "}": -1}.get(source.text[end], 0)
        end += 1
    blank = "\n" * source.text.count("\n", match.start(), end)
    return replace(source, text=source.text[: match.start()] + blank + source.text[end:])


_programs: WeakKeyDictionary[Context, dict[str, moderngl.Program]] = WeakKeyDictionary()
_shared = threading.local()


def _program(context: Context, source: ProgramSource, layout: _Layout) -> moderngl.Program:
    main = layout.main()
    text = source.text + "\n".join(main) + "\n"
    programs = _programs.setdefault(context, {})
    if text not in programs:
        origins = source.origins + [source.origins[layout.function.line]] * len(main)
        varyings = [f"call_out_{i}" for i in range(len(_sizes(layout.outputs)))]
        programs[text] = compile_sources(context, {"vertex": replace(source, text=text, origins=origins)}, varyings)
    return programs[text]


@contextmanager
def _current(context: Context | None) -> Iterator[Context]:
    """Makes `context`, or the one that this thread's calls share, current in the block."""
    if context is None:
        if getattr(_shared, "context", None) is None:
            previous = current_context()
            _shared.context = open_context()
            if previous is not None:
                previous.make_current()
        context = _shared.context
    previous = current_context()
    context.make_current()
    try:
        yield context
    finally:
        if previous is not None and previous is not context:
            previous.make_current()


def _bind(gl: moderngl.Context, program: moderngl.Program, unit: int, parameter: Parameter, picture: Any) -> None:
    are_levels = isinstance(picture, tuple) and picture and all(isinstance(level, np.ndarray) for level in picture)
    levels = [np.asarray(level, np.float32) for level in (picture if are_levels else (picture,))]
    for pixels in levels:
        if pixels.ndim not in (2, 3) or not pixels.size or (pixels.ndim == 3 and pixels.shape[2] > 4):
            raise UsageError(f"{parameter.name}: sampler2D takes a picture (H, W) or (H, W, 1 to 4), "
                             f"not an array of shape {pixels.shape}")
    levels = [pixels if pixels.ndim == 3 else pixels[..., None] for pixels in levels]
    for before, after in pairwise(pixels.shape for pixels in levels):
        half = max(before[0] // 2, 1), max(before[1] // 2, 1), before[2]
        if after != half:
            raise UsageError(f"{parameter.name}: the mip level after one of shape {before} has {half}, not {after}")
    if f"call_{parameter.name}" in program:
        texture = float_texture(gl, *levels)
        texture.use(unit)
        program[f"call_{parameter.name}"] = unit
