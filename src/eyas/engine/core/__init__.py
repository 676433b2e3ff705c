"""Foundations: errors, settings, registry, random streams, frames, files, the cache.

May import: `lanes`.
Begin with `errors.py`, then `config.py`. Private: `eyas` offers what is public.
"""
