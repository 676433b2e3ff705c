"""The viewpoints of the gallery: chosen from the map and its traffic, the same ones every time."""

import math
from dataclasses import replace

from eyas.modes.gallery.distant import along, horizon, overview, streets
from eyas.modes.gallery.places import STOPS, beside_most, on_open_roads
from eyas.modes.gallery.still import StillScene, Viewpoint
from eyas.modes.gallery.stops import POSES, all_cars, stop
from eyas.state.lighting import Lighting

__all__ = ["choose_viewpoints"]

_VEILED = 0.05
"""Share of the light of distant things below which fog leaves nothing to see."""


def choose_viewpoints(still: StillScene, light: Lighting) -> list[Viewpoint]:
    """Return the viewpoints of a map, without those for which it has no suitable place.

    Args:
        still: The world.
        light: Its light: distant views have the sun behind the camera, so that walls are lit, and
            what fog would hide altogether is left out.
    """
    cars = all_cars(still)
    chosen: list[Viewpoint] = []
    for name, where, score in STOPS:
        chosen += stop(still, cars, name, where, score(still.scene, cars))
        if name == "span" and chosen and chosen[-1].name == "span-ahead":
            chosen += along(still, chosen[-1])
    if len(chosen) < 2 * len(POSES):
        chosen += stop(still, cars, "road", "on an open road", on_open_roads(still.scene, cars))
    sights = stop(still, cars, "sights", "where much stands around", beside_most(still, cars))
    chosen += [view for view in sights if view.position not in {one.position for one in chosen}]
    side = math.atan2(light.sun_direction[1], light.sun_direction[0]) + math.radians(15.0)
    far = horizon(still.scene, side)
    chosen.append(overview(still, side, cars))
    away = math.dist(far.position[:2], streets(still.scene)[0])
    if math.exp(-((light.fog_density * away) ** light.fog_power)) > _VEILED:
        chosen.append(far)
    first = chosen[0]
    small = replace(
        first,
        name="observation",
        title="84 x 84 pixels, enlarged",
        caption=f"{first.caption} As the 84 x 84 observation: 4:3 squeezed into a square, one "
        "sample a pixel, each pixel shown as 4 x 4.",
        size=(84, 84),
        samples=1,
        enlarged=4,
    )
    return [*chosen, small]
