"""From radiance to a file or a screen."""
