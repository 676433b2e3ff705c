"""Targets that are moved by agents or by fixed drivers, one for each tracker."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.evader import EvaderDriver
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.cover import cover_of
from eyas.engine.sim.evader_traffic import EvaderTraffic
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.motion import ActorState, Lamp
from eyas.engine.state.scene import Scene
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.catalogue import MODELS, habit_of, kind_index, models_of
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.kind import HIDDEN
from eyas.engine.traffic.config import Source, VehicleType
from eyas.engine.traffic.steering import TOP_SHARE, Others, SteeredCars, Steps
from eyas.engine.traffic.ways import LEFT, RIGHT, STRAIGHT, Ways, ways_of
from eyas.engine.world.maps import MAPS
from eyas.lanes import exact

_NEAREST: Final = 16  # Actors around a car that its driver heeds
_FAR: Final = 60.0  # The most that a driver is told of distances ahead [m]
_BRAKES: Final = 0.5  # Deceleration from which brake lamps are lit [m/s^2]
_SIGNALS: Final = 40.0  # Distance to the junction from which a driver signals [m]
_CAR: Final = kind_index(VehicleType.PASSENGER)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def evader_assets(config: SimConfig, assets: Assets, count: int) -> EvaderTraffic | None:
    """Return traffic with a target for each of N trackers; None if targets move as recorded.

    Raises:
        ConfigError: The target cannot be moved, or the map has no roads.
    """
    if config.evader.driver is None:
        return None
    problem, allowed = "", ""
    if config.custom is not None:
        problem, allowed = "'custom' targets move by themselves", "no custom"
    elif config.target is TargetName.QUADROTOR:
        problem = "'Quadrotor' cannot be driven"
        allowed = "SUMO_VEHICLE, or a person or robot on foot"
    elif config.traffic.source is Source.LIVE:
        problem, allowed = "traffic.source 'live' decides ahead of time", "recorded"
    elif config.target is TargetName.SUMO_VEHICLE:
        if not len(assets.scene.network.lane_width):
            problem, allowed = f"'{config.world.map}' has no roads", "a map with roads"
        elif _CAR not in assets.traffic.motion.kind:
            problem, allowed = "the traffic has no cars", "traffic.vehicle_type with 'passenger'"
        elif config.start.vehicles not in (None, (VehicleType.PASSENGER,)):
            problem, allowed = "start.vehicles has others than cars", "['passenger'], or null"
    if problem:
        raise ConfigError(f"evader.driver: '{config.evader.driver}': {problem}; allowed: {allowed}")
    walks = config.target is not TargetName.SUMO_VEHICLE
    kind = kind_index(config.target.value) if walks else _CAR
    longest = config.start.warm_up_steps + config.done.total_steps
    return EvaderTraffic(assets.traffic, kind, count, longest, assets.scene.terrain)


class Evaders:
    """Moves the targets of N trackers.

    Attributes:
        seen_names: What an agent is told, in this order.
        low: Smallest numbers of an action, shape (2,).
        high: Largest, shape (2,).
        actions: What each target wants: of a car its speed [m/s] and its turn at the next junction
            (above 1/3: left, below -1/3: right); of a walker its heading, counter-clockwise from
            east [rad], and its speed [m/s], shape (N, 2).
        owner: The tracker for whose target each tracker's is: itself, or the first that follows the
            same, shape (N,).
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        traffic: EvaderTraffic,  # That of the assets
        worlds: Worlds,
        snapshot: Snapshot,
        follow: Callable[[int, int], None],  # Makes an actor the target of a tracker
    ) -> None:
        # Shapes load shapely, which a simulation without targets that act does not need.
        from eyas.engine.behaviours.evading import CAR_SEEN, WALKER_SEEN, FixedDrivers

        count = len(worlds.of)
        self._traffic, self._worlds, self._snapshot = traffic, worlds, snapshot
        self._follow, self._terrain = follow, assets.scene.terrain
        self._walks = config.target is not TargetName.SUMO_VEHICLE
        self.seen_names: Final = WALKER_SEEN if self._walks else CAR_SEEN
        self._walkers: Any = None
        self._cars: Any = None
        if self._walks:
            self._walkers, self._footing_at = _walkers(assets.scene, config.target, count)
            self.low, self.high = np.array([-np.pi, 0.0]), np.array([np.pi, self._walkers.top])
        else:
            place = config.world.map, config.world.seed
            ways, self._hidden = _ways_of(*place)
            self._cars = SteeredCars(ways, count)
            top = TOP_SHARE * float(ways.limit.max())
            self.low, self.high = np.array([0.0, -1.0]), np.array([top, 1.0])
        self.actions = np.zeros((count, 2))
        self.owner = np.arange(count)
        driver = config.evader.driver
        assert driver is not None
        self._fixed: Any = None
        if driver is not EvaderDriver.AGENT:
            self._fixed = FixedDrivers(driver, count, walks=self._walks)
        self._taken = np.full(count, -1, np.int64)  # Recorded actor whose place each has taken
        self._look_of = np.zeros(count, np.int32)  # Its model
        self._length = np.array([model.size[0] for model in MODELS])

    def release(self, trackers: Integers) -> None:
        """Give recorded actors back their places, before new episodes are drawn."""
        for tracker in trackers.tolist():
            if self._taken[tracker] >= 0:
                world = self._worlds.of[tracker]
                self._worlds.looks.model[world, self._taken[tracker]] = self._look_of[tracker]
                self._taken[tracker] = -1

    def begin(self, trackers: Integers, key_of: Callable[[int], EpisodeKey]) -> None:
        """Let the targets take the places of the recorded actors that were drawn."""
        traffic, targets, looks = self._traffic, self._snapshot.targets, self._worlds.looks
        first: dict[tuple[int, int], int] = {}
        for tracker in trackers.tolist():
            world = int(self._worlds.of[tracker])
            actor = int(targets.actor[tracker])
            mates = self._worlds.trackers_of(tracker)
            if actor >= traffic.own:  # a mate's target, which is there already
                self.owner[tracker] = actor - traffic.own
                self._follow(tracker, actor)
                continue
            owner = first.setdefault((world, actor), tracker)
            self.owner[tracker] = owner
            if owner == tracker:
                others = np.setdiff1d(np.arange(len(self.owner)), mates)
                looks.model[world, traffic.own + others] = HIDDEN
                idle = [n for n in mates.tolist() if self._taken[n] < 0]
                looks.model[world, traffic.own + np.array(idle, np.int64)] = HIDDEN
                self._look_of[tracker] = looks.model[world, actor]
                looks.model[world, traffic.own + tracker] = looks.model[world, actor]
                looks.colour[world, traffic.own + tracker] = looks.colour[world, actor]
                looks.model[world, actor], self._taken[tracker] = HIDDEN, actor
                self._worlds.stand_in[traffic.own + tracker] = actor
                tick = self._snapshot.episodes.tick
                if not self._worlds.lasting[world]:
                    # It begins at a sample, up to a tenth of a second sooner than drawn, so that
                    # the targets of a batch decide at the same steps: ten times as fast.
                    tick[tracker] -= tick[tracker] % traffic.ticks
                traffic.take_over(tracker, actor, int(tick[tracker]))
            self._follow(tracker, traffic.own + owner)
        own = np.array(sorted(first.values()), np.int64)
        self._set_out(own)
        if self._fixed is not None and len(own):
            self._fixed.begin(own, key_of)

    def advance(self, steps: int, active: Mask | None) -> None:
        """Decide what the next physics steps of trackers need to know."""
        tick = self._snapshot.episodes.tick
        last = (tick + steps) // self._traffic.ticks + 1
        last = np.minimum(last, self._traffic.motion.samples - 1)
        while True:
            due = (self.owner == np.arange(len(tick))) & (self._traffic.known < last)
            due &= self._taken >= 0
            if active is not None:
                due &= active
            rows = np.flatnonzero(due)
            if not len(rows):
                return
            self._step(rows)

    def act(self, trackers: Integers, actions: Floats) -> None:
        """Set what the targets of trackers want from the next sample on, shapes (K,), (K, 2)."""
        self.actions[self.owner[trackers]] = actions

    def wanted(self, trackers: Integers) -> Floats:
        """Return what the targets of trackers want now, shape (K, 2)."""
        return np.asarray(self.actions[self.owner[trackers]])

    @property
    def ahead_of_time(self) -> bool:
        """Whether decisions depend on nothing that trackers do until the next action."""
        return self._fixed is None

    def observe(self, trackers: Integers) -> Floats:
        """Return what the targets of trackers see, columns `seen_names`, shape (K, C)."""
        rows = self.owner[trackers]
        return self._seen(trackers, rows, None)

    def _set_out(self, rows: Integers) -> None:
        """Begin to move where recorded actors were."""
        if not len(rows):
            return
        pose = self._traffic.pose(rows)
        if self._walks:
            self._walkers.begin(rows, pose.place, pose.yaw, pose.speed)
            self.actions[rows] = np.stack([pose.yaw, pose.speed], axis=1)
            return
        models = self._worlds.looks.model[self._worlds.of[rows], self._traffic.own + rows]
        self._cars.begin(rows, pose.place, pose.yaw, pose.speed, self._length[models])
        self.actions[rows] = np.stack([pose.speed, np.zeros(len(rows))], axis=1)

    def _step(self, rows: Integers) -> None:
        """Decide the next sample of targets."""
        traffic, period = self._traffic, 1.0 / self._traffic.motion.rate
        others = None
        if not self._walks:
            others = self._others(rows, np.asarray(traffic.known[rows] * period, np.float64))
        if self._fixed is not None:
            seen = self._seen(rows, rows, others)
            self.actions[rows] = self._fixed.actions(rows, seen, period)
        wanted = np.clip(self.actions[rows], self.low, self.high)
        lamps = np.zeros(len(rows), np.uint8)
        if self._walks:
            steps: Steps = self._walkers.advance(rows, wanted[:, 0], wanted[:, 1], period)
            height = self._footing_at(steps.place).height
        else:
            turn = _turns(wanted[:, 1])
            before = self._cars.speed[rows].copy()
            assert others is not None
            steps = self._cars.advance(rows, wanted[:, 0], turn, others, period)
            slows = before - self._cars.speed[rows] > _BRAKES * period
            lamps[slows | (self._cars.speed[rows] < 0.1)] |= np.uint8(Lamp.BRAKE)
            near = self._cars.to_junction(rows) < _SIGNALS
            lamps[near & (turn == LEFT)] |= np.uint8(Lamp.LEFT)
            lamps[near & (turn == RIGHT)] |= np.uint8(Lamp.RIGHT)
            height = reliefs(self._terrain, steps.place)
        traffic.write(rows, steps, height, lamps)

    def _others(self, rows: Integers, time: Floats) -> Others:
        """Return who is around cars at the times of each [s]."""
        around = ActorState.create(len(rows), self._traffic.actors)
        self._traffic.at(time, around)
        model = self._worlds.looks.model[self._worlds.of[rows]]
        there = around.present & (model != HIDDEN)
        own = self._traffic.own + rows
        each = np.arange(len(rows))
        there[each, own] = False
        away = around.position[..., :2] - around.position[each, own, None, :2]
        square = np.where(there, exact.dot(away, away), np.inf)
        near = np.argsort(square, axis=1, kind="stable")[:, :_NEAREST]
        each = each[:, None]
        return Others(
            around.position[each, near, :2],
            around.velocity[each, near, :2],
            0.5 * self._length[model[each, near]],
            there[each, near],
        )

    def _seen(self, trackers: Integers, rows: Integers, others: Others | None) -> Floats:
        """Return what targets see of trackers, and of what is around them.

        Args:
            trackers: Shape (K,).
            rows: The trackers whose own these targets are, shape (K,).
            others: What is around them, if that is known already.
        """
        state, targets = self._snapshot.trackers, self._snapshot.targets
        yaw = targets.yaw[trackers]
        cosine, sine = exact.cos(yaw), exact.sin(yaw)

        def in_frame(vector: Floats) -> Floats:
            east, north, up = vector.T
            return np.stack([cosine * east + sine * north, cosine * north - sine * east, up])

        away = in_frame(state.position[trackers] - targets.position[trackers])
        closing = in_frame(state.velocity[trackers] - targets.velocity[trackers])
        view = state.euler[trackers, 2] - yaw
        own = [*away, *closing, exact.cos(view), exact.sin(view), targets.speed[trackers]]
        if self._walks:
            top = np.full(len(rows), self._walkers.top)
            free = self._walkers.free(rows).T
            return np.stack([*own, top, cosine, sine, *free], axis=1)
        cars, turn = self._cars, _turns(self.actions[rows, 1])
        ahead = cars.ahead(rows, turn)
        if others is None:
            others = self._others(rows, self._traffic.known[rows] / self._traffic.motion.rate)
        gap, pace = cars.leader(rows, ahead, others)
        limit = cars.ways.limit[cars.piece[rows]]
        from eyas.engine.behaviours.evading import COVER_AT

        places = np.searchsorted(ahead.distance, COVER_AT)
        cover = self._hidden[ahead.row[:, places]] & (ahead.distance[places] <= ahead.end[:, None])
        gap = np.clip(gap, 0.0, _FAR)
        junction = cars.to_junction(rows)
        open_ = cars.open_ways(rows).T
        return np.stack([*own, limit, junction, *open_, gap, pace, *cover.T], axis=1)


def _turns(wanted: Floats) -> Integers:
    """Return the ways on that drivers want, of numbers from -1, right, to 1, left."""
    return np.where(wanted > 1.0 / 3.0, LEFT, np.where(wanted < -1.0 / 3.0, RIGHT, STRAIGHT))


@lru_cache(maxsize=8)
def _ways_of(map_name: str, seed: int) -> tuple[Ways, Mask]:
    """Return the lanes of a map, and which of their points are hidden from above."""
    network = MAPS.get(map_name).shipped_network(seed)
    if network is None:
        from eyas.engine.sim.scenes import load_network

        network = load_network(map_name, seed)
    ways = ways_of(network)
    hidden = np.zeros(len(ways.place), np.bool_)
    number = {
        f"{network.edges[edge]}_{index}": lane
        for lane, (edge, index) in enumerate(
            zip(network.lane_edge.tolist(), network.lane_index.tolist(), strict=True)
        )
    }
    for stretch in cover_of(map_name, seed):
        lane = number[stretch.lane]
        along = ways.spacing[lane] * np.arange(ways.first[lane + 1] - ways.first[lane])
        inside = (along >= stretch.start) & (along <= stretch.end)
        hidden[ways.first[lane] : ways.first[lane + 1]] |= inside
    return ways, hidden


def _walkers(scene: Scene, target: TargetName, count: int) -> tuple[Any, Any]:
    """Return those who walk, and the ground under them."""
    from eyas.engine.behaviours.ground import ROOM, WalkingGround  # with shapely
    from eyas.engine.behaviours.steering import SteeredWalkers

    ground = WalkingGround(scene, roads=False)
    models = [MODELS[model] for model in models_of(kind_index(target.value))]
    breadth = max(float(exact.hypot(*model.size[:2])) for model in models)
    radius = 0.5 * breadth + ROOM
    walkers = SteeredWalkers(ground.solids, habit_of(target.value), radius, count)
    return walkers, ground.surface.at
