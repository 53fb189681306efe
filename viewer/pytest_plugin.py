"""The pytest plugin: see `golden` and `gl`."""
