"""What of a material counts, and how shaders get it."""
