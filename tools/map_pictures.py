"""Draw the pictures of maps in docs/images: each by day, at night, in fog and in snow.

python tools/map_pictures.py               # all
python tools/map_pictures.py lake village  # these
"""

import argparse
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image
from weather_sheet import rotation

from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig

SIZE, GAP, TIME = (480, 640), 8, 300.0
IMAGES = Path(__file__).parents[1] / "docs" / "images"


class Place(NamedTuple):
    """Where a picture is taken: above and behind a vehicle."""

    vehicle: int
    height: float
    """Of the camera above it [m]."""
    pitch: float
    """Downwards [rad]."""
    turn: float
    """From the vehicle's heading, counter-clockwise [rad]."""
    weathers: tuple[str, ...] = ("day", "night", "foggy", "snow")


PLACES = {
    "citystreet": Place(12, 30.0, 0.38, 0.0),
    "downtown": Place(4, 14.0, 0.33, 0.0),
    "lake": Place(7, 30.0, 0.38, 0.9),
    "village": Place(12, 30.0, 0.38, 0.9, ("day", "foggy", "night", "snow")),
    "desert": Place(12, 14.0, 0.35, 0.9, ("day", "foggy", "night", "snow")),
    "farmland": Place(6, 30.0, 0.38, 0.9),
}


def taken(name: str, weather: str, place: Place) -> Image.Image:
    """Return a picture of a map."""
    world = StillWorld(load_assets(WorldConfig(map=name, weather=weather), TrafficConfig()))
    actors = world.actors(TIME)
    here = np.flatnonzero(actors.present[0])
    vehicle = here[place.vehicle % len(here)]
    yaw = float(actors.yaw[0, vehicle]) + place.turn
    back = place.height / math.tan(place.pitch)
    away = np.array([-back * math.cos(yaw), -back * math.sin(yaw), place.height])
    views = Views(
        position=(actors.position[0, vehicle] + away)[None],
        rotation=rotation(yaw, place.pitch)[None],
        world=np.zeros(1, np.int32),
        subject=np.full(1, -1, np.int32),
        field_of_view=1.05,
        instant=np.array([12.0]),
    )
    picture = Picture.create(1, *SIZE)
    world.draw(views, TIME, picture, 4)
    return Image.fromarray(picture.rgb[0])


def main() -> None:
    """Draw the maps that are named."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("maps", nargs="*", choices=[*PLACES, []], help="all by default")
    for name in parser.parse_args().maps or PLACES:
        rows, columns = SIZE
        sheet = Image.new("RGB", (2 * columns + GAP, 2 * rows + GAP), "white")
        for k, weather in enumerate(PLACES[name].weathers):
            at = (k % 2) * (columns + GAP), (k // 2) * (rows + GAP)
            sheet.paste(taken(name, weather, PLACES[name]), at)
        sheet.save(IMAGES / f"{name}.jpg", quality=85)


if __name__ == "__main__":
    main()
