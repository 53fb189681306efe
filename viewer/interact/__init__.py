"""The parts of an interactive view that do not depend on a GUI toolkit: camera, state, picture, picking, keys."""
