"""The plan of a picture: the shader programs, maps and passes that a scene needs, and what is left out."""
