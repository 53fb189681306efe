"""Error against run time: a model by every method on the ladder, from the cheapest to the reference."""
