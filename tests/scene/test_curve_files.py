"""Files of curves: Cem Yuksel's .hair and .bcc, and Mitsuba's text."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from byte_mutations import mutations
from click.testing import CliRunner
from needs import SHARED, needs

from viewer.cli import cli
from viewer.errors import InputError, UsageError
from viewer.scene.curve_segments import segments
from viewer.scene.curves import Curves
from viewer.scene.load import load_scene
from viewer.scene.text import number_rows

POINTS = np.float32([[0, 0, 0], [1, 0.1, 0], [1, 2, 0], [5, 5, 5], [5, 6, 5]])
COLORS = np.random.default_rng(0).random((5, 3)).astype(np.float32)
THICKNESS = np.float32([0.2, 0.1, 0, 0.25, 0.5])


def hair(path, strands=2, count=5, bits=3, default=0, thickness=0.5, transparency=0.0, color=(1, 1, 1), lengths=(2, 1),
         points=POINTS, more=b""):
    numbers = strands, count, bits, default, thickness, transparency, *color
    head = struct.pack("<4s4I5f88s", b"HAIR", *numbers, b"made up")
    parts = [np.asarray(lengths, "<u2").tobytes() * (bits & 1), np.asarray(points, "<f4").tobytes() * (bits >> 1 & 1)]
    path.write_bytes(head + b"".join(parts) + more)
    return path


def bcc(path, signed=(3, -4), points=None, strands=None, count=None, sizes=b"BCC\x44", kind=b"C0", dimensions=3, up=1,
        more=b""):
    total = sum(map(abs, signed))
    points = np.arange(3 * total, dtype="<f4").reshape(-1, 3) ** 2 if points is None else np.asarray(points, "<f4")
    head = struct.pack("<4s2sBBQQ40s", sizes, kind, dimensions, up, len(signed) if strands is None else strands,
                       total if count is None else count, b"made up")
    parts = np.split(points, np.cumsum(np.abs(signed))[:-1])
    path.write_bytes(head + b"".join(struct.pack("<i", n) + p.tobytes() for n, p in zip(signed, parts)) + more)
    return path


def text(path, content: str):
    path.write_text(content)
    return path


def only(path) -> Curves:
    curves, = load_scene(path).curves
    return curves


def test_hair_with_the_values_of_its_header(tmp_path):
    scene = load_scene(hair(tmp_path / "lock.hair"))
    curves, = scene.curves
    np.testing.assert_array_equal(curves.points, POINTS)
    assert curves.radii.tolist() == [0.25] * 5 and curves.offsets.tolist() == [0, 3, 5] and not curves.closed.any()
    assert curves.kind == "linear" and curves.colors is None and curves.fibre is None and not scene.warnings
    assert scene.facts == {"format": "HAIR", "comment": "made up"} and scene.name == "lock"
    colored = only(hair(tmp_path / "lock.hair", color=(1, 0.5, 0.25)))
    np.testing.assert_array_equal(colored.colors, [[1, 0.5, 0.25]] * 5)
    for color, is_told in (((1, 0.5, 0.25), False), ((1.5, 0.5, 0.25), True), ((1, -0.5, 0.25), True)):
        told = load_scene(hair(tmp_path / "lock.hair", color=color)).warnings
        assert list(told) == ["colours below 0 are taken as 0, and those above 1 as 1"] * is_told


def test_hair_with_every_array(tmp_path):
    more = THICKNESS.tobytes() + np.float32([0, 0, 1, 0, 0]).tobytes() + COLORS.tobytes() + bytes(40)
    scene = load_scene(hair(tmp_path / "a.hair", bits=63, more=more))
    curves, = scene.curves
    np.testing.assert_array_equal(curves.radii, THICKNESS / 2)
    np.testing.assert_array_equal(curves.colors, COLORS)
    assert scene.warnings == ("the transparency of hair is left out",)


def test_hair_of_equal_strands_needs_no_array_of_segments(tmp_path):
    curves = only(hair(tmp_path / "a.hair", strands=2, count=4, bits=2, default=1, points=POINTS[:4]))
    assert curves.offsets.tolist() == [0, 2, 4]


@pytest.mark.parametrize("changes, problem", [
    ({"bits": 1}, "header: says that the file has no points"),
    ({"bits": 67}, "header: names arrays that are not known: bits 0x43"),
    ({"strands": 3}, "points: 5 of them take 60 bytes, but the file has 58 left"),
    ({"count": 4}, "segments: the strands have 5 points, but the file has 4"),
    ({"count": 6}, "points: 6 of them take 72 bytes, but the file has 60 left"),
    ({"count": 2**32 - 1}, "points: 4,294,967,295 of them take 51,539,607,540 bytes"),
    ({"strands": 2**32 - 1}, "segments: 4,294,967,295 of them take 8,589,934,590 bytes"),
    ({"bits": 2, "strands": 2**32 - 1, "default": 2**32 - 1},
     "header: 4,294,967,295 strands of 4,294,967,295 segments do not have 5 points"),
    ({"lengths": (3, 0)}, "strand 1, point 0: has 1 point; a strand has at least 2"),
    ({"points": np.where(POINTS == 2, np.nan, POINTS)}, "strand 0, point 2: a coordinate is infinite or NaN"),
    ({"points": np.where(POINTS == 6, np.inf, POINTS)}, "strand 1, point 1: a coordinate is infinite or NaN"),
    ({"points": POINTS * np.float32(1e18)}, "strand 0, point 1: a coordinate is beyond 1e+18"),
    ({"thickness": np.nan}, "strand 0, point 0: a radius is infinite or NaN"),
    ({"thickness": -2}, "strand 0, point 0: the radius -1 is negative"),
    ({"thickness": 0}, "all radii are 0: there is nothing to draw"),
    ({"color": (1, np.nan, 1)}, "strand 0, point 0: a colour is infinite or NaN"),
    ({"bits": 7}, "thickness: 5 of them take 20 bytes, but the file has 0 left"),
    ({"bits": 7, "more": np.float32([1, 1, 1, 1, -1]).tobytes()}, "strand 1, point 1: the radius -0.5 is negative"),
    ({"strands": 0, "count": 0, "lengths": (), "points": ()}, "the file has no strands"),
])
def test_hair_that_cannot_be_used(tmp_path, changes, problem):
    path = hair(tmp_path / "bad.hair", **changes)
    with pytest.raises(InputError) as error:
        load_scene(path)
    assert str(error.value).startswith(f"{path}: ") and problem in str(error.value)


def test_bytes_behind_the_last_array_are_told(tmp_path):
    assert load_scene(hair(tmp_path / "a.hair", more=bytes(7))).warnings == (
        "7 bytes behind the last array are not read",)
    assert load_scene(bcc(tmp_path / "a.bcc", more=bytes(7))).warnings[0] == (
        "7 bytes behind the last curve are not read")


def test_bcc(tmp_path):
    scene = load_scene(bcc(tmp_path / "yarn.bcc"))
    curves, = scene.curves
    np.testing.assert_array_equal(curves.points, np.arange(21).reshape(7, 3) ** 2)
    assert curves.offsets.tolist() == [0, 3, 7] and curves.closed.tolist() == [False, True]
    assert curves.kind == "catmull-rom" and scene.facts == {"format": "BCC", "comment": "made up"}
    steps = np.linalg.norm(np.diff(curves.points, axis=0), axis=1)
    np.testing.assert_allclose(curves.radii, (steps.sum() - steps[2]) / 10, rtol=1e-6)
    assert scene.warnings == (f"the file has no radii; {curves.radii[0]:g} is taken where no setting gives another, "
                              "half the mean distance of neighbouring points",)
    assert only(bcc(tmp_path / "line.bcc", kind=b"PL")).kind == "linear"


@pytest.mark.parametrize("up", [0, 1, 2])
def test_up_in_a_bcc_is_y_here_and_nothing_is_mirrored(tmp_path, up):
    axes = np.roll(np.eye(3), up - 1, axis=1)  # rows: three axes in a right-handed order, the middle one is up
    curves = only(bcc(tmp_path / "a.bcc", signed=(4,), points=np.concatenate([[[0, 0, 0]], axes]), up=up))
    found = curves.points[1:]
    np.testing.assert_array_equal(found[1], [0, 1, 0])
    assert np.linalg.det(found) == pytest.approx(np.linalg.det(axes)) == pytest.approx(1)


def test_what_does_not_begin_as_its_ending_says_is_refused(tmp_path):
    for make, name in ((hair, "HAIR"), (bcc, "BCC")):
        path = make(tmp_path / f"bad.{name.lower()}")
        path.write_bytes(b"X" + path.read_bytes()[1:])
        with pytest.raises(InputError) as error:
            load_scene(path)
        assert str(error.value) == f"{path}: header: not a {name} file: it does not begin with '{name}'"


@pytest.mark.parametrize("changes, problem", [
    ({"sizes": b"BCC\x88"}, "header: has numbers of other sizes than four bytes"),
    ({"kind": b"C1"}, "header: curves of the type 'C1' are not read"),
    ({"dimensions": 2}, "header: has 2 dimensions of which number 1 is up"), ({"up": 3}, "number 3 is up"),
    ({"count": 8}, "header: 2 curves of 8 points take 104 bytes, but the file has 92"),
    ({"count": 6}, "strand 1: has 4 points, of which the file ends before the last"),
    ({"strands": 3, "count": 6}, "strand "), ({"strands": 2**64 - 1, "count": 2**64 - 1}, "points take"),
    ({"strands": 1}, "header: says 7 points, but the curves have 3"),
    ({"signed": (-2**31 + 7,), "points": np.zeros((0, 3)), "count": 0, "strands": 1}, "strand 0: has 2,147,483,641 "),
    ({"signed": (6, 1)}, "strand 1, point 0: has 1 point; a strand has at least 2"),
    ({"signed": (5, -2)}, "strand 1, point 0: has 2 points; a closed strand has at least 3"),
    ({"signed": (7, 0)}, "strand 1: has 0 points; a strand has at least 2"),
    ({"points": np.full((7, 3), np.nan)}, "strand 0, point 0: a coordinate is infinite or NaN"),
    ({"signed": ()}, "the file has no strands"),
])
def test_a_bcc_that_cannot_be_used(tmp_path, changes, problem):
    path = bcc(tmp_path / "bad.bcc", **changes)
    with pytest.raises(InputError) as error:
        load_scene(path)
    assert str(error.value).startswith(f"{path}: ") and problem in str(error.value)


def test_text(tmp_path):
    curves = only(text(tmp_path / "a.curves", "\n\n0 0 0 1\r\n1\t2 3 .5 \n\n  \n4 5 6 1e-1\n7 8 9 0\n1 1 1 1"))
    np.testing.assert_allclose(curves.points, [[0, 0, 0], [1, 2, 3], [4, 5, 6], [7, 8, 9], [1, 1, 1]])
    np.testing.assert_allclose(curves.radii, [1, 0.5, 0.1, 0, 1])
    assert curves.offsets.tolist() == [0, 2, 5] and curves.kind == "linear"


@pytest.mark.parametrize("content, problem", [
    ("0 0 0 1\n\n\n1 1 1\n", "line 4: has 3 numbers; a point has 4: x, y, z and its radius"),
    ("0 0 0 1\n1 1 x 1\n", "line 2: 'x' is not a number"),
    ("0 0 0 1\n1 1 1 1\n\n\n2 2 2 1\n3 3 x 1\n", "line 6: 'x' is not a number"),
    ("0 0 0 1\n1 1 nan 1\n", "line 2: a coordinate is infinite or NaN"),
    ("0 0 0 1\n1 1 1e99 1\n", "line 2: a coordinate is infinite or NaN"),
    ("\n0 0 0 1\n1 1 1 -.5\n", "line 3: the radius -0.5 is negative"), ("0 0 0 0\n1 1 1 0\n", "all radii are 0"),
    ("0 0 0 1\n1 1 1 1\n\n2 2 2 2\n", "line 4: has 1 point; a strand has at least 2"),
    (" \n\n", "the file has no strands"),
])
def test_text_that_cannot_be_used(tmp_path, content, problem):
    with pytest.raises(InputError) as error:
        load_scene(text(tmp_path / "bad.curves", content))
    assert str(error.value) == f"{tmp_path / 'bad.curves'}: {problem}" or problem in str(error.value)


def test_rows_know_their_lines(tmp_path):
    rows = number_rows(tmp_path, b"\n1 2\n \n\n3\n4 5 6", str)
    assert rows.lines.tolist() == [1, 4, 5] and rows.counts.tolist() == [2, 1, 3]
    assert number_rows(tmp_path, b"\n \n", str).lines.tolist() == [] and len(number_rows(tmp_path, b"", str)) == 0


def test_what_is_written_is_read_again_to_the_last_bit(tmp_path):
    rng = np.random.default_rng(3)
    points, radii = rng.normal(size=(9, 3)).astype(np.float32) * 1e3, rng.random(9).astype(np.float32) * 1e-3
    shape = Curves("a", points, radii, [0, 4, 9], [False, True])
    shape.save(tmp_path / "a.curves")
    found = only(tmp_path / "a.curves")
    np.testing.assert_array_equal(found.points, points[[*range(9), 4]])
    np.testing.assert_array_equal(found.radii, radii[[*range(9), 4]])
    assert found.offsets.tolist() == [0, 4, 10] and (tmp_path / "a.curves").read_text().count("\n\n") == 1


@pytest.mark.parametrize("kind", ["catmull-rom", "b-spline"])
def test_splines_are_written_as_segments_or_as_they_are(tmp_path, kind):
    points = np.random.default_rng(3).normal(size=(9, 3)).astype(np.float32)
    shape = Curves("a", points, np.full(9, 0.1), [0, 4, 9], [False, True], kind)
    shape.save(tmp_path / "a.curves")
    found = only(tmp_path / "a.curves")
    if kind == "catmull-rom":
        np.testing.assert_array_equal(segments(found).ends, segments(shape).ends)
    else:
        np.testing.assert_array_equal(found.points, points[[*range(9), 4, 5, 6]])
        again = Curves("b", found.points, found.radii, found.offsets, [False] * 2, kind)
        np.testing.assert_allclose(segments(again).ends, segments(shape).ends, atol=1e-6)


def test_where_curves_are_not_saved(tmp_path):
    shape = Curves("a", POINTS, np.ones(5), [0, 5], [False])
    with pytest.raises(UsageError, match=r"a.hair: curves are saved as .curves"):
        shape.save(tmp_path / "a.hair")
    with pytest.raises(UsageError, match="path is of type int, not a path"):
        shape.save(3)


@pytest.mark.parametrize("make", [hair, bcc])
def test_broken_files_are_refused_in_one_line_or_read(tmp_path, make):
    for k, data in enumerate(mutations(make(tmp_path / "whole").read_bytes(), 150, seed=1)):
        (tmp_path / "broken").write_bytes(data)
        try:
            scene = load_scene(tmp_path / "broken")
        except InputError as error:
            assert "\n" not in str(error) and str(error).startswith(str(tmp_path / "broken")), k
        else:
            assert np.isfinite(scene.bounds).all() and np.isfinite(segments(scene.curves[0]).ends).all(), k


def test_info_lists_curves(tmp_path):
    path, other = hair(tmp_path / "a.hair"), bcc(tmp_path / "b.bcc")
    facts = tmp_path / "facts.json"
    done = CliRunner().invoke(cli, ["info", str(path), "--env", "none", "--json", str(facts)])
    assert done.exit_code == 0, done.output
    told, = json.loads(facts.read_text())["curves"]
    length = sum(np.linalg.norm(POINTS[k + 1] - POINTS[k]) for k in (0, 1, 3))
    assert told == {"name": "a", "kind": "linear", "strands": 2, "closed": 0, "points": 5, "segments": 3,
                    "length": pytest.approx(length, rel=1e-6), "radii": [0.25, 0.25], "colors": False}
    done = CliRunner().invoke(cli, ["info", str(other), "--env", "none"])
    assert done.exit_code == 0 and "curves:\n  - name b, kind catmull-rom, strands 2, closed 1, points 7" in done.output
    done = CliRunner().invoke(cli, ["info"])
    assert "curves: hair bcc curves\n" in done.output


@needs("corpus")
@pytest.mark.parametrize("name, kind, strands, points", [
    ("bangs_100.hair", "linear", 100, 1165), ("flame_ribbing_pattern.bcc", "catmull-rom", 1, 49745),
    ("curve_6.curves", "linear", 4, 18)])
def test_files_of_other_programs(name, kind, strands, points):
    curves = only(SHARED / "corpus" / "curves" / name)
    assert (curves.kind, curves.strand_count, len(curves.points)) == (kind, strands, points)


@needs("truth")
def test_hair_and_text_say_the_same():
    folder = SHARED / "truth" / "hair-lock"
    one, two = only(folder / "lock.hair"), only(folder / "lock.curves")
    for name in ("points", "radii", "offsets"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
