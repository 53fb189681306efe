"""The fixtures `golden` and `gl`, as another project's tests see them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

# pytester unloads what its runs imported, and these would not stand being loaded twice.
import OpenImageIO  # noqa: F401
import pytest

import viewer.gpu.context  # noqa: F401
from viewer.image.image import Image
from viewer.measure.compare.golden import Limits, judge

pytest_plugins = ["pytester"]

PICTURE = """
    import numpy as np
    def picture(value=100, spot=None):
        pixels = np.full((16, 24, 3), value, np.uint8)
        if spot is not None:
            pixels[4:12, 4:12] = spot
        return pixels
"""


def write_test(pytester: pytest.Pytester, body: str) -> None:
    pytester.makepyfile(drawing=PICTURE)
    pytester.makepyfile(test_it=f"from drawing import *\n{body}")


def store(pytester: pytest.Pytester, body: str = "def test_a(golden): golden(picture())") -> None:
    write_test(pytester, body)
    pytester.runpytest("--golden-update").assert_outcomes(passed=1)


def page(pytester: pytest.Pytester) -> Path:
    return pytester.path / "golden-failures" / "index.html"


def test_the_stored_picture_passes_and_so_does_rounding(pytester):
    store(pytester)
    assert (pytester.path / "golden" / "test_it-test_a.png").exists()
    pytester.runpytest().assert_outcomes(passed=1)
    write_test(pytester, "def test_a(golden): golden(picture(102))")
    pytester.runpytest().assert_outcomes(passed=1)
    assert not page(pytester).exists()


def test_a_change_fails_and_is_shown_until_it_is_mended(pytester):
    store(pytester)
    write_test(pytester, "def test_a(golden): golden(picture(spot=180))")
    result = pytester.runpytest()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*golden*test_it-test_a.png: FLIP 0.* > 0.005*",
                                 "*pytest 'test_it.py::test_a' --golden-update*", "*index.html*"])
    text = page(pytester).read_text()
    assert text.count("data:image/png;base64,") == 3 and "test_it.py::test_a" in text and "FLIP 0." in text
    assert not re.search(r"""(src|href)=["'](?!data:)""", text)
    folder = page(pytester).parent / "test_it.py-test_a-1"
    assert sorted(path.name for path in folder.glob("*.png")) == ["actual.png", "difference.png", "expected.png"]
    pytester.runpytest("--golden-update").assert_outcomes(passed=1)
    pytester.runpytest().assert_outcomes(passed=1)
    assert not page(pytester).exists() and not folder.exists()


def test_what_runs_no_test_leaves_the_page_alone(pytester):
    write_test(pytester, "def test_a(golden): golden(picture())")
    assert pytester.runpytest().ret == pytest.ExitCode.TESTS_FAILED
    kept = sorted(page(pytester).parent.rglob("*.*"))
    for option in ("--fixtures", "--fixtures-per-test", "--collect-only", "--setup-plan", "--setup-only", "--markers",
                   "--help", "--version"):
        result = pytester.runpytest(option)
        assert sorted(page(pytester).parent.rglob("*.*")) == kept != [], option
        assert "golden images:" not in result.stdout.str(), option
    write_test(pytester, "import no_such_module")
    assert pytester.runpytest().ret == pytest.ExitCode.INTERRUPTED
    assert sorted(page(pytester).parent.rglob("*.*")) == kept
    write_test(pytester, "def test_a(): pass")
    assert pytester.runpytest().ret == pytest.ExitCode.OK
    assert not page(pytester).exists()


def test_the_page_holds_every_failure_of_the_session(pytester):
    write_test(pytester, "def test_a(golden): golden(picture())\ndef test_b(golden): golden(picture(), 'b<i>')")
    pytester.runpytest("--golden-report", "pages").assert_outcomes(failed=2)
    text = (pytester.path / "pages" / "index.html").read_text()
    assert "2 golden images failed" in text and "b&lt;i&gt;.png" in text and "there is no golden image yet" in text


def test_the_report_folder_keeps_what_is_not_its_own(pytester):
    write_test(pytester, "def test_a(golden): golden(picture())")
    (pytester.path / "golden-failures" / "mine").mkdir(parents=True)
    (pytester.path / "golden-failures" / "mine" / "notes.txt").write_text("keep")
    for _ in range(2):
        pytester.runpytest().assert_outcomes(failed=1)
    assert (pytester.path / "golden-failures" / "mine" / "notes.txt").read_text() == "keep"


def test_a_missing_golden_says_how_to_make_it(pytester):
    write_test(pytester, "def test_a(golden): golden(picture())")
    result = pytester.runpytest()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*there is no golden image yet*", "*pytest 'test_it.py::test_a' --golden-update*"])
    assert not (pytester.path / "golden").exists()


def test_parameters_calls_and_names_give_each_picture_its_own_file(pytester):
    write_test(pytester, """
        import pytest
        @pytest.mark.parametrize("mode", ["a b", "c/d"])
        def test_a(golden, mode):
            golden(picture()); golden(picture(3)); golden(picture(4), f"{mode[0]}1.5"); golden(picture(5), "x.exr")
        """.replace("\n        ", "\n"))
    pytester.runpytest("--golden-update").assert_outcomes(passed=2)
    names = sorted(path.name for path in (pytester.path / "golden").iterdir())
    assert names == ["a1.5.png", "c1.5.png", "test_it-test_a-a-b-2.png", "test_it-test_a-a-b.png",
                     "test_it-test_a-c-d-2.png", "test_it-test_a-c-d.png", "x.exr"]
    pytester.runpytest().assert_outcomes(passed=2)


@pytest.mark.parametrize("option", [(), ("--golden-update",)])
def test_nan_fails_and_is_never_stored(pytester, option):
    write_test(pytester, """
def test_a(golden):
    pixels = np.zeros((16, 24, 4), np.float32)
    pixels[3, 5:7] = np.nan
    golden(pixels, "a.exr")
""")
    result = pytester.runpytest(*option)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*2 pixels NaN or infinite, the first at x=5, y=3*"])
    assert not (pytester.path / "golden").exists()


def test_another_size_fails_in_words(pytester):
    store(pytester)
    write_test(pytester, "def test_a(golden): golden(picture()[:8])")
    result = pytester.runpytest()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*the picture: is 24x8, the golden image is 24x16*"])


WRONG = {
    "golden('name', picture())": "the picture must be the first argument",
    "golden(None)": "the picture is of type NoneType, not an Image or an array",
    "golden(picture()[0])": "the picture is an array (24, 3), not (H, W, 3 or 4)",
    "golden(picture().astype(int))": "not uint8 (as displayed) or floating (linear)",
    "golden(picture(), 5)": "name is of type int",
    "golden(picture(), '../x')": "'../x' is not a name for a golden image beside the test",
    "golden(picture(), flop=1)": "there is no limit 'flop', but flip, maximum, rounding",
    "golden(picture(), flip='1')": "flip='1': it is a number from 0 on",
}


def test_wrong_arguments_fail_in_words_at_the_test_itself(pytester):
    tests = [f"def test_{k}(golden): {call}" for k, call in enumerate(WRONG)]
    write_test(pytester, "\n".join(tests))
    result = pytester.runpytest("--tb=short")
    result.assert_outcomes(failed=len(WRONG))
    told = [line for line in result.outlines if line.startswith("E  ")]
    assert len(told) == len(WRONG) and all(words in line for words, line in zip(WRONG.values(), told, strict=True))
    assert not any("pytest_plugin.py" in line for line in result.outlines)


def test_a_gl_error_left_pending_fails_the_test(pytester):
    pytester.makepyfile("""
        def test_bad(gl):
            gl.ctx.blend_func = 1, 99999
        def test_good(gl):
            assert gl.ctx.error == "GL_NO_ERROR"
    """)
    result = pytester.runpytest()
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(["*an OpenGL error is pending: GL_INVALID_ENUM*"])


def test_each_test_gets_a_context_of_its_own(pytester):
    pytester.makepyfile("""
        import numpy as np
        import pytest
        seen = []
        @pytest.mark.parametrize("n", [1, 2])
        def test_clean(gl, n):
            assert gl.ctx not in seen and not gl.ctx.wireframe
            gl.ctx.wireframe = True
            seen.append(gl.ctx)
        def test_nan(gl):
            gl.check(np.full((2, 2, 4), np.nan, np.float32))
    """)
    result = pytester.runpytest("--gl-backend", "auto")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(["*4 pixels NaN or infinite, the first at x=0, y=0*"])


def test_no_context_fails_in_words(pytester, monkeypatch):
    from viewer.errors import ContextError

    def refuse(backend):
        raise ContextError(f"no OpenGL context: {backend} was tried")

    monkeypatch.setattr("viewer.gpu.context.open_context", refuse)
    pytester.makepyfile("def test_a(gl): pass")
    result = pytester.runpytest("--gl-backend", "osmesa")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*no OpenGL context: osmesa was tried*"])
    assert "Traceback" not in result.stdout.str()


def test_it_works_without_xdist_and_in_its_workers(pytester):
    store(pytester)
    write_test(pytester, "def test_a(golden): golden(picture(spot=180))")
    assert pytester.runpytest("-p", "no:xdist").ret == pytest.ExitCode.TESTS_FAILED
    assert page(pytester).exists()
    pytester.makeconftest("def pytest_configure(config): config.workerinput = {}")
    page(pytester).unlink()
    pytester.runpytest("-p", "no:xdist").assert_outcomes(failed=1)
    assert not page(pytester).exists()  # the page is its controller's to write


def test_loading_the_plugin_costs_nothing():
    heavy = "{'numpy', 'moderngl', 'PIL', 'OpenImageIO', 'trimesh', 'flip_evaluator', 'glfw'}"
    code = f"import sys, pytest; before = set(sys.modules); import viewer.pytest_plugin; " \
           f"print(({heavy} & set(sys.modules)) - before)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "set()"


def test_the_example_of_the_guide_runs(pytester):
    guide = Path(__file__).parent.parent / "docs" / "golden-tests.md"
    pytester.makepyfile(test_gradient=re.search(r"```python\n(.*?)```", guide.read_text(), re.DOTALL)[1])
    pytester.runpytest().assert_outcomes(failed=1)
    pytester.runpytest("--golden-update").assert_outcomes(passed=1)
    pytester.runpytest().assert_outcomes(passed=1)
    stored = Image.open(pytester.path / "golden" / "test_gradient-test_gradient.png")
    assert stored.srgb[0, 0].tolist() == [2, 253, 64, 255] and stored.srgb[-1, -1].tolist() == [253, 2, 64, 255]


def test_linear_goldens_forgive_in_proportion(tmp_path):
    bright = np.full((8, 8, 3), [1000.0, 0.01, 0.0], np.float32)
    Image.from_linear(bright).save(tmp_path / "a.exr")
    assert judge(Image.from_linear(bright * 1.007), tmp_path / "a.exr", Limits(), "t") is None
    failure = judge(Image.from_linear(bright * 1.02), tmp_path / "a.exr", Limits(), "t")
    assert failure is not None and failure.problem.endswith("maximum 20.000 > 0.5")


def test_one_wrong_pixel_is_caught_by_the_maximum(tmp_path):
    pixels = np.zeros((64, 64, 3), np.uint8)
    Image.from_srgb(pixels).save(tmp_path / "a.png")
    pixels[7, 9] = 200
    assert judge(Image.from_srgb(pixels), tmp_path / "a.png", Limits(), "t").problem == "maximum 0.784 > 0.5"
    assert judge(Image.from_srgb(pixels), tmp_path / "a.png", Limits(maximum=None), "t") is None


def test_an_error_in_a_shader_is_shown_beside_the_call_alone(pytester):
    pytester.makefile(".glsl", mine="float f(float x) { return flor(x); }")
    pytester.makepyfile("def test_a(gl): gl.call('mine.glsl', 'f', x=1)")
    shown = pytester.runpytest().stdout
    shown.fnmatch_lines(["E * viewer.errors.ShaderError: *mine.glsl:1: no function with name 'flor'"])
    shown.no_fnmatch_line("*compile_sources*")
