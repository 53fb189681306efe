from __future__ import annotations

import pytest

from viewer.measure.report.document import ready_seconds
from viewer.settings import Settings


def test_what_earlier_points_made_ready_counts_for_later_ones():
    measured = [(Settings(), 1.0),  # decodes and uploads
             (Settings(environment_shadows="16"), 0.5),
             (Settings(indirect="baked"), 3.0),
             (Settings(environment_shadows="16", indirect="baked"), 0.125),
             (Settings(mode="path"), 2.0),
             (Settings(mode="path", denoise="fast"), 0.25)]
    assert ready_seconds(measured) == pytest.approx([1.0, 1.5, 4.0, 4.625, 2.0, 2.25])
    assert ready_seconds([]) == []
