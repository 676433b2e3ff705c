"""The flight of the demo: its world, and one drone whose episode never ends by itself."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.demo.controls import CAMERA_PITCH, CAMERA_YAW, Control, Held, camera_turn
from eyas.demo.messages import RewardMessage
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.assets import Assets, load_assets
from eyas.engine.sim.build import tracker_in
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.crowd import Crowd, crowd_of
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.still import StillWorld
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import SAMPLE, Motion, SampledMotion, joined
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import VEHICLE_KINDS, kind_index, models_of
from eyas.engine.targets.rig import Rigs
from eyas.engine.task.rules import lenient, make_rules
from eyas.engine.traffic.config import VehicleType
from eyas.engine.traffic.replay import Replay

COLOUR = (0.62, 0.05, 0.06)  # Colour of the first model of a car, as the manual says

WANTED = (30.0, 30.0)
"""Where the car stands in most worlds of the original [m]; here, by the road nearest to that."""
REACH, CELL = 80.0, 0.5  # Reach of the search for a place from that road, and its step [m]
EYE = 400.0  # Height of the camera that looks for it [m]
FREE_SIDE, ROAD_SIDE = 6.5, 16.0
"""Squares around the car: all free ground, and some of it a road [m]."""

LEVEL = 0.25  # Range of heights of the free ground [m]

FREE = (int(ObjectClass.GROUND), int(ObjectClass.PAVEMENT))


def parked_car(assets: Assets, samples: int, rate: float) -> Motion | None:
    """Return the motion of the car; None if no ground is free, or no cars can be drawn.

    Args:
        rate: Samples per second.
    """
    car = kind_index(VehicleType.PASSENGER)
    # The renderer has only the parts of the kinds that drive.
    place = _free_place(assets) if (assets.traffic.motion.kind == car).any() else None
    if place is None:
        return None
    table = np.zeros((samples, 1), SAMPLE)
    table["x"], table["y"], table["z"] = place
    table["yaw"] = _heading(assets, *place[:2])
    table["present"] = 1.0
    return SampledMotion(table, np.array([car], np.int32), rate).packed()


def _free_place(assets: Assets) -> tuple[float, float, float] | None:
    """Return the nearest place to the wanted one where level ground is free [m]."""
    size = int(2.0 * REACH / CELL)
    lanes = assets.scene.network.lane_points
    middle = lanes[int(np.hypot(*(lanes - WANTED).T).argmin())]
    classes, depth = _from_above(assets, middle, size)
    good = _around(np.isin(classes, FREE), FREE_SIDE, least=1.0)
    good &= _around(classes == ObjectClass.ROAD, ROAD_SIDE, least=0.1)
    good &= _spread(depth, FREE_SIDE) < LEVEL
    row, column = np.nonzero(good)
    if not len(row):
        return None
    east, north = (column + 0.5 - 0.5 * size) * CELL, (0.5 * size - row - 0.5) * CELL
    best = int(np.argmin(east**2 + north**2))
    height = EYE - float(depth[row[best], column[best]])
    return float(middle[0] + east[best]), float(middle[1] + north[best]), height


def _windows(array: NDArray[Any], side: float) -> NDArray[Any]:
    """Return the square around each cell [m], without those near the edge, shape (., ., K, K)."""
    cells = int(side / CELL) | 1
    padded = np.pad(array, cells // 2, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (cells, cells))


def _around(good: NDArray[np.bool_], side: float, *, least: float) -> NDArray[np.bool_]:
    """Return where at least a share of the square around a cell is good."""
    enough: NDArray[np.bool_] = _windows(good, side).mean(axis=(2, 3)) >= least
    return enough


def _spread(depth: NDArray[np.float32], side: float) -> NDArray[np.float32]:
    """Return the range of depths in the square around each cell [m]."""
    windows = _windows(depth, side)
    spread: NDArray[np.float32] = windows.max(axis=(2, 3)) - windows.min(axis=(2, 3))
    return spread


def _heading(assets: Assets, x: float, y: float) -> float:
    """Return the direction of the nearest lane [rad]."""
    network = assets.scene.network
    points = network.lane_points
    steps = np.diff(points, axis=0)
    steps[network.lane_first[1:-1] - 1] = 0.0  # from one lane to the next
    middles = points[:-1] + 0.5 * steps
    away = np.hypot(middles[:, 0] - x, middles[:, 1] - y)
    away[(steps == 0.0).all(axis=1)] = np.inf
    along = steps[int(away.argmin())]
    return math.atan2(along[1], along[0])


def _from_above(
    assets: Assets, middle: NDArray[np.float64], size: int
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return classes and depths [m] around a place, north on top, shape (size, size)."""
    # Forward is down, left is west, up is north.
    rotation = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    views = Views(
        position=np.array([[*middle, EYE]]),
        rotation=rotation[None],
        world=np.zeros(1, np.int32),
        subject=np.full(1, -1, np.int32),
        field_of_view=2.0 * math.atan(REACH / EYE),
    )
    picture = Picture.create(1, size, size, rgb=False, depth=True, class_id=True)
    StillWorld(assets).draw(views, 0.0, picture)
    assert picture.class_id is not None
    assert picture.depth is not None
    return picture.class_id[0], picture.depth[0]


_CAR = kind_index(VehicleType.PASSENGER)


class DemoSimulation(Simulation):
    """A simulation whose parked car has the look of the original's."""

    def __init__(self, config: SimConfig, assets: Assets, parked: int) -> None:
        super().__init__(config, assets, tracker_in(config, assets), together(1))
        self._parked = parked

    def reset(self, trackers: None = None) -> None:  # type: ignore[override]
        """Begin a new episode; see `Simulation.reset`."""
        super().reset(trackers)
        if self._parked >= 0:
            self._worlds.dress(0, self._parked, models_of(_CAR).start, COLOUR)


class DemoWorld(NamedTuple):
    """One drone in one world."""

    simulation: Simulation
    assets: Assets
    parked: int  # Actor that is the parked car; -1: there is none


def build_world(config: EyasConfig, vehicles: int) -> DemoWorld:
    """Return the world of a configuration.

    Args:
        vehicles: Largest number of vehicles that drive.

    Raises:
        EyasError: A setting is not supported, or no traffic matches the settings.
    """
    crowd = crowd_of(config, trackers=1)
    assets = load_assets(config.world, config.traffic, crowd=crowd)
    motion = assets.traffic.motion
    driven = np.isin(motion.kind, [kind_index(kind.name) for kind in VEHICLE_KINDS])
    kept = ~driven | (np.cumsum(driven) <= vehicles)
    whole = motion._replace(start=motion.start[:, kept], kind=motion.kind[kept])
    targets, parked = _followed(crowd, whole.kind, driven[kept]), -1
    if crowd.follows_vehicles:
        car = parked_car(assets, motion.samples, motion.rate)
        if car is not None:
            parked = len(whole.kind)
            whole, targets = joined([whole, car]), np.append(targets, True)
    traffic = Replay(whole._replace(start=np.ascontiguousarray(whole.start)), targets)
    own = replace(assets, traffic=traffic, rigs=Rigs(whole.kind))
    return DemoWorld(DemoSimulation(config, own, parked), own, parked)


def _followed(
    crowd: Crowd, kinds: NDArray[np.int32], driven: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return which actors an episode may choose as its target, shape (A,)."""
    if crowd.follows_vehicles:
        return driven
    if crowd.custom is not None:
        return ~driven
    asked: NDArray[np.bool_] = kinds == kind_index(crowd.target.value)
    return asked


_FAR = 30.0  # Distance from which on a pilot does not fly to a target, but appears there [m]
_WARNING = 1000  # Physics steps before the end of the traffic at which it begins anew


class DemoFlight:
    """A drone, its target and its world.

    Attributes:
        config: The settings; those of the reward change while it flies.
        seed: The seed of its episodes.
        world: Simulation and map.

    Args:
        vehicles: Largest number of vehicles that drive.

    Raises:
        EyasError: The world cannot be built.
    """

    def __init__(self, config: EyasConfig, vehicles: int) -> None:
        self.config, self.vehicles, self.seed = config, vehicles, config.seed
        self.world = build_world(config, vehicles)
        self.simulation = self.world.simulation
        self._start_pitch = 0.0
        self.simulation.reset()
        self._begin(self.world.parked)

    @property
    def target(self) -> int:
        """The actor that is followed."""
        return int(self.simulation.snapshot.targets.actor[0])

    def reset(self, seed: int | None = None) -> None:
        """Put the drone back over its target, or begin the one episode of a seed."""
        target = self.target
        if seed is not None:
            self.seed = seed
            self.simulation.reseed(seed)
            self.simulation.rewind()
        self.simulation.reset()
        if seed is None:
            self._begin(target)
        elif self.target == self.world.parked:
            self.follow_next()
            self._begin(self.target)

    def _begin(self, target: int) -> None:
        """Begin over a target."""
        if target >= 0:
            self.simulation.follow(0, target)
        # In one step it comes to its place, in the next it has no speed.
        self.simulation.carry(2)
        self.simulation.restart_count(0)
        self._start_pitch = float(self.simulation.snapshot.trackers.commanded_gimbal[0, 0])

    def fly(self, command: NDArray[np.float64], steps: int, held: Held) -> None:
        """Hold a command, see `Simulation.advance`, and turn the camera by the held controls."""
        self._aim(held, steps)
        self.simulation.advance(command, steps)
        if self.simulation.steps_left < _WARNING:
            self.simulation.rewind()
            self.reset()

    def _aim(self, held: Held, steps: int) -> None:
        angles = self.simulation.snapshot.trackers.commanded_gimbal.copy()
        if Control.CAMERA_CENTRE in held:
            angles[0] = self._start_pitch, 0.0
        pitch, yaw = camera_turn(held)
        if pitch:
            angles[0, 0] = np.clip(angles[0, 0] + steps * pitch, *CAMERA_PITCH)
        if yaw:
            angles[0, 1] = np.clip(angles[0, 1] + steps * yaw, *CAMERA_YAW)
        self.simulation.command_gimbal(angles)

    def follow(self, actor: int) -> None:
        """Make an actor the target.

        Raises:
            SpawnError: There is no such actor.
        """
        self.simulation.follow(0, actor)

    def appear(self) -> bool:
        """Put the drone over its target if that is far away; return whether it was.

        A pilot that flies straight to it would come through houses.
        """
        actors, _ = self.simulation.actors_around(0)
        drone = self.simulation.snapshot.trackers.position[0]
        apart = actors.position[0, self.target, :2] - drone[:2]
        if np.hypot(*apart) <= _FAR:
            return False
        self.reset()
        return True

    def follow_next(self) -> None:
        """Make the next actor that is in the world the target."""
        state, _ = self.simulation.actors_around(0)
        here = np.flatnonzero(state.present[0])
        later = here[here > self.target]
        if len(here):
            self.follow(int(later[0] if len(later) else here[0]))

    def change_reward(self, said: RewardMessage) -> None:
        """Change settings of the reward, from the next step on."""
        self.config = updated(self.config, {"reward": said.model_dump(exclude_none=True)})
        self._obey()

    def adopt_reward(self, other: "DemoFlight") -> None:
        """Take the settings of the reward that sliders have changed in another flight."""
        self.config = self.config.model_copy(update={"reward": other.config.reward})
        self._obey()

    def _obey(self) -> None:
        config = self.config
        rules = make_rules(config.reward, config.done, config.camera)
        self.simulation.rules = rules if self.simulation.judged else lenient(rules)
