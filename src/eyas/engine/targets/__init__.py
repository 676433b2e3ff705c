"""The catalogue of what can be followed: kinds and models, shapes, sizes, colours, words.

May import: `traffic` and all rooms below.
Begin with `catalogue.py`. Private: `eyas` offers what is public.
"""
