"""Cameras: what a lens, a sensor, a shutter and a link make of what the renderer draws.

May import: `trackers` and all rooms below.
Begin with `config.py`, then `development.py`. Private: `eyas` offers what is public.
"""
