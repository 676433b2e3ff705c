"""Drivers who want to be lost: what they do beside driving, carried out by SUMO while it drives.

Each is a generator that is advanced once in each of SUMO's steps, so that a manoeuvre reads from
its beginning to its end. All of it is asked of SUMO (a stop, a speed, a lane, a route): it keeps
the gaps, and refuses what cannot be done, whereupon the driver goes on.
"""

from collections.abc import Generator, Mapping
from functools import partial
from types import ModuleType
from typing import Final

import numpy as np

from eyas.engine.core.rng import stream
from eyas.engine.traffic.config import Drivers, TrafficConfig, VehicleType
from eyas.engine.traffic.cover import Cover, Stretch
from eyas.engine.traffic.demand import RoadLinks, Route, lasting_edges, walk_from
from eyas.lanes import exact

_AHEAD = (15.0, 40.0)
"""Drivers decide to hide where a stretch begins so far ahead: nearer, SUMO could not stop in it
[m]."""

_ROOM = 3.0
"""How much longer than the vehicle a stretch must be: who stands in a shorter one is seen where he
vanished, by a drone that waits there [m]."""

_LONG = 20.0
"""Least length of a stretch for being slow in it: through a shorter one it would be a crawl [m]."""

_LOST = (4.5, 9.0)  # Shortest and longest time for which a driver wants to be hidden [s]

_CRUISE = 12.0  # How fast cars drive here, roughly [m/s]

_NEAR = 25.0  # How far away a larger vehicle may be whose far side a driver takes [m]

_BESIDE = 12.0
"""Least distance along the road to those on the lane that a driver changes to [m]. SUMO itself
lets cars that creep or stand there touch."""

_LARGE = {VehicleType.BUS, VehicleType.TRUCK, VehicleType.TRAILER}

_DASH = 1.45  # Speed of a dash, as a multiple of the limit of the road

_BEFORE_JUNCTION = 40.0
"""Least distance to the junction at which a driver changes lanes or turns back [m]. Nearer, two who
each want the other's lane block both, and SUMO 1.28 crashes where a vehicle is given a route that
turns round less than 10 m ahead."""

_STUCK = 15.0
"""Who has stood for so long without wanting to takes the way that his lane leads to [s]."""

Running = Generator[None, None, None]


class Manoeuvres:
    """What drivers do beside driving."""

    def __init__(
        self,
        sumo: ModuleType,  # The running simulation
        config: TrafficConfig,  # Settings from `eyas.engine.traffic.record.resolved`
        cover: Cover,  # The stretches of lanes that are hidden from above
        links: Mapping[VehicleType, RoadLinks],  # The roads, as each class of vehicles may use them
    ) -> None:
        assert config.seed is not None
        self._sumo, self._links = sumo, links
        self._seed, self._drivers = config.seed, config.drivers
        self._cover: dict[str, list[Stretch]] = {}
        for stretch in cover:
            self._cover.setdefault(stretch.lane, []).append(_in_sumo(sumo, stretch))
        self._running: dict[int, Running] = {}
        self._rng = stream(config.seed, "freed drivers")
        self._time = 0.0

    def advance(
        self,
        time: float,  # Time of SUMO [s]
        vehicles: Mapping[int, VehicleType],  # Class of each vehicle in the world, by its number
    ) -> None:
        """Let all drivers act."""
        self._time, self._classes = time, vehicles
        for number, kind in vehicles.items():
            if number not in self._running:
                self._running[number] = self._driving(number, kind)
            next(self._running[number])
            stood = round(self._sumo.vehicle.getWaitingTime(str(number)), 1)
            if stood > 0.0 and stood % _STUCK == 0.0:
                self._free(str(number), self._links[kind])

    def _free(self, name: str, links: RoadLinks) -> None:
        """Let a vehicle go on where its lane leads, for others stand on the lane that it wants."""
        vehicle, lane = self._sumo.vehicle, self._sumo.vehicle.getLaneID(name)
        road, edges = vehicle.getRoadID(name), lasting_edges(links)
        ways = {self._sumo.lane.getEdgeID(link[0]) for link in self._sumo.lane.getLinks(lane)}
        onward = sorted(ways & set(edges) & set(links.successors.get(road, ())))
        if onward:
            walk = onward_walk(vehicle, name, onward[0], links, edges, self._rng)
            vehicle.setRoute(name, (road, *walk))

    def _driving(self, number: int, kind: VehicleType) -> Running:
        """Return all that a driver does; it never ends."""
        rng = stream(self._seed, "drivers", number)
        driver = DriverProfile(self._sumo, str(number), rng, self)
        if self._drivers is Drivers.HIDING:
            return driver.hiding()
        cars = kind in (VehicleType.PASSENGER, VehicleType.MOTORCYCLE)
        return driver.evading(self._links[kind]) if cars else driver.waiting(float("inf"))

    @property
    def time(self) -> float:
        """Time of SUMO [s]."""
        return self._time

    def ahead(self, lane: str, place: float, length: float) -> Stretch | None:
        """Return a stretch that begins ahead of a place on a lane, with room for a vehicle."""
        for stretch in self._cover.get(lane, ()):
            roomy = stretch.end - stretch.start >= length + _ROOM
            if roomy and _AHEAD[0] <= stretch.start - place <= _AHEAD[1]:
                return stretch
        return None

    def large_near(self, name: str) -> str | None:
        """Return the nearest larger vehicle that drives the same way; None if there is none."""
        here, road = self._sumo.vehicle.getPosition(name), self._sumo.vehicle.getRoadID(name)
        large = [
            str(other)
            for other, kind in self._classes.items()
            if kind in _LARGE and self._sumo.vehicle.getRoadID(str(other)) == road
        ]
        away = {other: _distance(here, self._sumo.vehicle.getPosition(other)) for other in large}
        nearest = min(away, key=away.__getitem__, default=None)
        return nearest if nearest is not None and away[nearest] <= _NEAR else None


class DriverProfile:
    """One driver."""

    def __init__(
        self,
        sumo: ModuleType,  # The running simulation
        name: str,  # SUMO's name of the vehicle
        rng: np.random.Generator,  # Where his decisions come from
        world: Manoeuvres,  # What he knows
    ) -> None:
        self._vehicle: Final = sumo.vehicle
        self._sumo, self._name, self._rng, self._world = sumo, name, rng, world

    def hiding(self) -> Running:
        """Drive, and hide in some of the stretches that come."""
        yield from self.waiting(self._between(0.0, 20.0))
        while True:
            stretch = self._stretch()
            if stretch is None:
                yield
                continue
            yield from self._hide(stretch)
            yield from self.waiting(self._between(5.0, 25.0))

    def evading(self, links: RoadLinks) -> Running:
        """Drive, and do something else every few seconds."""
        turn_back = partial(self._turn_back, links, lasting_edges(links))
        yield from self.waiting(self._between(0.0, 20.0))
        while True:
            stretch, large = self._stretch(), self._world.large_near(self._name)
            if stretch is not None:
                yield from self._hide(stretch)
            elif large is not None:
                yield from self._shelter(large)
            else:
                others = (self._brake, self._dash, self._weave, turn_back, turn_back)
                yield from others[int(self._rng.integers(len(others)))]()
            # Looks out for something to hide behind before the next of the others.
            until = self._world.time + self._between(6.0, 16.0)
            while self._world.time < until and (
                self._stretch() is None or until - self._world.time > 6.0
            ):
                yield

    def waiting(self, time: float) -> Running:
        """Drive on for a time [s]."""
        until = self._world.time + time
        while self._world.time < until:
            yield

    def _hide(self, stretch: Stretch) -> Running:
        """Stay in a stretch for a few seconds: stand, or creep, on the same lane or the next."""
        lost, length = self._between(*_LOST), self._vehicle.getLength(self._name)
        if stretch.end - stretch.start >= _LONG and self._rng.random() < 0.5:
            yield from self._creep(stretch, lost)
            return
        room = stretch.end - stretch.start - length
        place = stretch.start + length + room * self._rng.random()
        edge, _, lane = stretch.lane.rpartition("_")
        standing = max(lost - room / _CRUISE, 3.0)
        if self._asked(self._vehicle.setStop, edge, place, int(lane), standing):
            yield from self.waiting(standing + 4.0)

    def _creep(self, stretch: Stretch, lost: float) -> Running:
        """Drive slowly through a stretch, and maybe leave it on another lane."""
        length = self._vehicle.getLength(self._name)
        through, until = stretch.end - stretch.start, self._world.time + 30.0
        while self._world.time < until and self._place(stretch) < stretch.start + length:
            yield
        self._vehicle.setSpeed(self._name, max((through - length) / lost, 1.0))
        edge, _, lane = stretch.lane.rpartition("_")
        lanes = self._sumo.edge.getLaneNumber(edge)
        if lanes > 1 and self._rng.random() < 0.6:
            other = int(lane) + 1 if int(lane) + 1 < lanes else int(lane) - 1
            self._change_to(other, 2.0)
        until = self._world.time + lost + 2.0
        while self._world.time < until and self._place(stretch) < stretch.end:
            yield
        self._vehicle.setSpeed(self._name, -1.0)

    def _shelter(self, large: str) -> Running:
        """Drive beside a larger vehicle, on its far side, as fast as it drives."""
        lane = self._vehicle.getLaneIndex(large)
        lanes = self._sumo.edge.getLaneNumber(self._vehicle.getRoadID(self._name))
        beside = [other for other in (lane - 1, lane + 1) if 0 <= other < lanes]
        if not beside:
            yield from self._brake()
            return
        far = max(beside, key=lambda other: abs(other - self._vehicle.getLaneIndex(self._name)))
        until = self._world.time + self._between(5.0, 9.0)
        if self._before_junction():
            self._change_to(far, until - self._world.time)
        while self._world.time < until and self._before_junction():
            gap = _ahead_by(self._vehicle, self._name, large)
            self._vehicle.setSpeed(self._name, max(self._vehicle.getSpeed(large) + 0.4 * gap, 0.0))
            yield
        self._vehicle.setSpeed(self._name, -1.0)

    def _brake(self) -> Running:
        """Stand for a moment on the open road; on a junction others would touch it."""
        while not self._before_junction():
            yield
        self._vehicle.setSpeed(self._name, 0.0)
        yield from self.waiting(self._between(2.0, 5.0))
        self._vehicle.setSpeed(self._name, -1.0)

    def _dash(self) -> Running:
        """Drive faster than allowed, as far as the vehicle can."""
        usual = self._vehicle.getSpeedFactor(self._name)
        self._vehicle.setSpeedFactor(self._name, _DASH)
        yield from self.waiting(self._between(5.0, 9.0))
        self._vehicle.setSpeedFactor(self._name, usual)

    def _weave(self) -> Running:
        """Change lanes to and fro."""
        for _ in range(int(self._rng.integers(2, 5))):
            road, lane = self._vehicle.getRoadID(self._name), self._vehicle.getLaneIndex(self._name)
            if self._before_junction() and self._sumo.edge.getLaneNumber(road) > 1:
                other = lane - 1 if lane > 0 else lane + 1
                self._change_to(other, 1.5)
            yield from self.waiting(self._between(1.5, 2.5))

    def _turn_back(self, links: RoadLinks, edges: Route) -> Running:
        """Turn round at the next junction where it can be done, and take another way from there."""
        until = self._world.time + 20.0
        while not (back := self._ways_back() & set(edges)) and self._world.time < until:
            yield
        road = self._vehicle.getRoadID(self._name)
        if back:
            walk = onward_walk(self._vehicle, self._name, min(back), links, edges, self._rng)
            self._asked(self._vehicle.setRoute, (road, *walk))
        while self._vehicle.getRoadID(self._name) == road and self._world.time < until:
            yield

    def _ways_back(self) -> set[str]:
        """Return the roads on which the vehicle is after turning round at the next junction.

        Only from the lane it is on: who must change lanes for it may stand in the way for ever.
        """
        lane = self._vehicle.getLaneID(self._name)
        return _turns(self._sumo, lane) if self._before_junction() else set()

    def _stretch(self) -> Stretch | None:
        lane = self._vehicle.getLaneID(self._name)
        place = self._vehicle.getLanePosition(self._name)
        return self._world.ahead(lane, place, self._vehicle.getLength(self._name))

    def _before_junction(self) -> bool:
        """Return whether the vehicle is on a road, not near its end."""
        lane = self._vehicle.getLaneID(self._name)
        left = self._sumo.lane.getLength(lane) - self._vehicle.getLanePosition(self._name)
        return not lane.startswith(":") and left > _BEFORE_JUNCTION

    def _place(self, stretch: Stretch) -> float:
        """Return how far along the edge of a stretch the vehicle is; infinite on another [m]."""
        if self._vehicle.getRoadID(self._name) != stretch.lane.rpartition("_")[0]:
            return float("inf")
        return float(self._vehicle.getLanePosition(self._name))

    def _change_to(self, index: int, time: float) -> None:
        """Change to another lane of the road for a time [s], if nobody is beside the vehicle."""
        lane, here = self._vehicle.getLaneID(self._name), self._vehicle.getLanePosition(self._name)
        other = f"{lane.rpartition('_')[0]}_{index}"
        beside = self._sumo.lane.getLastStepVehicleIDs(other)
        if all(abs(self._vehicle.getLanePosition(each) - here) > _BESIDE for each in beside):
            self._asked(self._vehicle.changeLane, index, time)

    def _asked(self, command: object, *arguments: object) -> bool:
        """Ask SUMO for something; return whether it can be done."""
        assert callable(command)
        try:
            command(self._name, *arguments)
        except self._sumo.TraCIException:
            return False
        return True

    def _between(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))


def onward_walk(
    vehicle: ModuleType,
    name: str,
    road: str,
    links: RoadLinks,
    edges: Route,
    rng: np.random.Generator,
) -> Route:
    """Return a random walk from the next road, as long as what a vehicle has left to drive."""
    left = vehicle.getRoute(name)[vehicle.getRouteIndex(name) :]
    return walk_from(road, links, edges, sum(links.length[edge] for edge in left), rng)


def _in_sumo(sumo: ModuleType, stretch: Stretch) -> Stretch:
    """Return a stretch in SUMO's lengths: the lanes of an edge are all as long as its middle."""
    shape = np.array(sumo.lane.getShape(stretch.lane))
    drawn = float(np.sum(exact.hypot(*np.diff(shape, axis=0).T)))
    scale = sumo.lane.getLength(stretch.lane) / drawn
    return Stretch(stretch.lane, stretch.start * scale, stretch.end * scale)


def _turns(sumo: ModuleType, lane: str) -> set[str]:
    """Return the roads that one is on after turning round at the end of a lane."""
    links = sumo.lane.getLinks(lane)
    return {sumo.lane.getEdgeID(to) for to, *_, direction, _length in links if direction == "t"}


def _ahead_by(vehicle: ModuleType, name: str, other: str) -> float:
    """Return by how much another vehicle's middle is ahead [m]; 0 on another road."""
    if vehicle.getRoadID(name) != vehicle.getRoadID(other):
        return 0.0
    half = 0.5 * (vehicle.getLength(name) - vehicle.getLength(other))
    return float(vehicle.getLanePosition(other) - vehicle.getLanePosition(name) + half)


def _distance(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    return float(exact.hypot(one[0] - other[0], one[1] - other[1]))
