"""The drone's views of cars: which cars there are, and the views of the best of them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.modes.gallery.solids import is_inside
from eyas.modes.gallery.still import StillScene, Viewpoint
from eyas.targets.vehicles.vehicle import VEHICLE_AHEAD
from eyas.task.spawn import Start, start_pose

__all__ = ["CAMERA", "POSES", "Cars", "all_cars", "drone_view", "stop"]

CAMERA = 0.7854
"""Horizontal field of view of the drone's camera [rad]."""
POSES = ((22.0, 1.37, "down"), (15.0, 0.6, "ahead"))
"""Height [m], pitch [rad] and name of the drone's starts."""

_TIMES = (60.0, 20.0)
"""First time at which cars are looked for, and the step to the next [s]."""
_TRIES = 40
"""Number of cars tried for each stop."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cars:
    """K cars, each at one time."""

    time: Points
    """[s], shape (K,)."""
    actor: NDArray[np.int64]
    """Shape (K,)."""
    position: Points
    """[m], shape (K, 2)."""
    yaw: Points
    """[rad], shape (K,)."""


def all_cars(still: StillScene) -> Cars:
    """Return every car that is on the map at one of the times."""
    rows: list[tuple[float, int, float, float, float]] = []
    for time in np.arange(_TIMES[0], still.duration, _TIMES[1]):
        actors = still.actors(time)
        for actor in np.flatnonzero(actors.present[0]):
            x, y, _ = actors.position[0, actor]
            rows.append((time, int(actor), x, y, actors.yaw[0, actor]))
    table = np.array(rows, np.float64).reshape(-1, 5)
    return Cars(table[:, 0], table[:, 1].astype(np.int64), table[:, 2:4], table[:, 4])


def stop(
    still: StillScene, cars: Cars, name: str, where: str, score: Points
) -> Iterator[Viewpoint]:
    """Yield the drone's views at its starts, of the best car that is visible in all of them."""
    order = np.argsort(-score, kind="stable")[:_TRIES]
    for car in order[score[order] > 0]:
        views = [drone_view(cars, int(car), name, where, pose) for pose in POSES]
        if all(_in_sight(still, view) for view in views):
            yield from views
            return


def _in_sight(still: StillScene, view: Viewpoint) -> bool:
    depth, seen = still.probe(view)
    near = is_inside(still.scene.colliders, view.position) or float(depth.min()) < 4.0
    return seen > 0.7 and not near


def drone_view(
    cars: Cars, car: int, name: str, where: str, pose: tuple[float, float, str]
) -> Viewpoint:
    """Return the view of a car by a drone at one of its starts."""
    height, pitch, kind = pose
    start, spot = Start(pitch, height, 0.0, 0.0, 0.0), [*cars.position[car], 0.0]
    position, yaw = start_pose(start, spot, float(cars.yaw[car]), VEHICLE_AHEAD)
    time = float(cars.time[car])
    return Viewpoint(
        name=f"{name}-{kind}",
        title=f"Drone, {height:g} m, {where}",
        caption=f"As the drone sees it: {height:g} m high, camera {pitch:g} rad down, at "
        f"{time:g} s of the traffic; in the middle a car {where}.",
        time=time,
        position=(float(position[0]), float(position[1]), float(position[2])),
        yaw=yaw,
        pitch=pitch,
        field_of_view=CAMERA,
        actor=int(cars.actor[car]),
    )
