"""Draw docs/images/weathers.jpg: every map in every weather, a row for each map.

python tools/weather_sheet.py              # all maps; about 20 minutes
python tools/weather_sheet.py lake desert  # these anew; the other rows as they were drawn
"""

import argparse
import math
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import WEATHERS

SIZE = (126, 168)
HEIGHT, PITCH, TIME = 17.0, 0.42, 300.0
"""Of the camera behind a car: height [m], pitch down [rad], time of the traffic [s]."""
LABEL = 14


def rotation(yaw: float, pitch: float) -> np.ndarray:
    """Return camera to world: columns forward, left, up."""
    level = math.cos(pitch)
    forward = [math.cos(yaw) * level, math.sin(yaw) * level, -math.sin(pitch)]
    left = [-math.sin(yaw), math.cos(yaw), 0.0]
    return np.stack([forward, left, np.cross(forward, left)], axis=1)


def tile(map_name: str, weather: str) -> np.ndarray:
    """Return the view behind the car that has most room above it, the same in all weathers."""
    assets = load_assets(WorldConfig(map=map_name, weather=weather), TrafficConfig())
    world = StillWorld(assets)
    actors = world.actors(TIME)
    place, heading = actors.position[0], actors.yaw[0]
    solids = assets.scene.fixtures.pose[:, :2, 3]
    here = np.flatnonzero(actors.present[0])
    back = HEIGHT / math.tan(PITCH)
    eyes = [place[a, :2] - back * np.array([math.cos(heading[a]), math.sin(heading[a])])
            for a in here]  # fmt: skip
    free = [np.hypot(*(solids - eye).T).min(initial=60.0) for eye in eyes]
    best = int(np.argmax(np.minimum(free, 18.0)))
    views = Views(
        position=np.array([[*eyes[best], HEIGHT]]),
        rotation=rotation(float(heading[here[best]]), PITCH)[None],
        world=np.zeros(1, np.int32),
        subject=np.full(1, -1, np.int32),
        field_of_view=1.05,
        instant=np.array([12.0]),
    )
    picture = Picture.create(1, *SIZE)
    world.draw(views, TIME, picture, 4)
    return picture.rgb[0]


def row(map_name: str) -> Image.Image:
    """Return the pictures of a map side by side, weathers that it lacks left black."""
    recipe, names = MAPS.get(map_name), WEATHERS.names()
    made = Image.new("RGB", (SIZE[1] * len(names), SIZE[0] + LABEL), "white")
    pen = ImageDraw.Draw(made)
    for column, weather in enumerate(names):
        pen.text((column * SIZE[1] + 3, 1), f"{map_name} {weather}", fill="black")
        if weather in recipe.weathers:
            shown = Image.fromarray(tile(map_name, weather))
            made.paste(shown, (column * SIZE[1], LABEL))
    return made


def main() -> None:
    """Draw the rows of the named maps, or of all, and join all that are there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="*", help="maps to draw; none: all")
    parser.add_argument("--rows", type=Path, default=Path("build/weathers"), help="their rows")
    parser.add_argument("--out", type=Path, default=Path("docs/images/weathers.jpg"))
    asked = parser.parse_args()
    asked.rows.mkdir(parents=True, exist_ok=True)
    for name in asked.maps or MAPS.built_in:
        row(name).save(asked.rows / f"{name}.png")
        print(name, flush=True)
    kept = [asked.rows / f"{name}.png" for name in MAPS.built_in]
    rows = [Image.open(path) for path in kept if path.is_file()]
    sheet = Image.new("RGB", (rows[0].width, sum(one.height for one in rows)))
    top = 0
    for one in rows:
        sheet.paste(one, (0, top))
        top += one.height
    sheet.save(asked.out, quality=82, optimize=True)


if __name__ == "__main__":
    main()
