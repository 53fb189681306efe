"""Which methods a device is measured with, and what a small scene is worth as a load."""

from __future__ import annotations

from dataclasses import replace

from viewer.budget import calibrate
from viewer.budget.calibrate import BAKED, _methods
from viewer.budget.cost import Load
from viewer.budget.scenes import again, crowd, herd, lit_scenes, mapped
from viewer.measure.report.ladder import PLAIN, Method


def test_what_bakes_by_tracing_paths_is_left_out(monkeypatch):
    scene = lit_scenes()["environment"][0]
    baking = [replace(PLAIN, name=name, changes={**PLAIN.changes, name: "x"}) for name in sorted(BAKED)]
    plain = Method("ibl", "image-based light", {"antialias": "none"})
    ladder = type("Ladder", (), {"raster": (PLAIN, *baking, plain)})
    monkeypatch.setattr(calibrate, "ladder", lambda scene, settings: ladder)
    assert [method.slug for method in _methods(scene).values()] == [PLAIN.slug, plain.slug]


def test_scenes_of_a_calibration_differ_in_one_part_each():
    base = lit_scenes()["lights"][0]
    loads = {name: Load.of(scene, (64, 64)) for name, scene in (
        ("base", base), ("again", again(base)), ("crowd", crowd(base)), ("herd", herd(base)),
        ("mapped", mapped(base, 16)))}
    few = loads["base"]
    assert loads["again"] == few and again(base).meshes[0] is not base.meshes[0]
    assert loads["crowd"].triangles > 3 * few.triangles and loads["crowd"].draws == few.draws
    assert loads["herd"].draws == few.draws + 256 and loads["herd"].triangles < 1.05 * few.triangles
    assert loads["mapped"].texels == 256 and loads["mapped"].programs == few.programs + 1
    assert few.shadowed == 2 * few.triangles
