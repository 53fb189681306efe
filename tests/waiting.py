"""How long a test waits for what must happen: so long that only what never happens fails on a busy machine."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE_S = 120.0


def wait_until(condition: Callable[[], object], meanwhile: Callable[[], object] = lambda: time.sleep(0.01),
               *, what: str = "what is waited for") -> None:
    """Call `meanwhile` until the condition holds; fails after PATIENCE_S seconds without it."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, f"{what} does not happen"
        meanwhile()
