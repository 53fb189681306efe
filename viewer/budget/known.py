"""What the driver has compiled before, and so keeps on disk: by surfaces and method."""

from __future__ import annotations

import hashlib
import json
from importlib.metadata import version

import numpy as np

from ..bake import cache
from ..plan.model import Plan

MOST = 4096
"""Names that are kept."""


def surfaces(plan: Plan) -> str:
    """Names what a scene's surfaces need of shaders; `plan` is that of a plain picture."""
    programs = sorted((program.fragment, program.switches) for program in plan.programs)
    return hashlib.blake2b(json.dumps(programs).encode(), digest_size=8).hexdigest()


def load_known(renderer: str) -> frozenset[str]:
    """Names of surfaces with methods, "SURFACES TITLE"."""
    stored = cache.load(_key(renderer))
    try:
        return frozenset() if stored is None else frozenset(json.loads(stored["names"].tobytes()))
    except (KeyError, TypeError, ValueError):
        return frozenset()


def store_known(renderer: str, names: frozenset[str]) -> None:
    """Failing to is no error."""
    text = json.dumps(sorted(names)[:MOST]).encode()
    cache.store(_key(renderer), {"names": np.frombuffer(text, np.uint8)})


def _key(renderer: str) -> str:
    from ..base.digest import code_digest

    return cache.key("programs", renderer, version("pbr-viewer"), code_digest())
