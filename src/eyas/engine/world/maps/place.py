"""Where maps lie on the earth."""

from eyas.engine.world.maps.files import MAP_FILE, origin_of
from eyas.engine.world.maps.recipe import MapRecipe
from eyas.maps.osm.projection import Projection

__all__ = ["projection_of"]


def projection_of(recipe: MapRecipe) -> Projection | None:
    """Return where a map lies; None of those that lie nowhere, all but imported ones.

    Raises:
        DataFileError: The files of an imported map are damaged.
    """
    home = recipe.home
    if home is None or not (home / MAP_FILE).is_file():
        return None
    origin = origin_of(home)
    return Projection(origin.longitude, origin.latitude)
