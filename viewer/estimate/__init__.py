"""What both renderers give together: the error of a raster picture, and the best mixture of raster and paths."""
