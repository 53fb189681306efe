"""What the driver has compiled before."""

from __future__ import annotations

from dataclasses import replace

import pytest
from test_choice import CALIBRATION

from viewer.bake import cache
from viewer.budget import known
from viewer.budget.cost import Load, plain_plan
from viewer.budget.known import load_known, store_known, surfaces
from viewer.measure.check.scenes import scene, sphere
from viewer.scene.light import Light
from viewer.scene.material import Material


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(tmp_path))
    return tmp_path


def test_names_are_found_again_for_the_same_device_alone():
    assert load_known("a") == frozenset()
    store_known("a", frozenset({"x Phong", "y Phong"}))
    assert load_known("a") == {"x Phong", "y Phong"} and load_known("b") == frozenset()


def test_a_damaged_file_counts_as_none():
    cache.store(known._key("a"), {"names": known.np.frombuffer(b"{", known.np.uint8)})
    assert load_known("a") == frozenset()


def test_scenes_of_the_same_programs_have_the_same_name():
    ball, sun = sphere(segments=8), Light.from_angles(0.7, 0.9, 3.0)
    red, blue = (scene([ball], [Material(base_color=color)], lights=[sun]) for color in ((1, 0, 0, 1), (0, 0, 1, 1)))
    unlit = scene([ball], [Material(unlit=True)], lights=[sun])
    names = [surfaces(plain_plan(one)) for one in (red, blue, unlit)]
    assert names[0] == names[1] != names[2]


def test_a_first_program_tells_whether_the_drivers_cache_was_emptied():
    calibration = replace(CALIBRATION, first_program=(0.2, 0.05))
    assert calibration.is_forgotten(0.15) and not calibration.is_forgotten(0.06)
    assert not replace(CALIBRATION, first_program=(0.06, 0.05)).is_forgotten(9.0)


def test_a_load_counts_what_shadow_maps_take():
    ball = sphere(segments=8)
    lit = scene([ball], [Material()], lights=[Light.from_angles(0.7, 0.9, 3.0), Light("point", position=(3, 3, 3))])
    load = Load.of(lit, (20, 10))
    assert (load.pixels, load.draws, load.programs, load.bakes) == (200, 1, 1, 0)
    assert load.shadowed == 7 * load.triangles == 7 * lit.triangle_count
