"""The raster's picture of each feature equals the path tracer's within the bounds of features.py."""

from __future__ import annotations

import pytest
from features import FEATURES, distance


@pytest.mark.parametrize("feature", FEATURES, ids=lambda feature: feature.name)
def test_the_raster_is_near(renderer, tracer, feature):
    found = distance(feature, renderer, tracer)
    assert found.mean < feature.mean
    assert found.blocks < feature.blocks
