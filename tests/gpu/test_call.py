"""call_glsl: GLSL functions on arrays."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from viewer import call_glsl
from viewer.errors import ShaderError, UsageError
from viewer.gpu import call
from viewer.gpu.context import current_context, open_context

OWN = """#version 330 core
#include "bsdf/constants.glsl"
struct Inner { int a; uvec2 b; };
struct All { vec3 v; bool ok; Inner inner; mat2x3 m; };
All both(Inner inner, vec3 v, mat2x3 m, bool ok, out float q, inout int z) {
    q = v.x;
    z = z - 1;
    return All(v * 2.0, !ok, inner, m);
}
void only_out(float x, out vec2 pair) { pair = vec2(x, PI); }
float square(float x) { return x * x; }
vec3 square(vec3 x) { return x * x; }
float pick(float chosen, vec4 a, vec4 b, vec4 idle) { return chosen + a.w + b.x; }
float texel(sampler2D picture, vec2 uv) { return textureLod(picture, uv, 0.0).r; }
vec3 rotate(mat3 m, vec3 v) { return m * v; }
uint bits(float x) { return floatBitsToUint(x); }
float five() { return 5.0; }
#if FLAG
float flagged(float x) { return -x; }
#else
float flagged(float x) { return x; }
#endif
uniform sampler2D map;
in vec2 uv;
out vec4 color;
void main() {
    if (dFdx(uv.x) > 0.0) { discard; }
    color = texture(map, gl_FragCoord.xy);
}
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A user's whole fragment shader, functions and main."""
    (tmp_path / "own.frag").write_text(OWN)
    return tmp_path / "own.frag"


FLAG = {"FLAG": 0}


def test_packaged_function_on_arrays():
    alpha, NoH = np.array([0.1, 0.5, 1.0]), np.linspace(0, 1, 5)[:, None]
    found = call_glsl("bsdf/ggx.glsl", "d_ggx", NoH=NoH, s2=1 - NoH**2, alpha=alpha)
    expected = alpha**2 / (np.pi * (1 + NoH**2 * (alpha**2 - 1)) ** 2)
    assert found.shape == (5, 3) and found.dtype == np.float32
    assert np.abs(found / expected - 1).max() < 1e-5


def test_structs_matrices_and_out_parameters(own):
    inner = {"a": -(2**31), "b": np.array([[1, 2**32 - 1], [3, 4], [5, 6]], np.uint32)}
    m, v = np.arange(6.0).reshape(3, 2), np.arange(9).reshape(3, 3)
    z = np.array([1, 2, 2**31 - 1])
    found = call_glsl(own, "both", inner=inner, v=v, m=m, ok=[True, False, True], z=z, defines=FLAG)
    assert set(found) == {"return", "q", "z"}
    result = found["return"]
    assert (result["v"] == 2 * v).all() and result["ok"].tolist() == [False, True, False]
    assert (result["inner"]["a"] == -(2**31)).all() and (result["inner"]["b"] == inner["b"]).all()
    assert (result["m"] == m).all() and result["m"].shape == (3, 3, 2)
    assert (found["q"] == v[:, 0]).all() and found["z"].tolist() == [0, 1, 2**31 - 2]
    again = call_glsl(own, "both", inner=result["inner"], v=v, m=m, ok=True, z=0, defines=FLAG)
    assert (again["return"]["inner"]["b"] == inner["b"]).all()
    flat = call_glsl(own, "both", inner=np.array([7, 8, 9]), v=0, m=m, ok=True, z=0, defines=FLAG)
    assert flat["return"]["inner"]["b"].tolist() == [8, 9] and flat["q"].shape == ()


def test_void_function_and_none_that_takes_anything(own):
    assert np.allclose(call_glsl(own, "only_out", x=[1, 2], defines=FLAG)["pair"], [[1, np.pi], [2, np.pi]])
    assert call_glsl(own, "five", defines=FLAG) == 5


def test_matrices_are_by_rows(own):
    m, v = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]), np.random.default_rng(1).normal(size=(10, 3))
    assert np.allclose(call_glsl(own, "rotate", m=m, v=v, defines=FLAG), v @ m.T)


def test_floats_keep_every_bit(own):
    x = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e-45, 3.4e38, 1e300], np.float64)
    with np.errstate(over="ignore"):
        expected = x.astype(np.float32).view(np.uint32)
    assert (call_glsl(own, "bits", x=x, defines=FLAG) == expected).all()


def test_overload_is_named_by_its_types(own):
    assert call_glsl(own, "square(float)", x=3, defines=FLAG) == 9
    assert call_glsl(own, "square( vec3 )", x=3, defines=FLAG).tolist() == [9, 9, 9]


def test_arguments_that_make_no_difference(own):
    a, b = np.arange(8.0).reshape(2, 4), 10 * np.arange(8.0).reshape(2, 4)
    found = call_glsl(own, "pick", chosen=[1.0, 2.0], a=a, b=b, idle=a, defines=FLAG)
    assert found.tolist() == [1 + 3 + 0, 2 + 7 + 40]
    assert call_glsl(own, "pick", chosen=1.0, a=a[0], b=b[0], idle=b, defines=FLAG).tolist() == [4, 4]


def test_picture(own):
    uv = np.stack([np.linspace(0, 1, 5), np.full(5, 0.5)], axis=-1)
    for picture in (np.array([[0.0, 1.0]]), [[[0.0, 9.0], [1.0, 9.0]]], (np.array([[0.0, 1.0]]), np.array([[7.0]]))):
        found = call_glsl(own, "texel", picture=picture, uv=uv, defines=FLAG)
        assert np.allclose(found, [0, 0, 0.5, 1, 1], atol=2e-3)


def test_switches(own):
    assert [call_glsl(own, "flagged", x=2, defines={"FLAG": on}) for on in (0, 1)] == [2, -2]
    with pytest.raises(ShaderError, match=r"own\.frag:18: no switch FLAG"):
        call_glsl(own, "flagged", x=2)


def test_none_and_more_than_a_chunk(own, monkeypatch):
    assert call_glsl(own, "square(vec3)", x=np.zeros((0, 3)), defines=FLAG).shape == (0, 3)
    monkeypatch.setattr(call, "_CHUNK", 7)
    x = np.arange(50.0)
    assert (call_glsl(own, "square(float)", x=x, defines=FLAG) == x * x).all()


def test_edited_file_is_compiled_anew(tmp_path):
    file = tmp_path / "f.glsl"
    for factor in (2, 3):
        file.write_text(f"float f(float x) {{ return {factor}.0 * x; }}\n")
        assert call_glsl(file, "f", x=1) == factor


def test_version_that_a_file_needs(tmp_path):
    file = tmp_path / "f.glsl"
    for version, expected in ("410 core", 410), ("150", 330), ("300 es", 330):
        file.write_text(f"#version {version}\nint f() {{ return __VERSION__; }}\n")
        assert call_glsl(file, "f") == expected


def test_relative_path(own, monkeypatch):
    monkeypatch.chdir(own.parent)
    assert call_glsl("own.frag", "five", defines=FLAG) == 5


@pytest.mark.parametrize(("function", "arrays", "message"), [
    ("nope", {}, r"own\.frag: there is no function nope that can be called; there are bits, both, five"),
    ("square", {"x": 1}, r"several functions fit; name the types of one, square\(\.\.\.\): square\(float x\); square"),
    ("square(int)", {"x": 1}, r"there is no function square\(int\)"),
    ("pick", {"chosen": 1},
     r"pick was given chosen, but its parameters are pick\(float chosen, vec4 a, vec4 b, vec4 idle\)"),
    ("bits", {"x": "a"}, r"x: float takes numbers"),
    ("square(vec3)", {"x": [1, 2]}, r"x: vec3 takes a number or arrays that end in \(3,\), not the shape \(2,\)"),
    ("pick", {"chosen": [1, 2], "a": np.ones((3, 4)), "b": 0, "idle": 0},
     r"cannot be broadcast together.* chosen \(2,\), a \(3,\)"),
    ("both", {"inner": {"a": 1}, "v": 0, "m": np.zeros((3, 2)), "ok": 1, "z": 0}, r"inner: Inner has the members a, b"),
    ("both", {"inner": [1, 2], "v": 0, "m": np.zeros((3, 2)), "ok": 1, "z": 0}, r"inner: Inner takes a dict, or"),
    ("both", {"inner": [1, 2, 3], "v": 0, "m": np.zeros((3, 2)), "ok": 1, "z": 2**31}, r"z: int takes whole numbers"),
    ("both", {"inner": [1, 2, 3], "v": 0, "m": np.zeros((3, 2)), "ok": 1, "z": 0.5}, r"z: int takes whole numbers"),
    ("texel", {"picture": 1, "uv": 0}, r"picture: sampler2D takes a picture"),
    ("texel", {"picture": (), "uv": 0}, r"picture: sampler2D takes a picture"),
    ("texel", {"picture": (np.zeros((4, 4)), np.zeros((3, 2))), "uv": 0},
     r"picture: the mip level after one of shape \(4, 4, 1\) has \(2, 2, 1\), not \(3, 2, 1\)"),
])
def test_wrong_argument_is_named(own, function, arrays, message):
    with pytest.raises(UsageError, match=message):
        call_glsl(own, function, defines=FLAG, **arrays)


def test_too_many_components(tmp_path):
    file = tmp_path / "many.glsl"
    parameters = ", ".join(f"mat4 m{i}" for i in range(5))
    file.write_text(f"float f({parameters}) {{ return m0[0][0] + m4[3][3]; }}\n")
    matrices = {f"m{i}": np.eye(4) for i in range(5)}
    assert call_glsl(file, "f", **matrices) == 2
    with pytest.raises(UsageError, match="takes 80 components"):
        call_glsl(file, "f", **{name: matrix[None] for name, matrix in matrices.items()})


def test_compile_error_names_file_and_line(tmp_path):
    file = tmp_path / "wrong.glsl"
    file.write_text('#version 330\n#include "part.glsl"\nfloat f(float x) {\n    return part(x) + y;\n}\n')
    (tmp_path / "part.glsl").write_text("float part(float x) { return x; }\n")
    with pytest.raises(ShaderError, match=r"wrong\.glsl:4: .*y"):
        call_glsl(file, "f", x=1)
    (tmp_path / "part.glsl").write_text("\nfloat part(float x) { return z; }\n")
    with pytest.raises(ShaderError, match=r"part\.glsl:2: .*z"):
        call_glsl(file, "f", x=1)
    with pytest.raises(ShaderError, match=r"there is no shader file .*missing\.glsl"):
        call_glsl(tmp_path / "missing.glsl", "f", x=1)


def test_current_context_stays_current_and_drawn_to():
    with open_context() as context:
        target = context.gl.simple_framebuffer((2, 2))
        target.use()
        call_glsl("bsdf/fresnel.glsl", "pow5", x=2)
        assert current_context() is context
        assert call_glsl("bsdf/fresnel.glsl", "pow5", x=2, context=context) == 32
        assert context.gl.fbo is target and context.gl.error == "GL_NO_ERROR"


def test_each_thread_has_its_own_context():
    found = []
    thread = threading.Thread(target=lambda: found.append(call_glsl("bsdf/fresnel.glsl", "pow5", x=3)))
    thread.start()
    thread.join()
    assert found == [243]


def test_fixture_calls_in_its_context(gl):
    assert gl.call("bsdf/fresnel.glsl", "pow5", x=2) == 32
