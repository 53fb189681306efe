"""Choosing how to make a picture, by the time there is for it or the error it may have."""
