"""The path tracer's golden images: what it draws differs from the stored mean of many pictures by noise alone.

That each of them fails when its shader is broken is shown by break_path_shaders.py.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from break_path_shaders import MUTATIONS
from contexts import open_or_skip
from mutations import Mutation
from needs import require
from path_cases import CASES, SIZE, PathCase
from path_golden import FOLDER, PathGolden

from viewer.base.resources import resource_folder
from viewer.trace.tracer import Tracer

IN_A_SHADER = ("metal", "glass-thin", "alpha")
"""Traced by the BVH in a shader, too: every kind of surface, and masks, for which it asks materials."""
CHOSEN = [("embree", case) for case in CASES] + [("bvh", case) for case in CASES if case.name in IN_A_SHADER]


@pytest.fixture(scope="module")
def tracers() -> Iterator[dict[str, Tracer]]:
    require("embree")
    with open_or_skip() as context:
        tracers = {name: Tracer(context, use_cache=False, intersector=name) for name in ("embree", "bvh")}
        yield tracers
        for tracer in tracers.values():
            tracer.release()


@pytest.mark.parametrize(("intersector", "case"), CHOSEN, ids=lambda value: getattr(value, "name", value))
def test_scene(tracers: dict[str, Tracer], intersector: str, case: PathCase) -> None:
    scene, camera = case.make()
    picture = tracers[intersector].render(scene, camera, case.with_seed(1), SIZE)
    assert picture.stats["bad_samples"] == 0
    problem = PathGolden.load(case.name).problem(picture.linear[..., :3])
    assert problem is None, f"{case.name}: {problem}"


def test_every_golden_image_has_its_scene() -> None:
    stored = {path.stem.removesuffix("-variance") for path in FOLDER.glob("*.exr")}
    assert stored == {case.name for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_is_found(case: PathCase) -> None:
    """Pictures made of the golden image's own noise pass; not so with 1.5 % more light, with all light a pixel off, or
    with a tenth less light in a sixteenth of the picture."""
    golden = PathGolden.load(case.name)
    noise = np.random.default_rng(3).normal(size=golden.mean.shape) * np.sqrt(golden.variance)
    picture = golden.mean + noise
    assert golden.problem(picture) is None
    assert golden.problem(1.015 * golden.mean + noise) is not None
    assert golden.problem(np.roll(golden.mean, 1, axis=1) + noise) is not None
    picture[16:24, 16:24] *= 0.9
    assert golden.problem(picture) is not None


def test_numbers_that_are_none_never_pass() -> None:
    golden = PathGolden.load("metal")
    picture = golden.mean.copy()
    picture[0, 0, 0] = np.nan
    assert golden.problem(picture) == "some pixels are not finite"


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_what_break_path_shaders_breaks_is_still_there(mutation: Mutation) -> None:
    """Where this fails, the shader was rewritten: write the mutation anew in break_path_shaders.py, and run it."""
    mutation.check(resource_folder("shaders"))
