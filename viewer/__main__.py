"""`python -m viewer` is `pbr-viewer`."""

from __future__ import annotations

import os
import sys

from .base.signals import Stopped, stoppable

# A pool of BLAS threads costs each start 50 ms and more of processor time, and the one bake that multiplies matrices
# gains little by it. numpy reads this once, so it must be said before anything imports it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def main() -> None:
    """`cli.main`, with Ctrl-C answered from the first import on."""
    try:
        with stoppable():  # no KeyboardInterrupt: after one in code that is made of text, Python ends by the signal
            from .cli import main as run

            run()
    except Stopped as stopped:
        print(f"pbr-viewer: {stopped}", file=sys.stderr)
        sys.exit(stopped.exit_status)


if __name__ == "__main__":
    main()
