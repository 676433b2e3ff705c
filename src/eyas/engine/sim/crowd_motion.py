"""The motion of a crowd: of the targets that are not vehicles of SUMO's, and of extras."""

import zlib
from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.config import ExtraConfig
from eyas.engine.behaviours.groups import Lifetimes, SampleClock, ScriptedGroup, lasting, recycled
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import stream
from eyas.engine.core.variation import Mirrored, Variation
from eyas.engine.custom.config import CustomConfig
from eyas.engine.sim.air_motion import air_motions
from eyas.engine.sim.crowd import Crowd
from eyas.engine.state.motion import (
    FOOTING,
    TRACK,
    Motion,
    SampledMotion,
    blocks_of,
    joined,
    packed,
)
from eyas.engine.state.scene import Scene
from eyas.engine.targets.catalogue import MODELS, habit_of, kind_index, models_of
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.recorded import Vehicles
from eyas.engine.traffic.signals import SignalPlan
from eyas.lanes import exact

if TYPE_CHECKING:
    from eyas.engine.behaviours.ground import WalkingGround


_ASIDE = Mirrored(mirrored=(4.0, 20.0))
"""Distance of extras from the middle of the road, if no pavement is asked for [m]."""


class CrowdSurroundings(NamedTuple):
    """Where and when a crowd moves."""

    scene: Scene
    clock: SampleClock  # Number of samples, and their rate
    seed: int  # Of places and ways
    vehicles: Vehicles | None = None
    """The vehicles, for which those wait who cross roads; None: there are none, or their motion is
    not known in advance."""
    lights: SignalPlan | None = None
    """What crossings with lights show, see `walk_plan`; None: there are none."""


def crowd_motions(
    crowd: Crowd,
    around: CrowdSurroundings,  # Where and when it moves
) -> list[Motion]:
    """Return the motions of a crowd, kept in the cache: of the targets first, if it has any.

    Raises:
        ConfigError: Somebody is to cross roads among vehicles whose motion is not known.
        SpawnError: The map has no room for all.
    """
    if crowd.driven and around.vehicles is None:
        _refuse_crossing(crowd)
    made = []
    if crowd.custom is not None:
        made.append(_custom(crowd, crowd.custom, around, _ground(around, crowd.driven)).packed())
    if groups := _groups(crowd, around.clock):
        made.append(_all_kept(groups, crowd, around, None))
    return made


def live_motions(crowd: Crowd, around: CrowdSurroundings) -> list[Motion]:
    """Return the motions of all but vehicles that SUMO drives now, see `crowd_motions`."""
    return [*crowd_motions(crowd, around), *_above(crowd, around)]


def with_crowd(
    crowd: Crowd,
    around: CrowdSurroundings,  # Where and when it moves
) -> tuple[Motion, NDArray[np.bool_]]:
    """Return the motion of the vehicles and, after them, of a crowd, and who may be a target.

    Raises:
        SpawnError: The map has no room for all.
    """
    vehicles, motions, count = around.vehicles, list[Motion](), 0
    groups = _groups(crowd, around.clock) if crowd.custom is None else []
    if groups or vehicles is not None:
        motions.append(_all_kept(groups, crowd, around, vehicles))
    if vehicles is not None:
        (first, *_), count = motions, len(vehicles.kind)
        driven = first._replace(start=first.start[:, :count], kind=vehicles.kind)
        around = around._replace(vehicles=vehicles._replace(motion=driven.sampled))
    if crowd.custom is not None:
        motions += crowd_motions(crowd, around)
    followed = count
    if not crowd.follows_vehicles:
        followed += _count(groups[0]) if groups else len(motions[min(count, 1)].kind)
    motion = joined([*motions, *_above(crowd, around)])
    actor = np.arange(len(motion.kind))
    return motion, (actor < followed) & (crowd.follows_vehicles | (actor >= count))


def _above(crowd: Crowd, around: CrowdSurroundings) -> list[Motion]:
    """Return the motions of what flies."""
    scene, clock, seed, vehicles = around[:4]
    followed = vehicles.motion() if vehicles is not None and crowd.airborne.drones else None
    flying = air_motions(crowd.airborne, scene, clock, seed, followed)
    return [motion.packed() for motion in flying]


def _all_kept(
    groups: Sequence[ScriptedGroup],
    crowd: Crowd,
    around: CrowdSurroundings,
    vehicles: Vehicles | None,
) -> Motion:
    """Return the motion of vehicles and groups as one entry of the cache.

    Joined in memory, that of 400 people would take half a gigabyte of each process, of which it
    reads little.
    """
    ground = cache(partial(_ground, around, crowd.driven))
    parts: list[Callable[[], NDArray[np.void]]] = [
        partial(_samples_of, group, number, around, ground) for number, group in enumerate(groups)
    ]
    depends_on = [
        _depends_on(group, number, around, crowd.driven) for number, group in enumerate(groups)
    ]
    indices = [kind_index(group.kind) for group in groups]
    kind = np.repeat(indices, [*map(_count, groups)]).astype(np.int32)
    inputs: tuple[object, ...] = (_samples_of, *depends_on)
    if vehicles is not None:
        inputs, kind = (*inputs, vehicles.origin), np.concatenate([vehicles.kind, kind])
        parts = [lambda: vehicles.motion().table, *parts]
    make = partial(_side_by_side, parts, (around.clock.samples, len(kind)))
    kept = cached(EntryKind.MOTION, make, inputs, of=_Numbers)
    track, footing = (
        each.view(of)[:, 0] for each, of in ((kept.track, TRACK), (kept.footing, FOOTING))
    )
    lamps = np.zeros((0, 0), np.uint8)
    if vehicles is not None and vehicles.lamps.size:
        lamps = np.zeros((kept.samples, len(kind)), np.uint8)
        lamps[:, : len(vehicles.kind)] = vehicles.lamps
    return Motion(track, kept.start, kept.samples, footing, kind, around.clock.rate, 0.0, lamps)


def _count(group: ScriptedGroup) -> int:
    """Return how many a group are."""
    return int(group.lifetimes.slot.max()) + 1


def _ground(around: CrowdSurroundings, driven: bool) -> "WalkingGround":
    """Return the ground, whose roads are left to vehicles where these drive."""
    from eyas.engine.behaviours.ground import WalkingGround  # with shapely

    return WalkingGround(around.scene, roads=driven, lights=around.lights)


class _Numbers(NamedTuple):
    """Fields of `Motion` of the same names as they are kept."""

    track: NDArray[np.uint32]
    start: NDArray[np.int32]
    samples: int
    footing: NDArray[np.uint32]


def _side_by_side(
    parts: Sequence[Callable[[], NDArray[np.void]]],
    shape: tuple[int, int],  # Of the whole: samples, actors
) -> _Numbers:
    made, every, first = np.zeros(shape, TRACK), np.zeros(0, FOOTING), 0
    for part in parts:  # one at a time in memory
        table, footing = packed(part())
        table["footing"] += np.uint32(len(every))
        made[:, first : first + table.shape[1]] = table
        every, first = np.concatenate([every, footing]), first + table.shape[1]
    track, start, samples = blocks_of(made)
    return _Numbers(track[:, None].view(np.uint32), start, samples, every[:, None].view(np.uint32))


def _samples_of(
    group: ScriptedGroup,  # Who moves
    number: int,  # Which of the crowd's groups it is
    around: CrowdSurroundings,  # Where and when it moves
    ground: Callable[[], "WalkingGround"],  # Returns the ground
) -> NDArray[np.void]:
    """Return the samples of a group's motion."""
    from eyas.engine.behaviours.scripted import scripted_table  # with shapely

    rng = stream(around.seed, "crowd", number, zlib.crc32(group.kind.encode()))
    vehicles = None if around.vehicles is None else around.vehicles.motion()
    return scripted_table(ground(), group, around.clock, rng, vehicles)


def _depends_on(
    group: ScriptedGroup, number: int, around: CrowdSurroundings, driven: bool
) -> tuple[object, ...]:
    """Return what `_samples_of` depends on; `driven`: whether vehicles drive there."""
    scene, clock, seed, vehicles, lights = around
    crosses = group.behaviour is Behaviour.CROSSING
    along = group.behaviour in (Behaviour.PAVEMENT, Behaviour.VERGE, Behaviour.RIDE)
    heeds = crosses or (scene.footways.told and along)
    waits_for = vehicles.origin if heeds and vehicles is not None else ()
    obeys = lights if crosses else None
    moves = group._replace(setting="", chosen_by="")  # which only messages name
    return (_ground, _plan_of(scene), moves, clock, seed, number, driven, waits_for, obeys)


def _groups(crowd: Crowd, clock: SampleClock) -> list[ScriptedGroup]:
    groups = []
    if crowd.custom is None and not crowd.follows_vehicles:
        lifetimes = _lifetimes(crowd, clock)
        target = ExtraConfig(kind=crowd.target, behaviour=crowd.objects.behaviour)
        one = _group(target, lifetimes, crowd.objects.offset, "objects.max_count")
        groups.append(one._replace(chosen_by="objects.behaviour"))
    for number, extra in enumerate(crowd.extras):
        if not extra.is_traffic:
            lifetimes = lasting(extra.count, clock.samples)
            one = _group(extra, lifetimes, _ASIDE, f"extras.{number}.count")
            groups.append(one._replace(chosen_by=f"extras.{number}.behaviour"))
    return groups


def _lifetimes(crowd: Crowd, clock: SampleClock) -> Lifetimes:
    return recycled(crowd.objects, clock.samples, clock.rate, crowd.episode, crowd.followers)


def _refuse_crossing(crowd: Crowd) -> None:
    """Raise an error if somebody is to cross roads."""
    custom = crowd.custom.behaviour if crowd.custom is not None else None
    for setting, behaviour in (
        ("custom.behaviour", custom),
        *((f"extras.{k}.behaviour", extra.behaviour) for k, extra in enumerate(crowd.extras)),
    ):
        if behaviour is Behaviour.CROSSING:
            raise ConfigError(
                f"{setting}: 'crossing' is not allowed with traffic.source=live, as it is unknown "
                "in advance; allowed: 'pavement'"
            )


def _custom(
    crowd: Crowd, custom: CustomConfig, around: CrowdSurroundings, ground: "WalkingGround"
) -> SampledMotion:
    """Return the motion of a target of one's own; not kept, as its class may have changed."""
    from eyas.engine.custom.motion import Places, custom_motion  # with shapely

    clock, vehicles = around.clock, around.vehicles and around.vehicles.motion()
    places = Places(_lifetimes(crowd, clock), crowd.objects.offset, vehicles)
    return custom_motion(custom, places, ground, clock, stream(around.seed, "custom"))


def _group(
    extra: ExtraConfig, lifetimes: Lifetimes, offset: Variation, setting: str
) -> ScriptedGroup:
    models = [MODELS[model] for model in models_of(kind_index(extra.kind))]
    if extra.behaviour is Behaviour.RIDE:  # always ahead, along what is beside one
        breadth = max(model.width for model in models)
    else:
        breadth = max(float(exact.hypot(*model.size[:2])) for model in models)
    return ScriptedGroup(
        kind=extra.kind.value,
        breadth=breadth,
        behaviour=extra.behaviour,
        habit=habit_of(extra.kind.value),
        lifetimes=lifetimes,
        offset=offset,
        setting=setting,
    )


def _plan_of(scene: Scene) -> tuple[object, ...]:
    """Return what of a map paths depend on."""
    mesh, fixtures, colliders = scene.static, scene.fixtures, scene.colliders
    told = scene.footways
    return (
        *(told.kerb_points, told.kerb_first, told.crossings, told.lights),
        *(scene.name, scene.size, scene.terrain, scene.network),
        *(mesh.positions, mesh.triangles, scene.static_object, scene.object_class),
        *(fixtures.pose, fixtures.prototype, colliders.prism_points, colliders.prism_first),
        *(colliders.prism_bottom, colliders.prism_top, colliders.cylinder_centre),
        *(colliders.cylinder_radius, colliders.cylinder_bottom, colliders.cylinder_top),
    )
