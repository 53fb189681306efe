"""Models in a browser: pages of pictures."""
