"""What both renderers say together: how wrong a picture of the raster is, measured by paths."""
