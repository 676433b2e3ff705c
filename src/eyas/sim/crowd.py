"""Everyone in a world who is no vehicle of SUMO's: the targets that are asked for, and extras."""

import zlib
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eyas.behaviours.config import Behaviour, ExtraConfig
from eyas.behaviours.lives import Lives, lasting, recycled
from eyas.behaviours.troop import Clock, Troop
from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.core.clock import PHYSICS_STEP
from eyas.core.config import Config
from eyas.core.errors import ConfigError
from eyas.core.rng import stream
from eyas.core.variation import Mirrored, Variation
from eyas.custom.config import CustomConfig
from eyas.sim.config import SimConfig
from eyas.state.motion import SAMPLE, Motion
from eyas.state.scene import Scene
from eyas.targets.catalogue import MODELS, kind_index, models_of
from eyas.targets.config import ObjectsConfig, TargetName
from eyas.traffic.config import Source
from eyas.traffic.signals import SignalPlan
from eyas.world.maps import MAPS

if TYPE_CHECKING:
    from eyas.behaviours.ground import Ground

__all__ = ["NOBODY", "Crowd", "crowd_motions", "crowd_of", "extras_of", "vehicles_of"]

_MAKERS = (
    *("behaviours", "sim/crowd.py", "state/motion.py", "state/terrain.py", "world/roads"),
    *("targets/vehicles/models.py", "traffic/signals.py", "traffic/trailer.py"),
)

_ASIDE = Mirrored(mirrored=(4.0, 20.0))
"""Distance of extras from the middle of the road, if no pavement is asked for [m]."""


class Crowd(Config):
    """The settings that tell who is in a world besides, or instead of, SUMO's vehicles."""

    target: TargetName = TargetName.SUMO_VEHICLE
    objects: ObjectsConfig = ObjectsConfig()
    extras: tuple[ExtraConfig, ...] = ()
    episode: float = 0.0
    """Length of an episode [s]."""
    followers: int = 0
    """Different targets that are followed at once in a world whose time goes on; 0: there is no
    such world."""
    custom: CustomConfig | None = None
    """A target of one's own, in the place of `target`."""

    @property
    def follows_vehicles(self) -> bool:
        """Whether SUMO's vehicles are the targets."""
        return self.custom is None and self.target is TargetName.SUMO_VEHICLE


NOBODY = Crowd()
"""Only SUMO's vehicles."""


def crowd_of(config: SimConfig, trackers: int = 0) -> Crowd:
    """Return the crowd of a simulation; equal where only settings without effect differ.

    Args:
        config: The settings.
        trackers: Number of trackers in the largest world whose time goes on from episode to
            episode; 0: there is none.
    """
    extras = extras_of(config)
    if config.custom is None and config.target is TargetName.SUMO_VEHICLE:
        return Crowd(extras=extras)
    seconds = config.done.total_steps * PHYSICS_STEP
    return Crowd(
        target=config.target,
        objects=config.objects,
        extras=extras,
        episode=seconds,
        followers=min(trackers, 1) if config.same_target else trackers,
        custom=config.custom,
    )


def extras_of(config: SimConfig) -> tuple[ExtraConfig, ...]:
    """Return who shares a world with the targets: those of `extras`, or else the pedestrians of the
    map, who cross its roads if it is known in advance where vehicles will be.
    """
    if config.extras is not None:
        return config.extras
    count = MAPS.get(config.world.map).pedestrians
    live = config.traffic.source is Source.LIVE
    behaviour = Behaviour.PAVEMENT if live else Behaviour.CROSSING
    return (ExtraConfig(count=count, behaviour=behaviour),) if count else ()


def vehicles_of(crowd: Crowd, known: int) -> int:
    """Return how many of the vehicles in `traffic` are in the world; as in the original, none
    unless they are the targets or asked for.

    Args:
        crowd: The crowd.
        known: Number of vehicles that the traffic has.

    Raises:
        ConfigError: More are asked for than there are.
    """
    if crowd.follows_vehicles:
        return known
    wanted = sum(extra.count for extra in crowd.extras if _is_traffic(extra))
    if wanted > known:
        raise ConfigError(
            f"extras: {wanted} vehicles are asked for, but the traffic has {known}; allowed: up to "
            "traffic.max_vehicles"
        )
    return wanted


def crowd_motions(
    crowd: Crowd,
    scene: Scene,
    clock: Clock,
    seed: int,
    vehicles: Motion | None = None,
    lights: SignalPlan | None = None,
) -> list[Motion]:
    """Return the motions of a crowd, kept in the cache: of the targets first, if it has any.

    Args:
        crowd: The crowd.
        scene: The map.
        clock: Number of samples, and their rate.
        seed: Seed of places and ways.
        vehicles: The vehicles' motion, for which those wait who cross roads; None: there are none,
            or it is not known in advance.
        lights: What crossings with lights show, see `walk_plan`; None: there are none.

    Raises:
        ConfigError: Somebody is to cross roads among vehicles whose motion is not known.
        SpawnError: The map has no room for all.
    """
    troops = _troops(crowd, clock)
    driven = crowd.follows_vehicles or any(map(_is_traffic, crowd.extras))
    if driven and vehicles is None:
        _refuse_crossing(crowd)
    ground: list[Ground] = []  # made when the first motion is not in the cache

    def made(number: int, troop: Troop) -> NDArray[np.float32]:
        from eyas.behaviours.ground import Ground  # with shapely
        from eyas.behaviours.scripted import scripted_table

        if not ground:
            ground.append(Ground(scene, roads=driven, lights=lights))
        rng = stream(seed, "crowd", number, zlib.crc32(troop.kind.encode()))
        table = scripted_table(ground[0], troop, clock, rng, vehicles)
        return table.view(np.float32).reshape(*table.shape, -1)

    motions = []
    if crowd.custom is not None:
        motions.append(_custom(crowd, crowd.custom, scene, clock, seed, vehicles, lights))
    for number, troop in enumerate(troops):
        crosses = troop.behaviour is Behaviour.CROSSING
        heeds = crosses or (scene.footways.told and troop.behaviour is Behaviour.PAVEMENT)
        waits_for = (vehicles.table, vehicles.kind) if heeds and vehicles is not None else ()
        obeys = tuple(lights) if crosses and lights is not None else ()
        numbers = cached(
            Kind.MOTION,
            _MAKERS,
            (
                *(*_plan_of(scene), *troop.lives, troop[:3], troop[4:], clock, seed, number),
                *(driven, *waits_for, *obeys),
            ),
            lambda n=number, t=troop: made(n, t),  # type: ignore[misc]
            of=NDArray[np.float32],
        )
        kind = np.full(numbers.shape[1], kind_index(troop.kind), np.int32)
        motions.append(Motion(numbers.view(SAMPLE)[..., 0], kind, clock.rate, 0.0))
    return motions


def _troops(crowd: Crowd, clock: Clock) -> list[Troop]:
    troops = []
    if crowd.custom is None and not crowd.follows_vehicles:
        lives = _lives(crowd, clock)
        target = ExtraConfig(kind=crowd.target)
        troops.append(_troop(target, lives, crowd.objects.offset, "objects.max_count"))
    for number, extra in enumerate(crowd.extras):
        if not _is_traffic(extra):
            lives = lasting(extra.count, clock.samples)
            troops.append(_troop(extra, lives, _ASIDE, f"extras.{number}.count"))
    return troops


def _lives(crowd: Crowd, clock: Clock) -> Lives:
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


def _custom(  # as of `crowd_motions`
    crowd: Crowd,
    custom: CustomConfig,
    scene: Scene,
    clock: Clock,
    seed: int,
    vehicles: Motion | None,
    lights: SignalPlan | None,
) -> Motion:
    """Return the motion of a target of one's own; not kept, as its class may have changed."""
    from eyas.behaviours.ground import Ground
    from eyas.custom.motion import Places, custom_motion

    driven = any(map(_is_traffic, crowd.extras))
    places = Places(_lives(crowd, clock), crowd.objects.offset, vehicles)
    ground = Ground(scene, roads=driven, lights=lights)
    return custom_motion(custom, places, ground, clock, stream(seed, "custom"))


def _troop(extra: ExtraConfig, lives: Lives, offset: Variation, setting: str) -> Troop:
    models = [MODELS[model] for model in models_of(kind_index(extra.kind))]
    breadth = max(float(np.hypot(*model.size[:2])) for model in models)
    return Troop(extra.kind.value, breadth, extra.behaviour, lives, offset, setting)


def _is_traffic(extra: ExtraConfig) -> bool:
    return extra.kind is TargetName.SUMO_VEHICLE


def _plan_of(scene: Scene) -> tuple[object, ...]:
    """Return what of a map paths depend on."""
    mesh, fixtures, colliders = scene.static, scene.fixtures, scene.colliders
    told = scene.footways
    return (
        *(told.kerb_points, told.kerb_first, told.crossings, told.lights),
        *(scene.name, scene.size, *scene.terrain, scene.network.graph_hash),
        *(mesh.positions, mesh.triangles, scene.static_object, scene.object_class),
        *(fixtures.pose, fixtures.prototype, colliders.prism_points, colliders.prism_first),
        *(colliders.prism_bottom, colliders.prism_top, colliders.cylinder_centre),
        *(colliders.cylinder_radius, colliders.cylinder_bottom, colliders.cylinder_top),
    )
