"""Which vehicles throw up water, and from where."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.targets.kind import Kind
from eyas.lanes import exact

if TYPE_CHECKING:
    from eyas.engine.sim.views.near_actors import Listed


SPRAY_REACH = 14.0
"""Distance from a vehicle beyond which its spray is not seen [m], see `sky.plumes`."""

_SLOWEST = 8.0  # Speed up to which none is thrown up [m/s]

_AXLE = 0.32  # Distance of the rear axle behind the middle, as a share of the length

_VEHICLES = (ObjectClass.CAR, ObjectClass.TRUCK, ObjectClass.BUS, ObjectClass.MOTORCYCLE)


def throwing(kinds: Sequence[Kind]) -> NDArray[np.bool_]:
    """Return which kinds have wheels that throw up water, shape (K,)."""
    return np.array([kind.object_class in _VEHICLES for kind in kinds], np.bool_)


def spray_of(
    listed: "Listed",  # The actors
    kinds: NDArray[np.bool_],  # Which kinds throw up water, see `throwing`
    worlds: int,  # Number of worlds
) -> NDArray[np.float32]:
    """Return `DrawList.spray` of listed actors."""
    actors, model = listed.state, listed.looks.model[0]
    throws = np.repeat(kinds, np.diff(listed.end, prepend=0))
    slot = listed.slot[: len(throws)]
    actor = listed.object_id.reshape(-1)[slot] - ACTOR_OBJECT
    world = slot // max(listed.part.shape[1], 1)
    velocity = actors.velocity[0, : len(throws), :2]
    chosen = np.flatnonzero(throws & (np.square(velocity).sum(axis=1) > np.square(_SLOWEST)))
    chosen = chosen[np.argsort(world[chosen], kind="stable")]
    at = world[chosen]
    rank = np.arange(len(at)) - np.searchsorted(at, at)
    spray = np.zeros((worlds, int(rank.max(initial=-1)) + 1, 8), np.float32)
    size = np.array([MODELS[k].size for k in model[chosen].tolist()]).reshape(-1, 3)
    yaw, place = actors.yaw[0, chosen], actors.position[0, chosen]
    back = _AXLE * size[:, 0]
    spray[at, rank, 0] = place[:, 0] - back * exact.cos(yaw)
    spray[at, rank, 1] = place[:, 1] - back * exact.sin(yaw)
    spray[at, rank, 2] = place[:, 2]
    spray[at, rank, 3:5] = velocity[chosen]
    spray[at, rank, 5] = 0.5 * size[:, 1]
    spray[at, rank, 6] = actor[chosen]
    return spray
