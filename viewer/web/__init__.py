"""Models in a browser: pages of pictures, and views that are drawn here and shown there."""
