"""The command line's promises: exit statuses, one line for what goes wrong, whole files or none."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from command_line import SCENES, names
from needs import CORPUS, needs

from viewer import cli
from viewer.errors import ContextError
from viewer.image.image import Image
from viewer.scene import load as load_module

MODEL = SCENES / "unlit.glb"
SMALL = ("--size", "24")
PROGRAM = (sys.executable, "-m", "viewer")


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "exr"])
def test_a_picture_in_every_format(run, folder, suffix):
    outcome = run("render", MODEL, "-o", f"a.{suffix}", "--size", "40x24")
    assert (outcome.status, outcome.out, outcome.err) == (0, "", "")
    image = Image.open(f"a.{suffix}")
    assert image.size == (40, 24) and image.srgb[..., :3].std() > 10
    assert names(folder) == [f"a.{suffix}"]


def test_an_older_picture_is_replaced_whole(run, folder):
    (folder / "a.png").write_bytes(bytes(100_000))
    assert run("render", MODEL, "-o", "a.png", *SMALL).status == 0
    assert Image.open("a.png").size == (24, 24) and (folder / "a.png").stat().st_size < 10_000


def test_a_background_colour_comes_out_exactly(run, folder):
    for tonemap in ("aces", "none"):
        run("render", MODEL, "-o", "a.png", *SMALL, "--background", "#336699", "--tonemap", tonemap, "--exposure", "-2")
        assert Image.open("a.png").srgb[0, 0].tolist() == [51, 102, 153, 255]
    run("render", MODEL, "-o", "a.exr", *SMALL, "--background", "#336699", "--exposure", "-2")
    linear = ((np.array([51, 102, 153]) / 255 + 0.055) / 1.055) ** 2.4
    assert Image.open("a.exr").linear[0, 0] == pytest.approx([*linear, 1], abs=1e-6)
    run("render", MODEL, "-o", "a.png", *SMALL, "--background", "none")
    assert Image.open("a.png").srgb[0, 0, 3] == 0


def test_options_change_what_they_are_named_for(run, folder):
    """Each picture differs from the plain one, which comes out the same twice."""
    plain = ["render", SCENES / "lights.glb", *SMALL]
    changes = [["--mode", "phong"], ["--env", "sky"], ["--env-rotation", "-90"], ["--env-intensity", "2"],
               ["--background", "none"], ["--exposure", "-1.5"], ["--tonemap", "none"], ["--light", "-30,45,9"],
               ["--set", "specular-aa=off", "--set", "lobes=specular"], ["--orbit", "-30,15"], ["--orbit", "30,15,20"],
               ["--eye", "-4,2,9"], ["--eye", "4,2,9", "--target", "-1,0,0"], ["--target", "1,0,0"], ["--fov", "20"],
               ["--camera", "0"]]
    for number, change in enumerate([[], [], *changes]):
        assert run(*plain, *change, "-o", f"{number}.png").status == 0
    first, again, *others = (Image.open(f"{number}.png").srgb for number in range(len(changes) + 2))
    assert np.array_equal(first, again)
    same = [change for change, other in zip(changes, others, strict=True) if np.array_equal(first, other)]
    assert same == []


@pytest.mark.parametrize("arguments, words", [
    (["render", "a.glb"], "Missing option '-o'"),
    (["render", "-o", "a.png"], "Missing argument 'MODEL...'"),
    (["nope"], "No such command 'nope'"),
    (["render", "a.glb", "-o", "a.bmp"], "the name of a picture must end in one of .png"),
    (["render", "a.glb", "-o", "-"], "the name of a picture must end in one of .png"),
    (["render", "a.glb", "b.glb", "-o", "a.png"], "several models need a folder, a.png/, or a pattern with {name}"),
    (["render", "x/a.glb", "y/b.glb", "-o", "out/a.{name}", "--error-map", "e.png"], "must end in one of .png"),
    (["render", "a.glb", "-o", "a.png", "--size", "0x5"], "'0x5' is not WxH"),
    (["render", "a.glb", "-o", "a.png", "--size", "00"], "'00' is not WxH, such as 1280x720, or one number"),
    (["render", "a.glb", "-o", "a.png", "--size", "99999999"], "'99999999' has a side beyond 999999 pixels"),
    (["render", "a.glb", "-o", "a.png", "--fov", "180"], "180 is not from 0.01 to 179"),
    (["render", "a.glb", "-o", "a.png", "--exposure", "nan"], "'nan' is not a number"),
    (["render", "a.glb", "-o", "a.png", "--orbit", "1"], "'1' is not AZ,EL[,DIST]"),
    (["render", "a.glb", "-o", "a.png", "--orbit", "1,2,0"], "the distance 0 is not positive"),
    (["render", "a.glb", "-o", "a.png", "--orbit", "1,2", "--camera", "0"], "--orbit and --camera cannot be"),
    (["view", "a.glb", "--target", "1,2,3", "--camera", "0"], "--target and --camera cannot be"),
    (["render", "a.glb", "-o", "a.png", "--eye", "1,2,3", "--target", "1,2,3"], "are the same point"),
    (["render", "a.glb", "-o", "a.png", "--light", "1,2,-3"], "-3 lux is negative"),
    (["render", "a.glb", "-o", "a.png", "--background", "red"], "'red' is not env, none or #rrggbb"),
    (["render", "a.glb", "-o", "a.png", "--set", "ndf=phong"], "ndf must be one of ggx, beckmann, blinn-phong"),
    (["render", "a.glb", "-o", "a.png", "--spp", "4"], "spp has no effect in mode pbr, only in mode path"),
    (["render", "a.glb", "-o", "a.png", "--set", "bounces=4"], "bounces has no effect in mode pbr"),
    (["render", "a.glb", "-o", "a.png", "--mode", "path", "--spp", "0"], "0 is not from 1 to 65536"),
    (["render", "a.glb", "-o", "a.png", "--spp", "2.5"], "'2.5' is not a whole number"),
    (["view", "a.glb", "--camera", "-1"], "-1 is not from 0 to"),
    (["render", "a.glb", "-o", "a.png", "--mode", "path", "--error", "0"], "0 is not from 1e-05 to 1"),
    (["render", "a.glb", "-o", "a.png", "--ground", "shadow", "--time-budget", "1"],
     "ground=shadow cannot be used with a time budget"),
    (["render", "a.glb", "-o", "a.png", "--ground", "shadow", "--tell-error=1"], "does not know the shadow of"),
    (["render", "a.glb", "-o", "a.png", "--set", "grid=on", "--tell-error=1"], "leave out grid=on"),
    (["render", "a.glb", "-o", "a.png", "--set", "grid=on", "--error", "0.1"], "grid has no effect on how a method"),
    (["report", "a.glb", "-o", "report/", "--set", "show=normal"], "a report is for shaded pictures without a grid"),
    (["render", "a.glb", "-o", "a.exr", "--aov", "depth,samples"],
     "the layer samples: only mode path has samples, not mode pbr"),
    (["render", "a.glb", "-o", "a.exr", "--aov", "depth", "--turntable", "4"], "--turntable with -o a.exr: a film"),
    (["render", "a.glb", "-o", "a.exr", "--aov", "motion", "--turntable", "4", "--view", "front,top"],
     "--turntable with the layer motion has one --view"),
    (["render", "a.glb", "-o", "a.png", "--mode", "path", "--aov", "depth"],
     "--aov with -o a.png: only .exr and .npz can store"),
    (["render", "a.glb", "-o", "a.exr", "--mode", "path", "--aov", "depth,z"],
     "there is no layer 'z'; choose from albedo, normal"),
    (["info", "a.glb", "--set", "colour=red"], "there is no setting 'colour'; choose from ndf, masking"),
    (["render", str(MODEL), "-o", "a.png", "--size", "40000x40000"], "a picture of 40000x40000: this OpenGL draws"),
])
def test_wrong_usage_is_status_2_and_one_line(run, folder, arguments, words):
    outcome = run(*arguments)
    assert outcome.status == 2 and words in outcome.error
    assert names(folder) == []


@pytest.mark.parametrize("arguments, error", [
    (["render", "none.glb", "-o", "a.png"], "none.glb: no such file"),
    (["render", "folder", "-o", "a.png"], "folder: there is no model in this folder: no file whose name ends in .3mf, "
     ".bcc, .curves, .dae, .glb, .gltf, .hair, .obj, .off, .ply, .step, .stl, .stp, .usd, .usda, .usdc, .usdz, .vdb, "
     ".vol, .xyz"),
    (["render", "*.glb", "-o", "a.png"], "*.glb: no file matches this pattern"),
    (["render", str(MODEL), "-o", f"{MODEL}/a.png"], f"{MODEL}: is a file, not a folder"),
    (["render", "none.glb", "-o", "none/none/"], "none.glb: no such file"),
    (["render", str(MODEL), "-o", "a.png", "--stats", "none/s.json"], "none/s.json: the folder none does not exist"),
    (["render", str(MODEL), "-o", "a.png", "--stats", "folder"], "folder: is a folder; a file name is needed"),
    (["render", str(MODEL), "-o", "a.png", "--env", "none.hdr"], "none.hdr: no such file"),
    (["render", str(MODEL), "-o", "a.png", "--camera", "3"],
     f"{MODEL}: cameras: --camera 3: the file has 1, counted from 0"),
    (["info", "none.glb"], "none.glb: no such file"),
    (["info", str(MODEL), "--json", "none/a.json"], "none/a.json: the folder none does not exist"),
    (["diff", "none.png", "none.png"], "none.png: no such file"),
    (["view", "none.glb"], "none.glb: no such file"),
])
def test_bad_input_is_status_1_and_one_line(run, folder, arguments, error):
    (folder / "folder").mkdir()
    outcome = run(*arguments)
    assert (outcome.status, outcome.error.replace(f"{folder}/", "")) == (1, error)
    assert names(folder) == ["folder"]


def test_without_opengl_the_status_is_3_and_every_attempt_is_told(run, folder, monkeypatch):
    def fail(name, device=None):
        raise ContextError(f"{name}: not here")

    monkeypatch.setattr("viewer.gpu.context.create_context", fail)
    outcome = run("render", MODEL, "-o", "a.png", *SMALL)
    lines = outcome.err.splitlines()
    assert outcome.status == 3 and lines[0] == "pbr-viewer: no OpenGL context:"
    assert "osmesa: not here" in lines and lines[-1].startswith("fix: ") and names(folder) == []


def test_what_a_terminal_would_obey_is_escaped(run, folder):
    name = "red\x1b[31m\nnext.glb"
    outcome = run("render", name, "-o", "a.png")
    assert outcome.error == "red\\x1b[31m next.glb: no such file"


@needs("linux")  # names of any bytes
def test_a_name_that_is_no_utf8(run, folder):
    name = os.fsdecode(b"caf\xe9 one.glb")
    shutil.copy(SCENES / "spheres.glb", name)
    assert run("render", name, "-o", os.fsdecode(b"\xff.exr"), *SMALL).status == 0
    assert Image.open(os.fsdecode(b"\xff.exr")).size == (24, 24)
    outcome = run("info", name)
    assert outcome.status == 0 and outcome.out.startswith("name: caf")


def test_info_diff_doctor_and_cache_answer(run, folder, monkeypatch):
    assert "ndf=ggx|beckmann|blinn-phong" in run("info", "--settings").out
    settings = json.loads(run("info", "--settings", "--json", "-").out)
    assert {"name", "choices", "default", "meaning"} == set(settings[0])
    assert "glb" in run("info").out
    facts = json.loads(run("info", MODEL, "--json", "-").out)
    assert facts["triangles"] > 0 and facts["plan"]["left_out"]
    assert f"triangles: {facts['triangles']}" in run("info", MODEL).out
    run("render", MODEL, "-o", "a.png", *SMALL)
    run("render", MODEL, "-o", "b.png", *SMALL, "--exposure", "1")
    outcome = run("diff", "a.png", "b.png", "--json", "d.json", "-o", "d.png")
    result = json.loads((folder / "d.json").read_text())
    assert outcome.status == 0 and result["flip"] > 0.01 and result["max"] <= 1 and Image.open("d.png").size == (24, 24)
    shown = run("diff", "a.png", "a.png").out
    assert "flip: 0\n" in shown and "compared: displayed colours (sRGB" in shown and "kind" not in shown
    monkeypatch.setattr("viewer.jobs.doctor.probe", lambda *_: {"problem": "no display"})
    outcome = run("doctor", "--json", "-")
    assert outcome.status == 3 and not any(finding["works"] for finding in json.loads(outcome.out))
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(folder / "cache"))
    assert run("cache").out.endswith("/cache: 0.0 MB\n")
    assert "freed" in run("cache", "--clear").out
    monkeypatch.setenv("PBR_VIEWER_CACHE", "off")
    assert run("cache").out == "the cache is switched off\n"
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(MODEL))
    outcome = run("cache")
    assert outcome.status == 1 and outcome.err.startswith(f"pbr-viewer: {MODEL}: is no folder, so nothing is kept")


@pytest.mark.parametrize("command", ["view", "render", "info", "diff", "doctor", "cache", ""])
def test_help_says_what_every_option_is_for(run, command):
    outcome = run(*command.split(), "--help")
    assert outcome.status == 0 and outcome.err == "" and outcome.out.startswith("Usage: pbr-viewer")
    parameters = cli.cli.commands[command].params if command else []
    assert [p.name for p in parameters if p.param_type_name == "option" and not p.help] == []


def test_without_a_command_the_help_is_shown(run):
    outcome = run()
    assert outcome.status == 2 and outcome.err.startswith("Usage: ")


def test_out_of_memory_is_one_line(run, folder, monkeypatch):
    def fail(*_):
        raise MemoryError

    monkeypatch.setattr(load_module, "read_file", fail)
    outcome = run("render", "a.glb", "-o", "a.png")
    assert (outcome.status, outcome.error) == (1, "a.glb: out of memory")
    assert run("info", "a.glb").error == "out of memory"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_being_stopped_leaves_nothing_and_the_old_handlers(run, folder, monkeypatch, number):
    before = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]

    def stopped(self, path):
        Path(path).with_name(".before").touch()
        os.kill(os.getpid(), number)
        time.sleep(5)

    monkeypatch.setattr("viewer.image.image.write_exr", lambda *_: stopped(None, folder / "x"))
    outcome = run("render", MODEL, "-o", "a.exr", *SMALL)
    words = "interrupted" if number == signal.SIGINT else "terminated"
    assert (outcome.status, outcome.error) == (128 + number, words)
    assert names(folder) == [".before"]
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)] == before


@needs("linux")  # /dev/full
def test_a_full_disk_is_one_line(run, folder):
    assert run("info", MODEL, "--json", "/dev/full").error == "/dev/full: cannot be written: No space left on device"
    with open("/dev/full", "w") as full:
        process = subprocess.run([*PROGRAM, "info"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert (process.returncode, process.stderr) == (1, "pbr-viewer: standard output: No space left on device\n")


INTERRUPTED = """
import os, signal, sys, threading, time
from viewer.__main__ import main
delay = float(sys.argv.pop())
def interrupt():
    while signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        time.sleep(0.001)
    time.sleep(delay)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
main()
"""


def test_a_process_interrupted_at_any_time_leaves_no_file(folder):
    """From the moment on that `main` answers; an interrupt while Python starts is Python's to answer."""
    for delay in (0, 0.1, 0.2, 0.5):
        process = subprocess.run([sys.executable, "-c", INTERRUPTED, "render", SCENES / "spheres.glb", "-o", "a.png",
                                  "--size", "2000", str(delay)], capture_output=True, text=True)
        if process.returncode == 0:  # it was faster
            (folder / "a.png").unlink()
        else:
            assert (process.returncode, process.stderr) == (130, "pbr-viewer: interrupted\n")
        assert names(folder) == []


@needs("corpus")
def test_some_of_every_kind_of_malformed_file(run, folder):
    """One in twelve of the corpus; the status follows what the index expects."""
    items = json.loads((CORPUS / "INDEX.json").read_text())["malformed"]
    by_kind: dict[tuple[str, str], list[Path]] = {}
    for item in items:
        path = CORPUS / item["path"]
        by_kind.setdefault((path.suffix, item["expect"]), []).append(path)
    for (suffix, expected), paths in sorted(by_kind.items()):
        for path in paths[::12]:
            arguments = [SCENES / "unlit.glb", "--env", path, "--no-cache"] if suffix in (".hdr", ".exr") else [path]
            outcome = run("render", *arguments, "-o", "a.png", *SMALL, "-q")
            allowed = {"error": (1,), "must load": (0,)}.get(expected, (0, 1))
            assert outcome.status in allowed, f"{path}: {outcome}"
            if outcome.status:
                assert path.name in outcome.error and names(folder) == []
            else:
                assert outcome.err == "" and names(folder) == ["a.png"]
                (folder / "a.png").unlink()
