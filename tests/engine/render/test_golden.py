"""Small pictures of all maps, compared with ones that a person has looked at.

They show what closed-form tests cannot: that a map looks as it did. After a change that is
meant to show, look at the new pictures and keep them with `pytest
tests/engine/render/test_golden.py --regenerate`.
"""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.weather import WEATHERS

FOLDER = Path(__file__).parent / "golden"
SIZE = (120, 160)

# Mean difference, and share of pixels that may differ by more than 24 of 255: room for another
# processor's last bits at edges, not for another picture.
MEAN, SHARE = 1.0, 0.01

VIEWS = {
    # position, heading [rad], pitch down [rad], time of the traffic [s]
    "down": (None, 0.0, 1.37, 100.0),
    "ahead": (None, 0.0, 0.6, 300.0),
    "overview": ((0.0, -420.0, 130.0), 1.57, 0.35, 500.0),
}

NO_SHADOWS = ("overcast", "dust")
MAPS = ("desert", "downtown", "farmland", "lake", "simpleway-grass", "village")


def look(yaw: float, pitch: float) -> np.ndarray:
    """Return camera to world: columns forward, left, up."""
    forward = [np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)]
    left = [-np.sin(yaw), np.cos(yaw), 0.0]
    return np.stack([forward, left, np.cross(forward, left)], axis=1)


def drawn(map_name: str, weather: str, name: str) -> np.ndarray:
    position, yaw, pitch, time = VIEWS[name]
    world = StillWorld(load_assets(WorldConfig(map=map_name, weather=weather), TrafficConfig()))
    actors = world.actors(time)
    if position is None:  # behind and above the first car
        yaw = float(actors.yaw[0, 0])
        back = 22.0 / np.tan(pitch)
        behind = actors.position[0, 0, :2] - back * np.array([np.cos(yaw), np.sin(yaw)])
        position = (*behind, 22.0)
    views = Views(
        position=np.array([position]),
        rotation=look(yaw, pitch)[None],
        world=np.zeros(1, np.int32),
        subject=np.full(1, -1, np.int32),
        field_of_view=0.7854,
    )
    picture = Picture.create(1, *SIZE)
    if weather in FALLING:
        views.instant = np.array([time])
    world.draw(views, time, picture)
    return picture.rgb[0]


FALLING = ("rain", "autumn")
"""Weathers of which what falls is shown, too."""

PICTURES = {
    **{name: ("citystreet", "day", name) for name in VIEWS},
    **{
        f"{weather}-{name}": ("citystreet", weather, name)
        for weather in WEATHERS.built_in
        for name in ("ahead", "overview")
        if weather not in ("day", *NO_SHADOWS)
    },
    **{f"{name}-ahead": (name, "day", "ahead") for name in MAPS},
    **{f"{weather}-overview": ("citystreet", weather, "overview") for weather in NO_SHADOWS},
    **{f"lake-{weather}-overview": ("lake", weather, "overview") for weather in ("autumn", "dusk")},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", PICTURES)
def test_it_looks_as_it_did(name, regenerate, tmp_path):
    path = FOLDER / f"{name}.png"
    now = drawn(*PICTURES[name])
    if regenerate:
        Image.fromarray(now).save(path, optimize=True)
    with Image.open(path) as picture:
        then = np.asarray(picture)
    difference = np.abs(now.astype(int) - then).max(axis=2)
    if difference.mean() > MEAN or (difference > 24).mean() > SHARE:
        shown = np.concatenate([then, now, np.repeat(difference[..., None], 3, 2)], axis=1)
        Image.fromarray(shown.astype(np.uint8)).save(tmp_path / f"{name}.png")
        pytest.fail(f"then, now and difference are in {tmp_path / f'{name}.png'}")
