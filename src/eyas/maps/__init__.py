"""The makers of maps: seven maps, plans in files, OpenStreetMap, and maps for other programs.

May import: `eyas.engine`, `eyas.lanes`.
Begin with `README.md`, then `citystreet/plan.py` and `plan/plan.py`.
"""
