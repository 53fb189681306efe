"""The scripts of examples/ run, and do what they say."""

from __future__ import annotations

import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from command_line import SCENES

import viewer

pytest_plugins = ["pytester"]

EXAMPLES = Path(__file__).parents[1] / "examples"


def run(script: str, out: Path, **sizes: object) -> viewer.Image:
    """The picture that the script makes, in this process, where it is smaller than by default."""
    runpy.run_path(str(EXAMPLES / script))["main"](str(out), **sizes)
    return viewer.Image.open(out)


def test_render_model(tmp_path, capsys):
    picture = run("render_model.py", tmp_path / "model.png", model=SCENES / "spheres.glb", size=(64, 36))
    assert picture.size == (64, 36) and picture.srgb[..., :3].std() > 10
    assert "triangles, 16 materials" in capsys.readouterr().out


def test_render_model_tells_of_a_missing_file_in_one_line(tmp_path):
    done = subprocess.run([sys.executable, EXAMPLES / "render_model.py", tmp_path / "out.png", "missing.glb"],
                          capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr == "missing.glb: no such file\n"


def test_material_grid(tmp_path):
    picture = run("material_grid.py", tmp_path / "grid.png", size=(140, 60))
    cells = picture.over(0)[3:57, 7:133].reshape(3, 18, 7, 18, 3)
    assert picture.srgb[0, 0, 3] == 0 and (cells[:, 9, :, 9].min(axis=-1) > 0.05).all()  # a sphere in each cell
    metals = cells[0].max(axis=(0, 2))[:, 2]
    assert (np.diff(metals) < 0.02).all() and metals[-1] < 0.7 * metals[0]  # the rougher, the duller the highlight
    assert (cells[2].mean(axis=(0, 2))[:, 2] > cells[0].mean(axis=(0, 2))[:, 2]).all()  # dielectrics are paler


def test_poses(tmp_path, capsys):
    picture = run("poses.py", tmp_path / "poses.png", count=3, size=(32, 40))
    first, *others = np.split(picture.srgb.astype(int), 3, axis=1)
    assert all(np.abs(other - first).max() > 50 for other in others)
    assert capsys.readouterr().out.startswith("bow: 2 s, rotation of 3 nodes; 3 poses are in ")


def test_raster_against_paths(tmp_path, capsys):
    picture = run("raster_against_paths.py", tmp_path / "beside.png", size=(32, 24), spp=16)
    assert picture.size == (96, 24)
    plain, shadowed, floor = (float(line.split()[-1]) for line in capsys.readouterr().out.splitlines())
    assert 0 < floor < shadowed < plain


def test_brdf_lobe_from_the_command_line(tmp_path):
    done = subprocess.run([sys.executable, EXAMPLES / "brdf_lobe.py", tmp_path / "lobe.png"], capture_output=True,
                          text=True, check=True)
    peaks = [float(line.split()[-2]) for line in done.stdout.splitlines()]
    assert len(peaks) == 3 and 50 < peaks[0] < peaks[1] < peaks[2]
    assert viewer.Image.open(tmp_path / "lobe.png").size == (1440, 240)


def test_a_shader_of_ones_own_and_its_golden_image(pytester):
    for name in ("toon.glsl", "test_toon.py"):
        shutil.copy(EXAMPLES / name, pytester.path)
    shutil.copytree(EXAMPLES / "golden", pytester.path / "golden")
    pytester.runpytest().assert_outcomes(passed=2)
    shader = pytester.path / "toon.glsl"
    shader.write_text(shader.read_text().replace("0.5 * pow5", "0.25 * pow5"))
    pytester.runpytest().assert_outcomes(passed=1, failed=1)
