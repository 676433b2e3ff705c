"""Draw docs/images/lamps.jpg: a car that brakes and turns, and a crossing with working signals.

python tools/lamps_sheet.py docs/images
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from eyas.engine.render.kernels.surface.signalling import BRAKING, LEFT
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import Lamp
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.lamps import shining
from eyas.engine.world.config import WorldConfig
from eyas.lanes import interpreted

SIZE, LABEL = (240, 320), 14
GREEN_AT, RED_AT = 100.0, 130.0
"""Times at which a light shows green and red [s]."""

_shining = interpreted(shining)

Floats = NDArray[np.float64]


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="folder to write to")
    rows = [car(weather) + crossing(weather) for weather in ("day", "night")]
    sheet = np.concatenate([np.concatenate([titled(*one) for one in row], 1) for row in rows])
    Image.fromarray(sheet).save(parser.parse_args().folder / "lamps.jpg", quality=88)


def world(weather: str, **traffic: str) -> StillWorld:
    """Return citystreet with some traffic."""
    settings = TrafficConfig.model_validate(traffic)
    return StillWorld(load_assets(WorldConfig(weather=weather), settings))


def car(weather: str) -> list[tuple[str, Floats]]:
    """Return a car that brakes before it turns left, without and with its lamps."""
    dark, working = world(weather), world(weather, lamps="working")
    motion = working.assets.traffic.motion
    row, actor = np.argwhere(motion.lamps == Lamp.BRAKE | Lamp.LEFT)[2000].tolist()
    times = (row / motion.rate + 0.02 * np.arange(50)).tolist()
    time = next(one for one in times if _shining(motion, actor, one) == BRAKING | LEFT)
    state = working.actors(time)
    heading, place = float(state.yaw[0, actor]), state.position[0, actor]
    eye = place + np.array([-8.0 * np.cos(heading), -8.0 * np.sin(heading), 3.6])
    aim = place + np.array([0.0, 0.0, 0.7])
    return [
        (f"{weather}, traffic.lamps=dark", look(dark, eye, aim, time)),
        ("working", look(working, eye, aim, time)),
    ]


def crossing(weather: str) -> list[tuple[str, Floats]]:
    """Return a crossing at green and at red."""
    town = world(weather, signals="working", lamps="working")
    assert town.assets.signals is not None
    poles = town.assets.signals.pose
    cars = town.actors(RED_AT).position[0, :, :2]
    near = [(np.linalg.norm(cars - pole[:2, 3], axis=1) < 35.0).sum() for pole in poles]
    pole = poles[int(np.argmax(near))].astype(np.float64)
    arm, front, foot = pole[:, 0], pole[:, 1], pole[:, 3]
    eye, aim = foot + 24.0 * front + 3.0 * arm, foot + 3.0 * arm
    eye[2], aim[2] = 7.5, 2.5
    told = ((GREEN_AT, "traffic.signals=working, green"), (RED_AT, "red"))
    return [(name, look(town, eye, aim, time)) for time, name in told]


def look(town: StillWorld, eye: Floats, aim: Floats, time: float) -> Floats:
    """Return a picture of a place from another at a time [s]."""
    ahead = (aim - eye) / np.linalg.norm(aim - eye)
    left = np.cross([0.0, 0.0, 1.0], ahead)
    left /= np.linalg.norm(left)
    axes = np.stack([ahead, left, np.cross(ahead, left)], axis=-1)
    one = np.zeros(1, np.int32)
    picture = Picture.create(1, *SIZE)
    town.draw(Views(eye[None], axes[None], one, one - 1, 1.0), time, picture, 4)
    assert picture.rgb is not None
    return picture.rgb[0]


def titled(name: str, pixels: Floats) -> Floats:
    """Return a picture with its name above it."""
    label = Image.new("RGB", (SIZE[1], LABEL), "white")
    ImageDraw.Draw(label).text((3, 1), name, fill="black")
    return np.concatenate([np.asarray(label), pixels])


if __name__ == "__main__":
    main()
