"""A sensor of your own, added without changes to Eyas: a magnetometer beside a magnet.

    PYTHONPATH=examples python examples/own_sensor.py
    PYTHONPATH=examples eyas video --set 'sensors.further=["own_sensor:MAGNETOMETER"]'

A sensor that Python can import needs no registration: `sensors.further` takes its path. To give it
a short name, define an entry point in the group `eyas.sensors` (wherever the package is installed).
Its errors are settings: noise, bias, rate, delay, drop-out. It is then in `info`, in labels and
`sensors.csv`, a part of observations by its name, and, since its unit is gauss, in bags of ROS
(`/magnetometer`) and MAVLink's `HIGHRES_IMU`.
"""

import gymnasium
import numpy as np
from numpy.typing import NDArray

import eyas  # noqa: F401  # registers the environments
from eyas import Sensor, Snapshot, Terrain, kernel, rotate_back

FIELD = (0.0106, 0.2145, -0.4297)
"""Of the earth about Zurich: east, north, up [gauss]."""

Floats = NDArray[np.float64]


@kernel(inline=True)
def read(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    """Write the field that tracker `n` reads along its axes, and that of the magnet on its left."""
    x, y, z = rotate_back(snapshot.trackers.orientation[n], FIELD[0], FIELD[1], FIELD[2])
    reading[0], reading[1], reading[2] = x, y + settings[0], z


MAGNETOMETER = Sensor(
    name="magnetometer",
    unit="gauss",
    parts={"field": ("field_forward", "field_left", "field_up")},
    read=read,
    noise=0.002,
    settings={"magnet": 0.05},  # [gauss]
)


def main() -> None:
    """Turn for a second, and read the magnetometer."""
    magnetometer = {
        "sensor": "own_sensor:MAGNETOMETER",
        "rate": 50.0,
        "noise": 0.002,
        "settings": {"magnet": 0.1},
    }
    env = gymnasium.make(
        "eyas/citystreet-day-v0",
        config={
            "sensors": {"further": [magnetometer, "barometer"]},
            "env": {"observation": {"parts": ["image", "magnetometer"]}},
        },
    )
    observation, info = env.reset(seed=1)
    for _ in range(125):
        observation, _, ended, cut, info = env.step(4)  # turn to the left
        if ended or cut:
            break
    print("observed", observation["magnetometer"].round(3), "[gauss]")
    print("in info", info["field"].round(3), info["pressure"].round(2), "[hPa]")


if __name__ == "__main__":
    main()
