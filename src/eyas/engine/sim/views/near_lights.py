"""The lights of signals that a camera may show, listed behind the actors that matter.

A town has a hundred of them, and a picture shows one or two: listed for each view, they took longer
to be told apart than all that moves.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.views.additions import SignalLights
from eyas.engine.sim.views.near_actors import SLACK, Listed, ViewQuery, eight_may_matter
from eyas.engine.state.draw import DrawList
from eyas.lanes import Held, compiled
from eyas.lanes.vector import WIDTH, first_bit


class _Poles(NamedTuple):
    """P poles, and more that nobody sees, so that their number is a multiple of eight."""

    sphere: NDArray[np.float32]
    """x, y and z of the feet, and how far the lights are from them [m], shape (4, P)."""


class _Found(NamedTuple):
    """The lights that may be seen, F in all worlds; where there are more, the rest is not written,
    and `Listed.needed` tells how many slots there must be.
    """

    number: NDArray[np.int64]  # Shape (1,)
    pole: NDArray[np.int64]  # Shape (F,)
    slot: NDArray[np.int64]  # Slot, counted through the lists of all worlds, shape (F,)


@compiled
def _list_lights(poles: _Poles, query: ViewQuery, listed: Listed, found: _Found) -> None:
    """Find the poles that matter, and give each a slot; `listed` has the actors already."""
    count, slots = 0, listed.part.shape[1]
    for w in range(query.worlds[0]):
        used = listed.used[w]
        for first in range(0, poles.sphere.shape[1], WIDTH):
            seen = eight_may_matter(query, w, poles.sphere, first, 0.0)
            while seen != 0:
                if used < slots:
                    found.pole[count] = first + first_bit(seen)
                    found.slot[count] = w * slots + used
                    count += 1
                seen &= seen - 1
                used += 1
        listed.used[w] = used
        listed.needed[1] = max(listed.needed[1], used)
    found.number[0] = count


class NearLights:
    """Lists the lights that some views may show.

    Args:
        lights: All of them.
        reach: How far the corners of a light are from the foot of its pole, at most [m].
    """

    def __init__(self, lights: SignalLights, reach: float) -> None:
        self._lights = lights
        count = len(lights.pose)
        sphere = np.zeros((4, -(-count // WIDTH) * WIDTH), np.float32)
        sphere[:3, :count] = lights.pose[:, :, 3].T
        sphere[3, count:] = -1e9  # so far behind all edges that no camera sees them
        sphere[3, :count] = 1.001 * reach * _scale(lights.pose) + SLACK
        self._poles = Held(_Poles(sphere))

    def bind(self, query: ViewQuery, listed: Listed) -> None:
        """Use these buffers from now on."""
        most = listed.part.size
        self._found = _Found(*(np.zeros(size, np.int64) for size in (1, most, most)))
        self.list = _list_lights.bind(self._poles, query, listed, self._found)

    def write(self, time: NDArray[np.float64], slots: int, flat: DrawList) -> None:
        """Write the lights found into their slots.

        Args:
            time: Time of each world [s], shape (W,).
            slots: Slots in the list of a world.
            flat: The lists of all worlds, as of one.
        """
        count, lights = int(self._found.number[0]), self._lights
        if count == 0:
            return
        pole, slot = self._found.pole[:count], self._found.slot[:count]
        flat.part[0, slot] = lights.parts(time[slot // slots], pole)
        flat.pose[0, slot] = lights.pose[pole]
        flat.colour[0, slot] = 1.0
        flat.object_id[0, slot] = lights.object_id[pole]
        if flat.lamps.size:
            flat.lamps[0, slot] = 0


def _scale(pose: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the scale of poses, shape (P,)."""
    scale: NDArray[np.float32] = np.sqrt((pose[:, :, 0] * pose[:, :, 0]).sum(axis=1))
    return scale
