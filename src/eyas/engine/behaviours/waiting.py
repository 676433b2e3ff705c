"""Where people stand and wait: at bus stops, and beside the tables of cafes."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import Poses
from eyas.engine.behaviours.timetable import TimedMotion
from eyas.engine.core.errors import SpawnError
from eyas.engine.state.scene import Scene
from eyas.lanes import exact

_SPOTS: Final = {
    "shelter": ((-1.2, 0.15), (-0.3, 0.3), (0.6, 0.2), (1.35, 0.35), (2.5, 0.2)),
    "bus stop": ((0.7, -0.15), (1.4, -0.3), (-0.8, -0.25)),
    "cafe table": ((0.1, 1.25),),
}
"""Where one stands at things whose names begin so: left of its middle and towards the road [m]."""

_TURNED: Final = 0.6  # How far one looks aside from the road, or from the table, at most [rad]

Floats = NDArray[np.float64]


class Spot(NamedTuple):
    """Where somebody stands."""

    x: float  # East [m]
    y: float  # North [m]
    yaw: float  # [rad]

    def stand(self, time: Floats) -> TimedMotion:
        """Return the motion at times, of which there is none."""
        still = np.zeros(len(time))
        return TimedMotion(
            Poses(still + self.x, still + self.y, still + self.yaw), still, still, still
        )


def waiting_spots(
    scene: Scene,  # The map
    count: int,  # How many
    rng: np.random.Generator,  # Random numbers
    setting: str = "extras",  # What a message names
) -> list[Spot]:
    """Return so many places to wait at, no two of them the same.

    Raises:
        SpawnError: There are fewer.
    """
    fixtures, found = scene.fixtures, list[Spot]()
    for number, pose in zip(fixtures.prototype.tolist(), fixtures.pose, strict=True):
        name = fixtures.names[number] if fixtures.names else ""
        own = next((spots for start, spots in _SPOTS.items() if name.startswith(start)), ())
        ahead = np.array([pose[0, 1], pose[1, 1]], np.float64)
        aside = np.array([pose[0, 0], pose[1, 0]], np.float64)
        facing = float(exact.atan2(ahead[1], ahead[0]))
        for left, onwards in own:
            place = pose[:2, 3].astype(np.float64) + left * aside + onwards * ahead
            turn = facing + (np.pi if name.startswith("cafe") else 0.0)
            found.append(Spot(float(place[0]), float(place[1]), turn))
    if len(found) < count:
        raise SpawnError(
            f"{setting}: 'wait': '{scene.name}' has {len(found)} places at bus stops and cafes, "
            f"not {count}; allowed: fewer, or another behaviour"
        )
    chosen = rng.choice(len(found), count, replace=False).tolist()
    looks = rng.uniform(-_TURNED, _TURNED, count).tolist()
    return [
        found[k]._replace(yaw=found[k].yaw + aside) for k, aside in zip(chosen, looks, strict=True)
    ]
