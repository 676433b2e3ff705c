"""Interfaces of the simulation for learning libraries: they translate, and compute nothing.

May import: `settings` and all rooms below.
Begin with `tracking_env.py`, then `batch.py`. Private: `eyas` offers what is public.
"""
