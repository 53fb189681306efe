"""What both renderers say together: how wrong a picture of the raster is, and the best mixture of both."""
