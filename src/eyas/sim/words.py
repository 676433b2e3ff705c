"""The target in words that tell it from what else is in view."""

import numpy as np

from eyas.core.pinhole import project
from eyas.sim.simulation import Simulation
from eyas.targets.words import words_among

__all__ = ["target_in_words"]


def target_in_words(simulation: Simulation, tracker: int, aspect: float) -> str:
    """Return a description of a tracker's target as its camera shows it, such as "a red SUV".

    It is the shortest that no other actor in the camera's view shares, hidden or not.

    Args:
        simulation: The simulation.
        tracker: The tracker.
        aspect: Height of the camera's picture over its width.
    """
    sight = simulation.perception.sight
    cameras, target = sight.shown.cameras, sight.shown.targets.actor[tracker]
    actors, _ = simulation.actors_around(tracker, ago=sight.age_of(tracker))
    (model,), (colour,) = simulation.looks_around(tracker)
    pose = cameras.position[tracker], cameras.rotation[tracker]
    with np.errstate(invalid="ignore"):
        column, row, depth = project(
            actors.position[0], *pose, 1, 1, float(cameras.field_of_view[tracker])
        )
        # The picture is a unit wide, and its middle at (0.5, 0.5).
        inside = (np.abs(column - 0.5) < 0.5) & (np.abs(row - 0.5) < 0.5 * aspect) & (depth > 0.0)
    inside &= actors.present[0]
    inside[target] = False
    others = [(int(model[a]), colour[a].tolist()) for a in np.flatnonzero(inside).tolist()]
    return words_among(int(model[target]), colour[target].tolist(), others)
