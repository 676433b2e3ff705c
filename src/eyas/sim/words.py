"""The target in words that tell it from what else is in view."""

import numpy as np

from eyas.core import exact
from eyas.core.pinhole import project
from eyas.sim.simulation import Simulation
from eyas.targets.catalogue import MODELS
from eyas.targets.telling import Seen, told_apart

__all__ = ["target_in_words"]


def target_in_words(simulation: Simulation, tracker: int, aspect: float) -> str:
    """Return a description of a tracker's target as its camera shows it, such as "a red SUV".

    No other actor in the camera's view shares it, hidden or not.

    Args:
        simulation: The simulation.
        tracker: The tracker.
        aspect: Height of the camera's picture over its width.
    """
    sight = simulation.perception.sight
    cameras, target = sight.shown.cameras, int(sight.shown.targets.actor[tracker])
    actors, _ = simulation.actors_around(tracker, ago=sight.age_of(tracker))
    (model,), (colour,) = simulation.looks_around(tracker)
    pose = cameras.position[tracker], cameras.rotation[tracker]
    with np.errstate(invalid="ignore"):
        column, row, depth = project(
            actors.position[0], *pose, 1, 1, float(cameras.field_of_view[tracker])
        )
        # The picture is a unit wide, and its middle at (0.5, 0.5). Half a body may be in it.
        half = np.array([0.25 * max(MODELS[one].size) for one in model.tolist()])
        reach = half / (depth * exact.tan(0.5 * float(cameras.field_of_view[tracker])))
        inside = (np.abs(column - 0.5) < 0.5 + reach) & (depth > 0.0)
        inside &= np.abs(row - 0.5) < 0.5 * aspect + reach
    inside &= actors.present[0]
    inside[target] = False

    def seen(actor: int) -> Seen:
        return Seen(
            model=int(model[actor]),
            colour=colour[actor].tolist(),
            speed=float(actors.speed[0, actor]),
            yaw_rate=float(actors.yaw_rate[0, actor]),
            column=float(column[actor]),
            distance=float(depth[actor]),
        )

    return told_apart(seen(target), [seen(actor) for actor in np.flatnonzero(inside).tolist()])
