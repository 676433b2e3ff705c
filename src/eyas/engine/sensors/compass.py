"""The compass: the field of the earth, which it measures along the axes of the body."""

from eyas.engine.core.frames import rotate_back
from eyas.engine.sensors.sensor import Floats, Sensor
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.lanes import kernel


@kernel(inline=True)
def _read(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    east, north, up = settings[0], settings[1], settings[2]
    orientation = snapshot.trackers.orientation[n]
    reading[0], reading[1], reading[2] = rotate_back(orientation, east, north, up)


COMPASS = Sensor(
    name="compass",
    unit="gauss",
    parts={"magnetic_field": tuple(f"magnetic_field_{axis}" for axis in "xyz")},
    read=_read,
    noise=0.0012,
    settings={"east": 0.0106, "north": 0.2145, "up": -0.4297},  # about Zurich
)
