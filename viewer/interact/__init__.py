"""What any interactive view needs, whatever its toolkit: orbit, state, picture, convergence, picking, keys."""
