"""All settings of a run: their root, and how they are read, written and checked.

May import: `exports`, `wire` and all rooms below, and `config` of modes, envs, learning.
Begin with `config.py`. Private: `eyas` offers what is public.
"""
