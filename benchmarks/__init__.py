"""How fast and how lean the viewer is, beside other programs that draw the same picture: `python -m benchmarks`."""
