"""The approximations of the renderer: error and cost of every way to compute each of them."""
