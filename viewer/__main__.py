"""`python -m viewer` is `pbr-viewer`."""

from .cli import main

main()
