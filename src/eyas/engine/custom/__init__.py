"""Targets of a user's own: a mesh file, a class, or a recorded trajectory.

May import: `behaviours` and all rooms below.
Begin with `config.py`. Private: `eyas` offers what is public.
"""
