"""Yarns in mode path are pictures of their fibres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pictures import picture
from shapes import constant

from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.scene import Scene
from viewer.scene.yarn.fibres import yarn_fibres
from viewer.scene.yarn.kind import YARNS
from viewer.trace.tracer import Tracer

KNOT = Curves("knot", [[-1, -0.3, 0], [0.3, 0.2, 0.1], [0.1, -0.5, 0.3], [1, 0.4, 0]], np.full(4, 0.2), [0, 4], [False],
              "catmull-rom")


def test_the_setting_shows_the_fibres_of_the_kind(tracer: Tracer) -> None:
    shown = Scene("knot", curves=(KNOT,), environment=constant())
    camera = Camera.orbit(shown.center, 2.5 * shown.radius, 0.3, 0.2)
    kind = replace(YARNS["wool"], plies=2, fibres=8)
    fibres = replace(shown, curves=(yarn_fibres(KNOT, kind),))
    options = {"spp": 4, "background": "none"}
    expected = picture(tracer, fibres, camera, (32, 32), **options)
    found = picture(tracer, shown, camera, (32, 32), yarn="wool", yarn_fibres=8, **options)
    tubes = picture(tracer, shown, camera, (32, 32), **options)
    assert (found == expected).mean() > 0.99 and np.abs(found - tubes).max() > 0.3
    again = picture(tracer, shown, camera, (32, 32), yarn="wool", yarn_fibres=8, **options)
    assert (again == found).all()
