"""Who is in a world besides, or instead of, SUMO's vehicles: the settings that tell."""

from eyas.engine.behaviours.airborne import AirborneConfig
from eyas.engine.behaviours.config import ExtraConfig, Rider
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.config import Config
from eyas.engine.core.errors import ConfigError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.sim.config import SimConfig
from eyas.engine.targets.config import ObjectsConfig, TargetName
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.config import Source
from eyas.engine.world.maps import MAPS


class Crowd(Config):
    """Everyone in a world who is not a vehicle of SUMO's: targets that are asked for, and extras.

    Other settings have no effect on their motion.
    """

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
    airborne: AirborneConfig = AirborneConfig()

    @property
    def follows_vehicles(self) -> bool:
        """Whether SUMO's vehicles are the targets."""
        return self.custom is None and self.target is TargetName.SUMO_VEHICLE

    @property
    def driven(self) -> bool:
        """Whether vehicles drive in the world."""
        return self.follows_vehicles or any(extra.is_traffic for extra in self.extras)


NOBODY = Crowd()  # Only SUMO's vehicles


def crowd_of(config: SimConfig, trackers: int = 0) -> Crowd:
    """Return the crowd of a simulation; equal where only settings without effect differ.

    Args:
        config: The settings.
        trackers: Number of trackers in the largest world whose time goes on from episode to
            episode; 0: there is none.
    """
    extras = extras_of(config)
    if config.custom is None and config.target is TargetName.SUMO_VEHICLE:
        return Crowd(extras=extras, airborne=config.airborne)
    seconds = config.done.total_steps * PHYSICS_STEP
    return Crowd(
        target=config.target,
        objects=config.objects,
        extras=extras,
        episode=seconds,
        followers=min(trackers, 1) if config.same_target else trackers,
        custom=config.custom,
        airborne=config.airborne,
    )


def extras_of(config: SimConfig) -> tuple[ExtraConfig, ...]:
    """Return who shares a world with the targets: those of `extras`, or else the pedestrians of the
    map, who cross its roads if it is known in advance where vehicles will be.
    """
    if config.extras is not None:
        return config.extras
    recipe = MAPS.get(config.world.map)
    live = config.traffic.source is Source.LIVE
    behaviour = Behaviour.PAVEMENT if live else Behaviour.CROSSING
    everyone = (
        (TargetName.PEDESTRIAN, recipe.pedestrians, behaviour),
        (TargetName.PEDESTRIAN, recipe.strollers, Behaviour.VERGE),
        (TargetName.PEDESTRIAN, recipe.waiting, Behaviour.WAIT),
        (Rider.CYCLIST, recipe.cyclists, Behaviour.RIDE),
    )
    return tuple(
        ExtraConfig(kind=kind, count=count, behaviour=way) for kind, count, way in everyone if count
    )


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
    wanted = sum(extra.count for extra in crowd.extras if extra.is_traffic)
    if wanted > known:
        raise ConfigError(
            f"extras: {wanted} vehicles are asked for, but the traffic has {known}; allowed: up to "
            "traffic.max_vehicles"
        )
    return wanted
