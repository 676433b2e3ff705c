"""The viewpoints of the gallery: chosen from the map and its traffic, the same ones every time."""

import math
from dataclasses import replace

from eyas.modes.gallery.distant import along, horizon, overview
from eyas.modes.gallery.places import STOPS, beside_most, on_open_roads
from eyas.modes.gallery.still import StillScene, Viewpoint
from eyas.modes.gallery.stops import POSES, all_cars, stop

__all__ = ["choose_viewpoints"]

_PLAIN = 2.0
"""Contrast of a distant view in which haze or fog leaves nothing to see [sRGB levels]."""


def choose_viewpoints(still: StillScene, sun: tuple[float, float, float]) -> list[Viewpoint]:
    """Return the viewpoints of a map, without those for which it has no suitable place.

    Args:
        still: The world.
        sun: Direction to the sun; distant views have it behind the camera, so that walls are lit.
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
    side = math.atan2(sun[1], sun[0]) + math.radians(15.0)
    far = horizon(still.scene, side)
    chosen.append(overview(still, side, cars))
    if still.contrast(far) > _PLAIN:
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
