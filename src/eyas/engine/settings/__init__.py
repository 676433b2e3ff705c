"""All settings of a run: their root, and how they are read, written and checked.

May import: `exports` and all rooms below.
Begin with `config.py`. Private: `eyas` offers what is public.
"""
