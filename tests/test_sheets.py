"""Sheets: several views of a model in one picture, and contact sheets of several models."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import SCENES, names
from needs import needs
from PIL import ImageFont

from viewer.base.atomic import temporary_folder
from viewer.errors import UsageError
from viewer.image.fonts import font_for
from viewer.image.image import Image
from viewer.image.sheet import label_height, labelled_sheet, sheet_size

BALLS, UNLIT = SCENES / "spheres.glb", SCENES / "unlit.glb"
SIZE = (40, 24)
QUICK = ("--size", "40x24", "--set", "antialias=none", "-q")
KILLED = """
import os, signal, viewer.__main__
replace = os.replace

def replace_or_die(source, target):
    if str(target).endswith("unlit.png"):
        os.kill(os.getpid(), signal.SIGKILL)
    replace(source, target)

os.replace = replace_or_die
viewer.__main__.main()
"""
"""The command line, in a process that is killed when it has written the second picture but not named it yet."""


def cell(sheet: Image, number: int, columns: int) -> np.ndarray:
    """The picture in a place of a sheet."""
    left, top = 4 + number % columns * 44, 4 + number // columns * (24 + label_height(SIZE) + 4)
    return sheet.srgb[top:top + 24, left:left + 40]


def label(sheet: Image, number: int, columns: int) -> np.ndarray:
    left, top = 4 + number % columns * 44, 28 + number // columns * (24 + label_height(SIZE) + 4)
    return sheet.srgb[top:top + label_height(SIZE), left:left + 40, 0]


def test_pictures_stand_in_their_places_with_readable_labels():
    pictures = [np.full((24, 40, 4), 10 * k, np.uint8) for k in range(5)]
    sheet = labelled_sheet([("top", pictures[0]), ("left", pictures[1]), ("back", None), ("a" * 99, pictures[3]),
                            ("", pictures[4])], 3, SIZE)
    assert sheet.size == sheet_size(5, 3, SIZE) == (4 + 3 * 44, 4 + 2 * (24 + label_height(SIZE) + 4))
    for k in (0, 1, 3, 4):
        np.testing.assert_array_equal(cell(sheet, k, 3), pictures[k])
    assert (cell(sheet, 2, 3) == (225, 225, 225, 255)).all()
    inked = [(label(sheet, k, 3) < 128).sum() for k in range(5)]
    assert min(inked[:4]) > 20 and inked[4] == 0
    assert (sheet.srgb[:, -4:] == (245, 245, 245, 255)).all()  # nothing runs over


def test_a_sheet_without_an_end_is_refused():
    with pytest.raises(UsageError, match="a sheet of 90000 pictures of 320x320 has .* pixels, more than"):
        sheet_size(90_000, 300, (320, 320))


def test_views_all_around_are_those_of_a_turntable(run, folder):
    assert run("render", BALLS, "-o", "sheet.png", "--sheet", "2x2", *QUICK).status == 0
    assert run("render", BALLS, "-o", "turn.apng", "--turntable", "4", "--orbit", "0,15", *QUICK).status == 0
    from PIL import Image as Pillow
    from PIL import ImageSequence

    sheet = Image.open("sheet.png")
    frames = [np.asarray(frame.convert("RGBA")) for frame in ImageSequence.Iterator(Pillow.open("turn.apng"))]
    assert sheet.size == sheet_size(4, 2, SIZE)
    for k in range(4):
        np.testing.assert_array_equal(cell(sheet, k, 2), frames[k])
    assert len({label(sheet, k, 2).tobytes() for k in range(4)}) == 4  # front, right, back, left


def test_the_views_that_are_asked_for_are_those_of_single_pictures(run, folder):
    views = ("--view", "top,left", "--ortho")
    assert run("render", BALLS, "-o", "sheets/", "--sheet", "3x1", *views, *QUICK).status == 0
    assert run("render", BALLS, "-o", "single/", *views, *QUICK).status == 0
    sheet = Image.open("sheets/spheres.png")
    assert sheet.size == sheet_size(2, 3, SIZE)
    for k, view in enumerate(("top", "left")):
        np.testing.assert_array_equal(cell(sheet, k, 2), Image.open(f"single/spheres_{view}.png").srgb)


def test_a_contact_sheet_has_a_place_for_each_model_and_its_failure(run, folder):
    (folder / "broken.glb").write_bytes(b"glTF")
    outcome = run("render", BALLS, "broken.glb", UNLIT, "-o", "out/all.png", "--sheet", "2x9", *QUICK)
    assert outcome.status == 1 and "broken.glb" in outcome.error
    assert names(folder / "out") == ["all.png"]
    sheet = Image.open("out/all.png")
    assert sheet.size == sheet_size(3, 2, SIZE)
    assert (cell(sheet, 1, 2) == (225, 225, 225, 255)).all()
    assert run("render", UNLIT, "-o", "alone.png", *QUICK).status == 0
    np.testing.assert_array_equal(cell(sheet, 2, 2), Image.open("alone.png").srgb)


def test_what_a_contact_sheet_that_was_killed_has_left_is_removed_by_the_next(run, folder):
    """The cells lie in a hidden folder, which is named after the process."""
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()
    with temporary_folder(folder) as own:
        left = own.with_name(own.name.replace(f"-{os.getpid()}-", f"-{process.pid}-"))
        left.mkdir()
        (left / "0.png").write_bytes(b"half")
        assert run("render", BALLS, UNLIT, "-o", "all.png", "--sheet", "2x1", *QUICK).status == 0
        assert not left.exists() and own.exists()
    assert names(folder) == ["all.png"]


@needs("posix")
@pytest.mark.parametrize("output", ["all.png", "out/"])  # a contact sheet, and a sheet of the views of each model
def test_after_kill_9_resume_makes_what_is_missing(run, folder, output):
    command = ("render", BALLS, UNLIT, SCENES / "emissive.glb", "--sheet", "3x1", *QUICK[:-1])
    killed = subprocess.run([sys.executable, "-c", KILLED, *map(str, command), "-o", output, "--resume"], check=False)
    assert killed.returncode == -signal.SIGKILL and not Path("all.png").exists()
    pictures = folder / output if output == "out/" else folder / "all.png.parts"
    assert len(names(pictures)) == 3  # the first, the manifest, and the second under a temporary name
    (pictures / "spheres.png").touch()
    touched = (pictures / "spheres.png").stat().st_mtime_ns
    outcome = run(*command, "-o", output, "--resume")
    assert (outcome.status, outcome.err) == (0, "1 of 3 models are done already\n")
    assert names(pictures) == ["emissive.png", "manifest.jsonl", "spheres.png", "unlit.png"]
    assert (pictures / "spheres.png").stat().st_mtime_ns == touched
    at_once = "once.png" if output == "all.png" else "once/"
    assert run(*command, "-o", at_once, "-q").status == 0
    made = [""] if output == "all.png" else ["spheres.png", "unlit.png", "emissive.png"]
    for name in made:
        np.testing.assert_array_equal(Image.open(output + name).srgb, Image.open(at_once + name).srgb)
    assert run(*command, "-o", output, "--resume").err == "3 of 3 models are done already\n"


def test_a_contact_sheet_to_resume_shows_no_older_picture_of_a_model_that_fails_now(run, folder):
    shutil.copy(UNLIT, "model.glb")
    command = ("render", BALLS, "model.glb", "-o", "all.png", "--sheet", "2x1", *QUICK, "--resume")
    assert run(*command).status == 0
    good = Image.open("all.png").srgb
    (folder / "model.glb").write_bytes(b"glTF")
    assert run(*command).status == 1
    assert (cell(Image.open("all.png"), 1, 2) == (225, 225, 225, 255)).all()
    shutil.copy(UNLIT, "model.glb")
    assert run(*command).status == 0
    np.testing.assert_array_equal(Image.open("all.png").srgb, good)


def test_a_kept_picture_of_a_contact_sheet_that_is_broken_is_made_again(run, folder):
    command = ("render", BALLS, UNLIT, "-o", "all.png", "--sheet", "2x1", *QUICK[:-1], "--resume")
    assert run(*command).status == 0
    good, kept = Image.open("all.png").srgb, folder / "all.png.parts" / "unlit.png"
    other = Image.from_srgb(np.zeros((2, 3, 4), np.uint8))
    for spoil in (lambda: kept.write_bytes(kept.read_bytes()[:90]), lambda: other.save(kept)):
        spoil()
        outcome = run(*command)
        assert (outcome.status, outcome.err) == (0, "1 of 2 models are done already\n")
        np.testing.assert_array_equal(Image.open("all.png").srgb, good)


def test_a_long_label_keeps_both_ends():
    blank = np.zeros((24, 60, 4), np.uint8)
    names_of_cells = ("Mesh_PrimitiveMode_01", "Mesh_PrimitiveMode_02", "Nesh_PrimitiveMode_02")
    first, second, third = (labelled_sheet([(name, blank)], 1, (60, 24)).srgb for name in names_of_cells)
    assert (first != second).any() and (second != third).any()


@pytest.mark.parametrize("label", ["Ünïcödé", "кириллица", "ελληνικά"])
def test_letters_beyond_ascii_are_no_boxes(label):
    font = font_for(label, 12)
    glyphs = [bytes(font.getmask(letter)) for letter in label]
    assert bytes(font.getmask("\U0010ffff")) not in glyphs
    assert font_for("plain", 12).getname() == ImageFont.load_default(12).getname()  # the same on all machines


def test_a_label_is_one_line():
    picture = np.full((24, 40, 4), 9, np.uint8)
    sheet = labelled_sheet([("a\nb", picture)], 1, SIZE)
    np.testing.assert_array_equal(cell(sheet, 0, 1), picture)


def test_a_folder_has_a_sheet_of_each_model(run, folder):
    assert run("render", BALLS, UNLIT, "-o", "out/", "--sheet", "2x1", *QUICK).status == 0
    assert names(folder / "out") == ["manifest.jsonl", "spheres.png", "unlit.png"]
    assert {Image.open(f"out/{name}.png").size for name in ("spheres", "unlit")} == {sheet_size(2, 2, SIZE)}
    lines = [json.loads(line) for line in Path("out/manifest.jsonl").read_text().splitlines()]
    assert [line["out"] for line in lines] == ["spheres.png", "unlit.png"]


def test_stats_of_a_sheet_of_views_are_those_of_one_picture(run, folder):
    options = ("--sheet", "2x1", "--stats", "a.json", "--quality", "standard")
    assert run("render", UNLIT, "-o", "a.png", *options, *QUICK).status == 0
    stats = json.loads((folder / "a.json").read_text())
    assert stats["output"] == "a.png" and stats["views"] == 2 and stats["plan"]["quality"] == "standard"
    assert stats["size"] == list(Image.open(folder / "a.png").size) == list(sheet_size(2, 2, SIZE))


def test_cameras_of_a_sheet_are_those_of_its_views(run, folder):
    """They make its pictures again, also where `--resume` has made none. They name no picture: each is but a part."""
    command = ("render", BALLS, "-o", "a.png", "--sheet", "2x2", "--write-cameras", "a.json", *QUICK, "--resume")
    assert run(*command).status == 0
    first = Path("a.json").read_text()
    assert all("file_path" not in frame for frame in json.loads(first)["frames"])
    (folder / "a.json").unlink()
    assert run(*command).status == 0 and Path("a.json").read_text() == first
    assert run("render", BALLS, "-o", "again/{view}.png", "--cameras", "a.json", *QUICK[2:]).status == 0
    for k in range(4):
        np.testing.assert_array_equal(cell(Image.open("a.png"), k, 2), Image.open(f"again/{k}.png").srgb)


@pytest.mark.parametrize(("arguments", "words"), [
    ((BALLS, UNLIT, "-o", "a.png", "--sheet", "1x1"), "--sheet 1x1: 2 models need at least 1x2"),
    ((BALLS, UNLIT, "-o", "a.exr", "--sheet", "2x1"), "-o a.exr: a sheet is a picture as displayed"),
    ((BALLS, UNLIT, "-o", "a.png", "--sheet", "2x1", "--view", "top,left"), "a sheet of several models has one view"),
    ((BALLS, "-o", "a.png", "--sheet", "1x1", "--view", "top,left"), "--sheet 1x1: 2 views need at least 1x2"),
    ((BALLS, "-o", "a.exr", "--sheet", "2x1"), "-o a.exr: a sheet is a picture as displayed"),
    ((BALLS, "-o", "a.gif", "--sheet", "2x1"), "-o a.gif: a sheet is a picture as displayed"),
    ((BALLS, "-o", "a.png", "--sheet", "2x1", "--eye", "1,2,3"), "--eye and a sheet of views"),
    ((BALLS, "-o", "a.png", "--sheet", "2x1", "--aov", "depth"), "--aov and --sheet cannot be used together"),
    ((BALLS, "-o", "a.png", "--sheet", "2x1", "--tell-error"), "--tell-error and --sheet cannot be used together"),
    ((BALLS, UNLIT, "-o", "a.png", "--sheet", "2x1", "--write-cameras", "a.json"),
     "--write-cameras and a sheet of several models cannot be used together; it can with pictures in a folder"),
    ((BALLS, UNLIT, "-o", "a.png", "--sheet", "2x1", "--stats", "a.json"), "--stats and a sheet of several models"),
    ((BALLS, "-o", "a.png", "--sheet", "2"), "'2' is not COLSxROWS, such as 4x2"),
    ((BALLS, "-o", "a.png", "--sheet", "999x999"), "more than 134217728; --size makes them smaller"),
])
def test_what_is_no_sheet_is_refused_before_anything_is_drawn(run, folder, arguments, words):
    outcome = run("render", *arguments)
    assert outcome.status == 2 and words in outcome.err and names(folder) == []
