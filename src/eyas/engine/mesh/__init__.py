"""The mesh kit: solids, flat faces, walls, rounded panels, moving and joining.

May import: `state`, `core`, `lanes`.
Begin with `shell.py`. Private: `eyas` offers what is public.
"""
