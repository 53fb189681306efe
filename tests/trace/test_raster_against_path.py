"""The raster's picture of each feature equals the path tracer's within the bounds of features.py."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from features import FEATURES, distance

from viewer.raster.renderer import Renderer


@pytest.fixture(scope="module")
def renderer(context) -> Iterator[Renderer]:
    renderer = Renderer(context)
    yield renderer
    renderer.release()


@pytest.mark.parametrize("feature", FEATURES, ids=lambda feature: feature.name)
def test_the_raster_is_near(renderer, tracer, feature):
    found = distance(feature, renderer, tracer)
    assert found.mean < feature.mean
    assert found.blocks < feature.blocks
