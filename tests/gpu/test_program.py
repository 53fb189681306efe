from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from contexts import open_or_skip

import viewer.gpu.source
from viewer.errors import ShaderError
from viewer.gpu.context import Context
from viewer.gpu.program import _explain, compile_program, compile_sources
from viewer.gpu.programs import Programs
from viewer.gpu.source import ProgramSource, assemble, source_files

Write = Callable[[Mapping[str, str]], Path]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Makes a shaders folder of the given files take the place of the package's."""
    folder = tmp_path.resolve() / "shaders"
    monkeypatch.setattr(viewer.gpu.source, "resource_folder", lambda name: tmp_path.resolve() / name)

    def write_files(files: Mapping[str, str]) -> Path:
        for name, text in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)
        return folder

    return write_files


MAIN = "void main() { gl_Position = vec4(f()); }\n"


def test_header_and_includes(write: Write) -> None:
    write({"a.vert": '#include "bsdf/f.glsl"\n' + MAIN, "bsdf/f.glsl": "float f() { return float(N) * SCALE; }\n"})
    source = assemble("a.vert", {"ON": True, "OFF": False, "N": 3, "SCALE": 0.5})
    assert source.text.splitlines()[:5] == [
        "#version 330 core", "#define ON 1", "#define OFF 0", "#define N 3", "#define SCALE 0.5",
    ]  # fmt: skip
    assert source.text.index("float f()") < source.text.index("void main()")
    assert [file.name for file in source.files] == ["a.vert", "f.glsl"]


def test_each_file_once(write: Write) -> None:
    write(
        {
            "a.vert": '#include "x.glsl"\n#include "y.glsl"\n#include "x.glsl"\n',
            "y.glsl": '#include "x.glsl"\nfloat y;\n',
            "x.glsl": "float x;\n",
        }
    )
    text = assemble("a.vert").text
    assert text.count("float x;") == text.count("float y;") == 1


@pytest.mark.parametrize("on", [0, 1])
def test_include_inside_a_condition_does_not_hide_a_later_one(write: Write, context: Context, on: int) -> None:
    write(
        {
            "a.vert": '#if ON\n#include "f.glsl"\n#endif\n#include "f.glsl"\n#include "f.glsl"\n' + MAIN,
            "f.glsl": "float f() { return 1.0; }\n",
        }
    )
    compile_program(context, vertex="a.vert", defines={"ON": on}).release()


def test_comments_are_not_directives(write: Write) -> None:
    write({"a.vert": '// #include "no.glsl"\n/* #if NO\n#include "no.glsl" */\nvoid main() {}\n'})
    assert "no.glsl" not in assemble("a.vert").text


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"a.vert": '\n#include "b.glsl"\n'}, r"shaders/a\.vert:2: there is no shader file b\.glsl"),
        (
            {"a.vert": '#include "b.glsl"\n', "b.glsl": '#include "c.glsl"\n', "c.glsl": '#include "b.glsl"\n'},
            r"is circular: shaders/b\.glsl -> shaders/c\.glsl -> shaders/b\.glsl",
        ),
        ({"a.vert": '#include "a.vert"\n'}, r"shaders/a\.vert -> shaders/a\.vert"),
        ({"a.vert": "#include <b.glsl>\n"}, r"shaders/a\.vert:1: expected #include \"file\""),
        ({"a.vert": "\n\n#version 330\n"}, r"shaders/a\.vert:3: #version"),
        ({"a.vert": "\n#if TYPO\n#endif\n"}, r"shaders/a\.vert:2: no switch TYPO"),
        ({"a.vert": "#if KNOWN\n#elif TYPO\n#endif\n"}, r"shaders/a\.vert:2: no switch TYPO"),
        ({"a.vert": "#ifdef TYPO\n#endif\n"}, r"shaders/a\.vert:1: no switch TYPO"),
        ({"a.vert": "#if KNOWN && !defined(TYPO)\n#endif\n"}, r"shaders/a\.vert:1: no switch TYPO"),
        ({"a.vert": '#include "b.glsl"\n', "b.glsl": "\n#if TYPO\n#endif\n"}, r"shaders/b\.glsl:2: no switch TYPO"),
        ({"b.vert": ""}, r"there is no shader file a\.vert"),
    ],
)
def test_mistakes(write: Write, files: dict[str, str], message: str) -> None:
    write(files)
    with pytest.raises(ShaderError, match=message):
        assemble("a.vert", {"KNOWN": 1})


def test_shaders_are_put_together_anew_when_a_file_changes(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = write({"a.vert": '#include "f.glsl"\n#if SOME\n#endif\n', "f.glsl": "float one;\n"})
    assert "float one;" in assemble("a.vert", {"SOME": 1}).text
    with monkeypatch.context() as patched:
        patched.setattr(viewer.gpu.source, "_read", lambda file: pytest.fail(f"{file} is read again"))
        assert "#define SOME 2\n" in assemble("a.vert", {"SOME": 2}).text
    with pytest.raises(ShaderError, match="no switch SOME"):
        assemble("a.vert")
    other = folder / "other.glsl"
    other.write_text("float two;\n")
    other.replace(folder / "f.glsl")  # as editors do
    assert "float two;" in assemble("a.vert", {"SOME": 1}).text
    (folder / "f.glsl").unlink()
    with pytest.raises(ShaderError, match=r"f\.glsl"):
        assemble("a.vert", {"SOME": 1})


def test_nested_too_deep(write: Write) -> None:
    write({f"{n}.glsl": f'#include "{n + 1}.glsl"\n' for n in range(40)})
    with pytest.raises(ShaderError, match=r"shaders/31\.glsl: #include is nested more than 32 deep"):
        assemble("0.glsl")


def test_known_switches(write: Write) -> None:
    write(
        {"a.vert": "#define OWN 1\n#if OWN == 1 && A > 0x1 && GL_core_profile && __VERSION__ >= 330\n#endif\n"}
    )
    assemble("a.vert", {"A": 0})


def test_users_own_folder(write: Write, tmp_path: Path) -> None:
    write({"shared.glsl": "float shared_one;\n", "both.glsl": "float ours;\n", "c.glsl": '#include "both.glsl"\n'})
    own = tmp_path / "own"
    (own / "deep").mkdir(parents=True)
    (own / "my.frag").write_text('#include "shared.glsl"\n#include "both.glsl"\n#include "deep/d.glsl"\n')
    (own / "both.glsl").write_text("float theirs;\n")
    (own / "deep" / "d.glsl").write_text('#include "both.glsl"\n#include "c.glsl"\n')
    text = assemble(own / "my.frag").text
    # What lies in the user's folder comes first for the user's files, and never for the package's.
    assert text.count("theirs") == text.count("ours") == text.count("shared_one") == 1


def test_source_files(write: Write) -> None:
    folder = write({"a.vert": '#include "x.glsl"\n#if A\n#endif\n', "b.frag": '#include "x.glsl"\n', "x.glsl": ""})
    assert source_files("a.vert", "b.frag") == [folder / "a.vert", folder / "x.glsl", folder / "b.frag"]


FRAGMENT = '#include "f.glsl"\nout vec4 color;\nvoid main() { color = vec4(f(), f(), 1.0, 1.0); }\n'
VERTEX = "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }\n"


@pytest.mark.parametrize("half", [0, 1])
def test_draws(write: Write, context: Context, half: int) -> None:
    write(
        {
            "a.vert": VERTEX,
            "a.frag": FRAGMENT,
            "f.glsl": "#if HALF\nfloat f() { return 0.2; }\n#else\nfloat f() { return 1.0; }\n#endif\n",
        }
    )
    program = compile_program(context, vertex="a.vert", fragment="a.frag", defines={"HALF": half})
    target = context.gl.simple_framebuffer((2, 2))
    target.use()
    context.gl.vertex_array(program, []).render(vertices=3)
    assert target.read(components=4) == bytes([51 if half else 255] * 2 + [255, 255]) * 4


def test_varyings(write: Write, context: Context) -> None:
    write({"a.vert": "out float square;\nvoid main() { square = float(gl_VertexID * gl_VertexID); }\n"})
    program = compile_sources(context, {"vertex": assemble("a.vert")}, ["square"])
    result = context.gl.buffer(reserve=16)
    context.gl.vertex_array(program, []).transform(result, vertices=4)
    np.testing.assert_array_equal(np.frombuffer(result.read(), np.float32), [0, 1, 4, 9])


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize("mistake", ["float f() { return 1.0 }", "float f() { return nothing; }"])
def test_compile_error_names_the_included_file_and_line(write: Write, mistake: str, backend: str) -> None:
    write(
        {
            "a.vert": VERTEX,
            "a.frag": '// first\n#include "g.glsl"\n' + FRAGMENT,
            "g.glsl": "float g() {\n    return 1.0;\n}\n",
            "f.glsl": '/* a comment\n   of two lines */\n#include "g.glsl"\n#if A\n' + mistake + "\n#endif\n",
        }
    )
    with open_or_skip(backend) as context, pytest.raises(ShaderError, match=r"^shaders/f\.glsl:5: \S.*$"):
        compile_program(context, vertex="a.vert", fragment="a.frag", defines={"A": 1})


def test_compile_error_after_an_include(write: Write, context: Context) -> None:
    files = {"a.vert": '#include "f.glsl"\n\nvoid main() { gl_Position = vec3(f()); }\n'}
    write(files | {"f.glsl": "\n" * 50 + "float f() { return 1.0; }"})
    with pytest.raises(ShaderError, match=r"^shaders/a\.vert:3: "):
        compile_program(context, vertex="a.vert")


def test_link_error_names_the_shaders(write: Write, context: Context) -> None:
    write({"a.vert": VERTEX, "a.frag": "float f();\nout vec4 color;\nvoid main() { color = vec4(f()); }\n"})
    with pytest.raises(ShaderError, match=r"^shaders/a\.vert, shaders/a\.frag: .*") as caught:
        compile_program(context, vertex="a.vert", fragment="a.frag")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "log",
    [
        "0:1(1): warning: `x' used uninitialized\n0:2(5): error: `y' undeclared\n",  # Mesa
        '0(1) : warning C7050: "x" might be used\n0(2) : error C1503: undefined variable "y"\n',  # NVIDIA
        "WARNING: 0:1: 'x' : extension\nERROR: 0:2: 'y' : undeclared identifier\nERROR: 0:1: ...\n",  # Apple
        "Fragment shader failed to compile with the following errors:\nERROR: 0:2: error(#143) Undeclared y\n",  # AMD
    ],
)
def test_logs_of_drivers(log: str) -> None:
    origins = [(Path("/one.frag"), 1), (Path("/two.glsl"), 12)]
    report = f"GLSL Compiler failed\n\nfragment_shader\n===============\n{log}\n"
    sources = {"vertex": ProgramSource("", [], []), "fragment": ProgramSource("", [], origins)}
    assert re.match(r"^/two\.glsl:12: .*y.*$", _explain(report, sources))


INTERRUPTED = """
import os, signal, _moderngl
from viewer.gpu.context import open_context
from viewer.gpu.program import compile_program
make = _moderngl.make_uniform
def interrupt(*arguments):
    os.kill(os.getpid(), signal.SIGINT)
    return make(*arguments)
_moderngl.make_uniform = interrupt
signal.signal(signal.SIGINT, signal.default_int_handler)
with open_context() as context:
    try:
        compile_program(context, vertex="display/fullscreen.vert", fragment="raster/visibility.frag")
    except KeyboardInterrupt:
        print("interrupted")
"""


def test_ctrl_c_while_a_program_is_made_is_no_crash(context: Context) -> None:
    """In a process of its own: moderngl's C code would crash on the exception."""
    process = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True)
    assert (process.returncode, process.stdout) == (0, "interrupted\n"), process.stderr


def test_watched_files_are_read_once_for_all_programs_that_share_them(monkeypatch):
    """A window asks for them after every new program; a scene has dozens, which differ in switches."""
    read = []
    monkeypatch.setattr("viewer.gpu.source._read", lambda file: read.append(file) or file.read_text(encoding="utf-8"))
    counts = []
    for programs in (1, 20):
        read.clear()
        held = Programs(None)
        held._programs = {("raster/surface.vert", "raster/pbr.frag", (("LIGHT_COUNT", k),)): None
                          for k in range(programs)}
        files = held.files()
        counts.append(len(read))
    assert counts[0] == counts[1] and {"surface.vert", "pbr.frag", "ggx.glsl"} <= {file.name for file in files}
