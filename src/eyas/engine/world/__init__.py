"""The static world: maps, roads, buildings, plants, land, weather, and files of OpenStreetMap.

May import: `mesh`, `state`, `core`, `lanes`.
Begin with `maps/recipe.py` and `plan/plan.py`. Private: `eyas` offers what is public.
"""
