"""A reader of glTF 2.0 that uses only json and numpy."""
