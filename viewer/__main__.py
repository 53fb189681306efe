"""`python -m viewer` is `pbr-viewer`."""

from __future__ import annotations

import atexit
import os
import sys
from contextlib import suppress

from .base.signals import Stopped, stoppable

# A pool of BLAS threads costs each start 50 ms and more of processor time, and the one bake that multiplies matrices
# gains little by it. numpy reads this once, so it must be said before anything imports it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def main() -> None:
    """`cli.main`, with Ctrl-C answered from the first import on. The process ends with its status."""
    try:
        _run()
    except SystemExit as ended:
        if isinstance(ended.code, int):
            _end(ended.code)
        raise


def _run() -> None:
    try:
        with stoppable():  # no KeyboardInterrupt: after one in code that is made of text, Python ends by the signal
            from .cli import main as run

            run()
    except Stopped as stopped:
        print(f"pbr-viewer: {stopped}", file=sys.stderr)
        sys.exit(stopped.exit_status)


def _end(status: int) -> None:
    """End the process as Python does, but for freeing each object (benchmarks/results/start.md).

    Where that cannot be done, Python does it.
    """
    # Not above, where Ctrl-C is not answered yet and would show a traceback
    import ctypes
    import threading

    with suppress(AttributeError, OSError, TypeError, ValueError):
        threading._shutdown()  # type: ignore[attr-defined]  # waits for threads, such as those of pools
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        ctypes.PyDLL(None).exit(status)


if __name__ == "__main__":
    main()
