"""Places of maps on the earth."""

from eyas.engine.world.maps.recipe import MapRecipe
from eyas.engine.world.projection import Projection


def projection_of(recipe: MapRecipe) -> Projection | None:
    """Return where a map lies; None of those that lie nowhere, all but imported ones."""
    return None if recipe.origin is None else Projection(*recipe.origin)
