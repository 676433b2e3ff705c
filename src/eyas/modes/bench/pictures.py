"""Pictures of `eyas bench`: sizes, weathers, samples, and the whole city at once."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from eyas.modes.bench.measurement import Measurement, of_pictures
from eyas.sensors.config import CameraConfig
from eyas.sim.assets import load_assets
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.still import StillWorld
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture, Views
from eyas.world.config import WorldConfig

__all__ = ["BY_DAY", "OTHER_WEATHERS", "Pictures", "measure_horizon", "measure_pictures"]


@dataclass(frozen=True, slots=True)
class Pictures:
    """What to draw at once."""

    views: int
    width: int
    height: int
    weather: str = "day"
    samples: Literal[1, 4] = 1

    @property
    def name(self) -> str:
        """Name of the measurement."""
        name = f"pictures {self.width}x{self.height}, {self.views} view{'s' * (self.views > 1)}"
        name += f", {self.weather}" * (self.weather != "day")
        return name + f", {self.samples} samples" * (self.samples > 1)


BY_DAY = (
    Pictures(1, 84, 84),
    Pictures(64, 48, 48),
    Pictures(64, 84, 84),
    Pictures(64, 84, 84, samples=4),
    Pictures(1, 640, 480),
    Pictures(1, 1280, 720),
)
OTHER_WEATHERS = (Pictures(64, 84, 84, weather="night"), Pictures(64, 84, 84, weather="snow"))


def measure_pictures(pictures: Pictures, seconds: float) -> Measurement:
    """Return the measurement of drawing pictures.

    Args:
        pictures: What to draw.
        seconds: Time to measure [s].
    """
    config = SimConfig(
        camera=CameraConfig(samples=pictures.samples), world=WorldConfig(weather=pictures.weather)
    )
    simulation = build_simulation(config, each_alone(pictures.views))
    simulation.reset()
    picture = Picture.create(pictures.views, pictures.height, pictures.width)
    trackers = np.arange(pictures.views, dtype=np.int32)
    includes = "traffic of each world, posing, culling, shading with shadows, RGB"
    size = pictures.views, pictures.width, pictures.height
    return of_pictures(
        pictures.name, includes, lambda: simulation.draw(trackers, picture), size, seconds
    )


def measure_horizon(seconds: float) -> Measurement:
    """Return the measurement of views from a ring outside the city, which show all of it."""
    assets = load_assets(SimConfig().world, SimConfig().traffic, 1)
    count, pitch, field_of_view = 64, 0.3, 1.2
    points = assets.scene.network.lane_points
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    away = np.linalg.norm(points - centre, axis=1).max() / math.sin(0.5 * field_of_view)
    turn = np.arange(count) * (math.tau / count)
    out = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    level = np.stack([-out[:, 0], -out[:, 1], np.zeros(count)], axis=1)
    forward = math.cos(pitch) * level - math.sin(pitch) * np.array([0.0, 0.0, 1.0])
    left = np.cross([0.0, 0.0, 1.0], level)
    views = Views(
        position=np.column_stack([centre + away * out, np.full(count, away * math.tan(pitch))]),
        rotation=np.stack([forward, left, np.cross(forward, left)], axis=2),
        world=np.zeros(count, np.int32),
        subject=np.full(count, -1, np.int32),
        field_of_view=field_of_view,
    )
    movers = StillWorld(assets).movers(300.0)
    picture = Picture.create(count, 84, 84)
    includes = f"all of the city from {away:.0f} m, pitch {pitch}: drawing alone"
    name = "pictures 84x84, 64 views, horizon"

    def draw() -> None:
        assets.renderer.draw(views, movers, picture)

    return of_pictures(name, includes, draw, (count, 84, 84), seconds)
