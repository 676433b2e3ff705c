"""Targets of a user's own: a mesh file, a class, or a recorded trajectory."""
