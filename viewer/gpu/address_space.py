"""Tells a lack of address space (`ulimit -v`) before a driver meets it.

Where Mesa lacks memory while it opens a context, it may end the process, or it waits for ever for threads that it could
not start (create_rast_threads in src/gallium/drivers/llvmpipe/lp_rast.c). Neither can be caught, so it is foreseen.
"""

from __future__ import annotations

import mmap
import sys

from ..errors import ContextError

OPENING_MB = 256
"""What Mesa takes while it opens a context: its libraries, LLVM's, and the stacks of its threads. Measured: 247. Its
programs take more, but what the model's images take while they are decoded may be free for them by then."""


def check_address_space() -> None:
    """Raises ContextError where this process may not map as much more as opening a context takes."""
    if sys.platform.startswith("linux") and not _has_room(OPENING_MB):
        raise ContextError(f"no OpenGL context: out of memory: it takes {OPENING_MB} MB more of address space, which "
                           "is beyond the limit of this process (ulimit -v)")


def _has_room(megabytes: int) -> bool:
    try:
        mmap.mmap(-1, megabytes << 20, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, prot=mmap.PROT_READ).close()
    except OSError:
        return False
    return True
