"""Data sets from recipes, exports in the formats of others, and box trackers scored on them.

May import: `benchmark`, `engine`, `lanes`.
Begin with `README.md`, then `recipe.py`, `plan.py` and `making/make.py`.
"""
