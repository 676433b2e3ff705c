"""The motion of what flies through a world, see `AirborneConfig`."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.airborne import AirborneConfig, chases, flocks
from eyas.engine.behaviours.airspace import airspace_of
from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.rng import stream
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.scene import Scene
from eyas.engine.targets.bird import BIRD
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.targets.quadrotor import QUADROTOR

_BIRD_SPEED, _DRONE_SPEED = 11.0, 7.0


def air_motions(
    airborne: AirborneConfig,
    scene: Scene,
    clock: SampleClock,
    seed: int,
    vehicles: SampledMotion | None,
) -> list[SampledMotion]:
    """Return the motions of birds and drones; none if there are none.

    Args:
        airborne: How many.
        scene: The map, above which birds fly.
        clock: The instants.
        seed: Of their ways.
        vehicles: The vehicles, which drones follow; None: they are not known in advance, and drones
            fly on closed ways.
    """
    motions = []
    if airborne.birds:
        kind = kind_index(BIRD.name)
        motions.append(_circling(airborne.birds, kind, scene, clock, seed, _BIRD_SPEED))
    if airborne.drones:
        kind = kind_index(QUADROTOR.name)
        known = 0 if vehicles is None else min(airborne.drones, len(vehicles.kind))
        if vehicles is not None and known:
            motions.append(chases(known, kind, vehicles, stream(seed, "drones")))
        if airborne.drones > known:
            left = airborne.drones - known
            motions.append(_circling(left, kind, scene, clock, seed, _DRONE_SPEED))
    return motions


def _circling(
    count: int, kind: int, scene: Scene, clock: SampleClock, seed: int, speed: float
) -> SampledMotion:
    """Return the motion of some of a kind on closed ways, kept in the cache."""
    make = partial(_numbers, count, kind, scene, clock, seed, speed)
    static, fixtures = scene.static, scene.fixtures
    inputs = (
        *(count, kind, clock, seed, speed, scene.name, scene.size, scene.terrain),
        *(static.positions, static.triangles, fixtures.pose, fixtures.prototype),
    )
    numbers = cached(EntryKind.MOTION, make, (_numbers, *inputs), of=NDArray[np.float32])
    kinds = np.full(count, kind, np.int32)
    return SampledMotion(numbers.view(SAMPLE)[..., 0], kinds, clock.rate, 0.0)


def _numbers(
    count: int, kind: int, scene: Scene, clock: SampleClock, seed: int, speed: float
) -> NDArray[np.float32]:
    """Return the numbers of the samples of `flocks`."""
    rng = stream(seed, "airborne", kind)
    table = flocks(count, kind, airspace_of(scene), clock, rng, speed).table
    return table.view(np.float32).reshape(*table.shape, -1)
