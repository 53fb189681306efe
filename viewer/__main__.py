"""`python -m viewer` is `pbr-viewer`."""

from __future__ import annotations

import sys


def main() -> None:
    """`cli.main`, with Ctrl-C answered from the first import on."""
    try:
        from .cli import main as run

        run()
    except KeyboardInterrupt:
        print("pbr-viewer: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
