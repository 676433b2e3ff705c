"""The barometer: the pressure of the air, which falls with the height."""

from eyas.engine.sensors.sensor import Floats, Sensor
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.lanes import kernel


@kernel
def pressure(altitude: float) -> float:
    """Return the pressure of the International Standard Atmosphere, 1013.25 (1 - 2.25577e-5
    altitude)^5.25588, by the first five terms of its series [hPa]: good to 0.02 up to 2,000 m.
    """
    total = term = 1013.25
    for order in range(4):
        term *= -2.25577e-5 * altitude * (5.25588 - order) / (order + 1)
        total += term
    return total


@kernel(inline=True)
def _read(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    reading[0] = pressure(settings[0] + snapshot.trackers.position[n, 2])


BAROMETER = Sensor(
    name="barometer",
    unit="hPa",
    parts={"pressure": ("pressure",)},
    read=_read,
    noise=0.012,
    settings={"altitude": 0.0},  # of the origin of the world above mean sea level [m]
)
