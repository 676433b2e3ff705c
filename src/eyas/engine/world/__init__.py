"""The static world: recipes of maps, roads, signals, weather. The makers of maps
are in the house `maps`.

May import: `mesh` and all rooms below.
Begin with `maps/recipe.py`, then `weather.py`, `roads/areas.py`.
"""
