"""STEP files, which Open CASCADE reads where the package of an extra is installed."""

from __future__ import annotations

import numpy as np
import pytest
from needs import needs
from step_file import box, step

from viewer.errors import InputError
from viewer.scene import load
from viewer.scene.load import load_scene


@needs("cad")
@pytest.mark.parametrize(("unit", "metres"), [("SI_UNIT(.MILLI.,.METRE.)", 0.001), ("SI_UNIT($,.METRE.)", 1.0)])
def test_a_box_in_the_unit_of_the_file(tmp_path, unit, metres):
    (tmp_path / "box.step").write_bytes(step(box((10, 20, 30)), unit=unit))
    scene = load_scene(tmp_path / "box.step")
    assert scene.triangle_count == 12 and scene.facts["format"] == "STEP" and scene.name == "box"
    np.testing.assert_allclose(scene.bounds, [[0, 0, 0], np.multiply((10, 20, 30), metres)], rtol=1e-5, atol=1e-6)
    (mesh,) = scene.meshes
    outward = np.einsum("nk,nk->n", mesh.normals, mesh.positions - mesh.positions.mean(axis=0))
    assert (outward > 0).all()


@needs("cad")
def test_colours_are_those_of_dielectrics_and_what_has_none_is_grey(tmp_path):
    (tmp_path / "red.stp").write_bytes(step(box((1, 1, 1)), color=(0.8, 0.1, 0.1)))
    (tmp_path / "plain").write_bytes(step(box((1, 1, 1))))  # known by its content
    red, = load_scene(tmp_path / "red.stp").materials
    plain, = load_scene(tmp_path / "plain").materials
    np.testing.assert_allclose(red.base_color, [0.604, 0.01, 0.01, 1], atol=1e-3)  # of sRGB
    assert red.metallic == 0 and red.double_sided
    np.testing.assert_allclose(plain.base_color, [0.32, 0.32, 0.32, 1])


@needs("cad")
@pytest.mark.parametrize(("broken", "problem"), [
    (lambda text: text[:1500], "cannot be read as STEP: it is broken"),
    (lambda text: text[:40], "cannot be read as STEP: it is broken"),
    (lambda text: text.replace(b"PLANE(", b"PLANX("), "the file contains nothing to draw"),
], ids=["cut off", "without data", "faces of no surface"])
def test_what_is_broken_is_one_line(tmp_path, broken, problem):
    (tmp_path / "a.step").write_bytes(broken(step(box((1, 2, 3)))))
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / "a.step")
    assert str(caught.value) == f"{tmp_path / 'a.step'}: {problem}"


def test_without_the_package_the_error_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "a.step").write_bytes(b"ISO-10303-21;")
    monkeypatch.setattr(load, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"STEP needs packages .* pip install 'pbr-viewer\[cad\]'"):
        load_scene(tmp_path / "a.step")
