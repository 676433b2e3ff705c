"""Where actors are in each second, roughly: enough to leave out those that are far from a view.

A row is made when its second is asked for first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.motion import Motion
from eyas.engine.traffic.interpolation import place_of
from eyas.lanes import compiled, kernel
from eyas.lanes.vector import WIDTH

NOWHERE = -1e30  # Radius around actors that are absent: it reaches no view


ANYWHERE = 1e6  # Radius around actors that may be anywhere: every view may show them


class ActorBounds(NamedTuple):
    """Spheres around A actors in each of S seconds."""

    actor: NDArray[np.int64]  # The actors, in the order of the columns, shape (A,)
    ready: NDArray[np.bool_]  # Whether each row is made, shape (S,)
    samples: NDArray[np.int64]  # Steps between samples of the motion in a row, shape (1,)
    sphere: NDArray[np.float32]
    """Centre x, y, z and radius [m], shape (S, 4, A, filled up for lanes)."""


def bounds_of(motion: Motion, actor: NDArray[np.int64]) -> ActorBounds:
    """Return bounds of actors of which no row is made."""
    samples = max(round(motion.rate), 1)
    rows = max(-(-(motion.samples - 1) // samples), 1)
    # Not filled: the system gives memory only to rows that are written.
    sphere = np.empty((rows, 4, len(actor) + WIDTH), np.float32)
    return ActorBounds(actor, np.zeros(rows, np.bool_), np.array([samples], np.int64), sphere)


@kernel(inline=True)
def made_row(bounds: ActorBounds, motion: Motion, sample: int) -> int:
    """Return the row for the time after a sample of the motion; make it if needed."""
    row = sample // bounds.samples[0]
    if not bounds.ready[row]:
        for column in range(bounds.sphere.shape[2]):
            bounds.sphere[row, 3, column] = NOWHERE
        first = row * bounds.samples[0]
        last = min(first + bounds.samples[0], motion.samples - 1)
        for column in range(bounds.actor.shape[0]):
            _enclose(bounds, motion, row, column, first, last)
        bounds.ready[row] = True
    return int(row)


@compiled
def make_rows(bounds: ActorBounds, motion: Motion) -> None:
    """Make all rows."""
    for row in range(bounds.ready.shape[0]):
        made_row(bounds, motion, row * bounds.samples[0])


def unbounded_after(known: int, bounds: ActorBounds, motion: Motion) -> None:
    """Make all rows, with spheres without end around actors from a number on, whose motion is not
    known in advance.
    """
    make_rows(bounds, motion)
    columns = np.flatnonzero(bounds.actor >= known)
    bounds.sphere[:, :3, columns] = 0.0
    bounds.sphere[:, 3, columns] = ANYWHERE


@kernel(inline=True)
def _enclose(
    bounds: ActorBounds, motion: Motion, row: int, column: int, first: int, last: int
) -> None:
    """Put a sphere around an actor from sample `first` to `last`."""
    actor = bounds.actor[column]
    low_x, low_y, low_z, high_x, high_y, high_z = 1e30, 1e30, 1e30, -1e30, -1e30, -1e30
    slope = 0.0
    for k in range(first, last):
        a = motion.track[place_of(motion, k, actor)]
        b = motion.track[place_of(motion, k + 1, actor)]
        on_a, on_b = motion.footing[a.footing], motion.footing[b.footing]
        if on_a.present <= 0.0 and on_b.present <= 0.0:
            continue
        low_x, high_x = min(low_x, a.x, b.x), max(high_x, a.x, b.x)
        low_y, high_y = min(low_y, a.y, b.y), max(high_y, a.y, b.y)
        low_z, high_z = min(low_z, on_a.z, on_b.z), max(high_z, on_a.z, on_b.z)
        across = abs(a.velocity_x) + abs(a.velocity_y) + abs(on_a.velocity_z)
        slope = max(slope, across + abs(b.velocity_x) + abs(b.velocity_y) + abs(on_b.velocity_z))
    if high_x < low_x:
        return
    wide, deep, high = 0.5 * (high_x - low_x), 0.5 * (high_y - low_y), 0.5 * (high_z - low_z)
    sphere = bounds.sphere[row]
    sphere[0, column], sphere[1, column] = low_x + wide, low_y + deep
    sphere[2, column] = low_z + high
    # A cubic with given slopes at its ends leaves the range between them by 4/27 of each at most.
    sphere[3, column] = (
        np.sqrt(wide * wide + deep * deep + high * high) + 0.15 * slope / motion.rate
    )
