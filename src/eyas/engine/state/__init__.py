"""Records of arrays that the rooms share; no behaviour.

May import: `core`, `lanes`.
Begin with `snapshot.py`. Private: `eyas` offers what is public.
"""
