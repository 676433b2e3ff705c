"""The motion of targets of one's own, as rows of the table of all motion."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.ground import WalkingGround
from eyas.engine.behaviours.groups import Lifetimes, SampleClock, ScriptedGroup
from eyas.engine.behaviours.scripted import scripted_table
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import user_path
from eyas.engine.core.variation import Variation
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import kind_name_of, own_target
from eyas.engine.custom.own import MovesItself
from eyas.engine.custom.problems import of_trajectory, worst
from eyas.engine.custom.smoothing import smoothed
from eyas.engine.custom.tracks import Placement, on_map
from eyas.engine.custom.user_class import tracks_of
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.catalogue import MODELS, kind_index, models_of
from eyas.engine.targets.habit import Habit
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.place import projection_of
from eyas.lanes import exact

_SPAN = 0.25  # Half the distance over which the slope of the ground is taken [m]
_FEWEST = 5  # Least number of samples of a trajectory

Floats = NDArray[np.float64]


class Places(NamedTuple):
    """Times and places at which targets with a behaviour begin, see `ObjectsConfig`."""

    lifetimes: Lifetimes
    offset: Variation
    vehicles: SampledMotion | None = None  # Vehicles for which those wait who cross roads


def custom_motion(
    config: CustomConfig,  # The target
    places: Places,  # When and where it begins, if it moves by a behaviour
    ground: WalkingGround,  # The map
    clock: SampleClock,  # Number of samples, and their rate
    rng: np.random.Generator,  # Source of random numbers
) -> SampledMotion:
    """Return the motion of the user's targets.

    Raises:
        EyasError: The target cannot be used, or the map has no room for it: one line.
    """
    name = kind_name_of(config)
    target = own_target(config) if config.path is not None else None
    if config.trajectory is not None:
        table = _driven(config, ground, clock)
    elif isinstance(target, MovesItself):
        assert config.path is not None  # the target is of that class
        count = int(places.lifetimes.slot.max()) + 1
        table = _own(target, config.path, count, ground, clock, rng)
    else:
        group = _group(config, name, places)
        table = scripted_table(ground, group, clock, rng, places.vehicles)
    return SampledMotion(
        table, np.full(table.shape[1], kind_index(name), np.int32), clock.rate, 0.0
    )


def _group(config: CustomConfig, name: str, places: Places) -> ScriptedGroup:
    speed, size = config.speed, MODELS[models_of(kind_index(name)).start].size
    breadth = float(exact.hypot(*size[:2]))
    habit = Habit(config.behaviour, speed, max(1.0, speed), 2.0, max(0.5, breadth))
    return ScriptedGroup(
        kind=name,
        breadth=breadth,
        behaviour=config.behaviour,
        habit=habit,
        lifetimes=places.lifetimes,
        offset=places.offset,
        setting="objects.max_count",
    )


def _driven(config: CustomConfig, ground: WalkingGround, clock: SampleClock) -> NDArray[np.void]:
    """Return the samples of trajectories, all of them again and again."""
    scene = ground.scene
    recipe = MAPS.get(scene.name)
    placement = Placement(scene.name, projection_of(recipe), config.at, config.speed)
    files = [user_path(file) for file in config.tracks]
    try:
        bodies = on_map(files, placement)
    except DataFileError as error:
        raise ConfigError(f"custom.trajectory: {error}") from None
    period, laps = 0, []
    for start, trajectory in bodies:
        if problem := worst(of_trajectory(trajectory, scene.size, scene.name)):
            raise ConfigError(f"custom.trajectory: {files[0]}: {problem}")
        first = int(start * clock.rate)
        count = int(trajectory.time[-1] * clock.rate) + 1
        if count < _FEWEST:
            raise ConfigError(
                f"custom.trajectory: {files[0]}: it is shorter than "
                f"{(_FEWEST - 1) / clock.rate:g} s"
            )
        smooth = smoothed(trajectory, config.smoothing) if config.smoothing > 0.0 else trajectory
        place, yaw = smooth.at(np.arange(min(count, clock.samples)) / clock.rate)
        laps.append((first, _table(place[:, None], yaw[:, None], ground, clock.rate)[:, 0]))
        period = max(period, first + count)
    # Two bodies in turn: one begins when the other ends, so there is always one to be followed.
    table = np.zeros((clock.samples, 2 * len(laps)), SAMPLE)
    for number, begin in enumerate(range(0, clock.samples - 1, period - 1)):
        for body, (first, lap) in enumerate(laps):
            rows = table[begin + first : begin + first + len(lap), 2 * body + number % 2]
            rows[:] = lap[: len(rows)]
    return table


def _own(
    target: MovesItself,
    path: str,
    count: int,
    ground: WalkingGround,
    clock: SampleClock,
    rng: np.random.Generator,
) -> NDArray[np.void]:
    """Return the samples of a motion that a user's class computes."""
    time = np.arange(clock.samples) / clock.rate
    tracks = tracks_of(target, path, ground.scene, time, count, rng)
    place = np.concatenate([tracks[..., :2], np.full((*tracks.shape[:2], 1), np.nan)], axis=-1)
    return _table(place, np.unwrap(tracks[..., 2], axis=0), ground, clock.rate)


def _table(place: Floats, yaw: Floats, ground: WalkingGround, rate: float) -> NDArray[np.void]:
    """Return samples of places (S, A, 3) with headings (S, A); z is NaN: on the ground."""
    flat, terrain = place[..., :2].reshape(-1, 2), ground.scene.terrain
    ahead = _SPAN * np.stack([exact.cos(yaw), exact.sin(yaw)], axis=-1).reshape(-1, 2)
    rise = reliefs(terrain, flat + ahead) - reliefs(terrain, flat - ahead)
    on_ground = np.isnan(place[..., 2])
    z = place[..., 2].copy()
    z[on_ground] = ground.surface.at(flat[on_ground.ravel()]).height
    slope = exact.atan(rise / (2.0 * _SPAN)).reshape(yaw.shape)
    table = np.zeros(yaw.shape, SAMPLE)
    table["x"], table["y"], table["z"], table["yaw"] = place[..., 0], place[..., 1], z, yaw
    table["slope"] = np.where(on_ground, slope, 0.0)
    for name, values in (("velocity_x", place[..., 0]), ("velocity_y", place[..., 1])):
        table[name] = np.gradient(values, axis=0) * rate
    table["velocity_z"], table["yaw_rate"] = (np.gradient(v, axis=0) * rate for v in (z, yaw))
    step = exact.hypot(*np.moveaxis(np.diff(place[..., :2], axis=0), -1, 0))
    table["travelled"][1:] = np.cumsum(step, axis=0)
    table["present"] = 1.0
    return table
