"""Recordings and data sets: read, exported in the formats of other tools, planned, described.

May import: `settings`, `exports` and all rooms below.
Begin with `recording.py`, then `format.py` and `export.py`. Private: `eyas` offers what is public.
"""
