"""A piece of benchmarks/weave.py: woven cloth is as bright as the fibres that it is spun of."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.weave import AXES, PAIRS, matched, plate, reflectance
from viewer.scene.scene import Scene
from viewer.scene.weave import WEAVES
from viewer.scene.yarn.woven import weave_fibres
from viewer.trace.tracer import Tracer


@pytest.mark.parametrize("pair", [PAIRS[1], PAIRS[5], AXES[0]], ids=str)
def test_cloth_is_as_bright_as_its_fibres(context, pair):
    weave, kind = matched(WEAVES["plain"])
    tracer = Tracer(context)
    fibres = Scene("fibres", curves=(weave_fibres(weave, kind, (3, 3)),))
    of_fibres = reflectance(tracer, fibres, pair, 6, bounces=60)
    of_cloth = reflectance(tracer, plate(weave, 3), pair, 12, bounces=2)
    tracer.release()
    assert np.abs(of_cloth / of_fibres - 1).max() < 0.12
