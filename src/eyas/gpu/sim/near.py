"""Near lists and poses on a device: what a view's world may show, listed by a thread for each view
and posed by a thread for each actor, with the kernels of `eyas.engine.sim.views.near_actors`.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.render.kernels.scalars import f4
from eyas.engine.sim.views.actor_bounds import ActorBounds
from eyas.engine.sim.views.near_actors import (
    Entry,
    KindTable,
    Listed,
    ViewQuery,
    may_show,
    one_may_matter,
    set_camera,
    write_entry,
)
from eyas.engine.state.lighting import LightState
from eyas.engine.state.motion import ActorState, Motion
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.targets.kind import Group, Looks
from eyas.engine.targets.posing import Slots
from eyas.engine.targets.vehicles.pose import pose_vehicle as pose_one
from eyas.engine.traffic.interpolation import interpolate_actor, sample_before
from eyas.gpu.sim.flight import Focal
from eyas.gpu.sim.signals import SignalTimes, shown_part
from eyas.lanes import ParallelCall, kernel, parallel, specialised


class Shown(NamedTuple):
    """Cameras as the renderer reads them, see `eyas.gpu.render.device_views.DeviceViews`; where
    they are stands in `ViewQuery.eye`.
    """

    axes: NDArray[np.float64]
    subject: NDArray[np.int32]
    light: LightState
    instant: NDArray[np.float64]
    focal: NDArray[np.float64]


class Surroundings(NamedTuple):
    """What is known of all actors."""

    motion: Motion
    bounds: ActorBounds  # All rows are made
    kinds: KindTable
    looks: Looks  # In the N worlds


class Counts(NamedTuple):
    """How many actors are listed for each view."""

    end: NDArray[np.int64]
    """Where the actors of each of K kinds begin in its row of `Listed.state`, and at last their
    number, shape (V, K + 1)."""
    short: NDArray[np.int64]  # Not 0 if there was no room for some, shape (1,)
    slots: int  # Number of slots for actors; those of signals follow


class Cast(NamedTuple):
    """One kind of actors."""

    kind: int  # Which of the K
    actors: int  # How many there are of it


@parallel
def list_actors(
    worker: int,
    workers: int,
    snapshot: Snapshot,
    focal: Focal,
    around: Surroundings,
    query: ViewQuery,
    shown: Shown,
    listed: Listed,
    counts: Counts,
) -> None:
    """Write the cameras of views, and list the actors of the world of each; `ViewQuery.world` tells
    which tracker's it is.
    """
    for v in range(worker, query.worlds[0], workers):
        _look(snapshot, focal, query, shown, v)
        set_camera(query, v)
        _list_world(around, query, listed, counts, v)


@kernel(inline=True)
def _look(snapshot: Snapshot, focal: Focal, query: ViewQuery, shown: Shown, v: int) -> None:
    """Write the camera of view `v`."""
    cameras, light, n = snapshot.cameras, snapshot.light, query.world[v]
    query.time[v] = snapshot.episodes.tick[n] * PHYSICS_STEP
    query.field_of_view[v] = cameras.field_of_view[n]
    for axis in range(3):
        query.eye[v, axis] = cameras.position[n, axis]
        for row in range(3):
            query.rotation[v, row, axis] = cameras.rotation[n, row, axis]
            shown.axes[v, axis, row] = cameras.rotation[n, row, axis]
    shown.subject[v] = ACTOR_OBJECT + snapshot.targets.actor[n]
    own = shown.light
    own.sky[v], own.sun[v], own.fog_density[v] = light.sky[n], light.sun[n], light.fog_density[n]
    own.wind_x[v], own.wind_y[v] = light.wind_x[n], light.wind_y[n]
    if shown.instant.shape[0] > 0:
        shown.instant[v] = query.time[v]
    shown.focal[v, 0], shown.focal[v, 1] = focal.length[n, 0], focal.length[n, 1]


@kernel(inline=True)
def _list_world(
    around: Surroundings, query: ViewQuery, listed: Listed, counts: Counts, v: int
) -> None:
    """List the actors that matter for view `v`, kind by kind, and give each its slots."""
    motion, bounds, kinds = around.motion, around.bounds, around.kinds
    time, columns = query.time[v], listed.state.yaw.shape[1]
    sphere = bounds.sphere[sample_before(motion, time) // bounds.samples[0]]
    listed.used[v], counts.end[v, 0] = 0, 0
    entries, begin = 0, 0
    for k in range(kinds.end.shape[0]):
        reach, slots = kinds.reach[k], kinds.slots[k]
        for column in range(begin, kinds.end[k]):
            x, y, z = sphere[0, column], sphere[1, column], sphere[2, column]
            if not may_show(query.camera[v], x, y, z, sphere[3, column] + f4(reach)):
                continue
            actor = bounds.actor[column]
            pose = interpolate_actor(motion, actor, time)
            if not pose.present or not one_may_matter(query, v, pose, reach):
                continue
            if listed.used[v] + slots <= counts.slots and entries < columns:
                place = v * columns + entries
                entry = Entry(actor, query.world[v], v, slots, place, v, entries, 0)
                write_entry(motion, around.looks, listed, entry, pose, time)
            else:
                counts.short[0] = 1  # whoever writes it
            entries += 1
            listed.used[v] += slots
        counts.end[v, k + 1] = entries
        begin = kinds.end[k]


@parallel
def empty_slots(
    worker: int,
    workers: int,
    snapshot: Snapshot,
    query: ViewQuery,
    listed: Listed,
    counts: Counts,
    signals: SignalTimes,
) -> None:
    """Empty the slots that are not used, and show the signals in those behind."""
    width = listed.part.shape[1]
    for index in range(worker, query.worlds[0] * width, workers):
        v, slot = index // width, index % width
        if slot >= counts.slots:
            tick = snapshot.episodes.tick[query.world[v]]
            listed.part[v, slot] = shown_part(signals, slot - counts.slots, tick)
        elif slot >= listed.used[v]:
            listed.part[v, slot] = -1


@lru_cache(maxsize=16)
def pose_call(one: Callable[..., None]) -> ParallelCall:
    """Return the driver that poses the listed actors of a kind by
    `eyas.engine.targets.posing.PoseCall`'s `one`; it takes its table, `Group`, state and looks of
    the listed actors, `Slots`, `ViewQuery`, `Counts` and `Cast`.
    """
    return parallel(specialised(_pose, pose_one=one))


def _pose(
    worker: int,
    workers: int,
    table: Any,  # noqa: ANN401  # of the kind
    group: Group,
    actors: ActorState,
    looks: Looks,
    out: Slots,
    query: ViewQuery,
    counts: Counts,
    cast: Cast,
) -> None:
    """Write the slots of the listed actors of a kind."""
    for index in range(worker, query.worlds[0] * cast.actors, workers):
        v = index // cast.actors
        column = counts.end[v, cast.kind] + index % cast.actors
        if column < counts.end[v, cast.kind + 1]:
            pose_one(table, group, actors, looks, out, v, v * actors.yaw.shape[1] + column)
