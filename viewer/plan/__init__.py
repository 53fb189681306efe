"""What of a scene is needed to show it: programs, maps and passes, and what was left out."""
