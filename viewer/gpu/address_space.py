"""Tells a lack of address space (`ulimit -v`) before a driver meets it.

Mesa ends the process where it gets no memory for LLVM's code, and waits for ever if it could not start its threads
(create_rast_threads in src/gallium/drivers/llvmpipe/lp_rast.c). Neither can be caught, so both are to be foreseen.
"""

from __future__ import annotations

import mmap
import sys

from ..errors import ContextError

FIRST_PICTURE_MB = 384
"""What Mesa takes up to the end of a small picture: its libraries, the stacks of its threads, its programs. The
simplest pictures of mode phong take 290, and those of mode pbr up to 360."""


def check_address_space() -> None:
    """Raises ContextError where this process may not map as much more as a first picture takes."""
    if sys.platform.startswith("linux") and not _has_room(FIRST_PICTURE_MB):
        raise ContextError(f"no OpenGL context: out of memory: a small picture takes {FIRST_PICTURE_MB} MB more of "
                           "address space than this process may use (ulimit -v)")


def _has_room(megabytes: int) -> bool:
    try:
        mmap.mmap(-1, megabytes << 20, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, prot=mmap.PROT_READ).close()
    except OSError:
        return False
    return True
