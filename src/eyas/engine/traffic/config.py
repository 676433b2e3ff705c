"""Settings of the traffic."""

from enum import StrEnum
from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from eyas.engine.core.config import Config

Unit = Annotated[float, Field(ge=0, le=1)]
Least = Annotated[float, Field(ge=0, le=1e9)]
Most = Annotated[float, Field(gt=0, le=1e9)]
Share = Annotated[float, Field(ge=0, le=1e6)]


class VehicleType(StrEnum):
    """SUMO vehicle classes."""

    PASSENGER = "passenger"
    BUS = "bus"
    TRUCK = "truck"
    TRAILER = "trailer"
    MOTORCYCLE = "motorcycle"


class Mix(Config):
    """Classes of vehicles that share the roads, each with its share of them."""

    notation: ClassVar[str] = '{"passenger": 0.8, "bus": 0.2}'
    passenger: Share = 0.0
    bus: Share = 0.0
    truck: Share = 0.0
    trailer: Share = 0.0
    motorcycle: Share = 0.0

    @model_validator(mode="after")
    def _not_empty(self) -> "Mix":
        if not any(self.shares.values()):
            raise ValueError("it must hold a number above 0")
        return self

    @property
    def shares(self) -> dict[VehicleType, float]:
        """Share of each class, in the user's own unit."""
        return {name: getattr(self, name.value) for name in VehicleType}


class Source(StrEnum):
    """Where the traffic comes from."""

    RECORDED = "recorded"  # A recording is replayed
    LIVE = "live"  # SUMO drives in this process, a little ahead of the trackers


class Demand(StrEnum):
    """When vehicles enter and leave."""

    KEEP_ALIVE = "keep_alive"
    """All vehicles are present from the start and never leave; of those on streets that no recipe
    has drawn, which lead out, some do, and others enter."""
    RESPAWN = "respawn"
    """Groups of vehicles enter at intervals, drive a route and leave, and all start and brake in an
    instant, as in the original."""


class Drivers(StrEnum):
    """How drivers behave."""

    NORMAL = "normal"  # As SUMO's do
    HIDING = "hiding"  # Now and then one stays for a few seconds under what hides it from above
    EVADING = "evading"
    """Drivers of cars want to be lost: they brake, dash, weave, turn back, and hide."""


class Lamps(StrEnum):
    """What vehicles signal with their lamps."""

    DARK = "dark"  # Nothing; head and tail lamps shine when it is dark
    WORKING = "working"  # Brake lamps are lit, indicators blink, by day too


class Signals(StrEnum):
    """What the traffic lights of our own maps show; those of imported towns always work."""

    AMBER = "amber"  # Amber, and nobody heeds them
    WORKING = "working"  # Red, amber and green, which drivers obey


class TrafficConfig(Config):
    """Settings of the traffic that SUMO simulates; `traffic=live` is short for its `source`."""

    named_by: ClassVar[str] = "source"
    source: Source = Source.RECORDED
    """`recorded`: a recording is replayed; `live`: SUMO drives in this process, see
    docs/traffic.md. `traffic=live` is short for it."""
    demand: Demand = Demand.KEEP_ALIVE
    """`keep_alive`: all vehicles keep driving (on imported maps, whose streets lead out, some
    leave and others enter); `respawn`: groups enter, drive a route and leave, and start and brake
    in an instant, as in the original."""
    drivers: Drivers = Drivers.NORMAL
    """`normal`: as SUMO's; `hiding`: now and then one stays for seconds under what hides it from
    above; `evading`: drivers of cars brake, dash, weave, turn back and hide. The last two need
    `keep_alive`, see docs/traffic.md."""
    vehicle_type: VehicleType | Mix = VehicleType.PASSENGER
    """Class of all vehicles, or the share of each class: `{"passenger": 0.8, "bus": 0.2}`."""
    max_vehicles: Annotated[int, Field(ge=1, le=1000)] = 40
    """Largest number of vehicles at a time."""
    max_speed: Annotated[float, Field(ge=0.1, le=100)] = 20.0
    """Largest speed of a vehicle [m/s]; the speed limits of the roads apply too."""
    max_acceleration: Annotated[float, Field(ge=0.1, le=100)] = 25.0
    """[m/s^2]"""
    max_deceleration: Annotated[float, Field(ge=0.1, le=100)] = 25.0
    """[m/s^2]"""
    group_size: Annotated[int, Field(ge=1, le=1000)] | None = None
    """Vehicles that enter together (respawn), at least three for each tracker of a world; None:
    three for each. Where the number of trackers decides, the next larger groups that are shipped
    are taken (3, 5, 10, 12, 40), and above three quarters of `max_vehicles` none leaves."""
    group_interval: Annotated[float, Field(ge=0.1, le=3600)] = 52.0
    """Time between groups (respawn) [s]."""
    route_length: tuple[Least, Most] = (500.0, 7000.0)
    """Shortest and longest route (respawn) [m]."""
    route_count: Annotated[int, Field(ge=1, le=10_000_000)] = 100_000
    """Largest number of routes sampled (respawn)."""
    update_routes: bool = True
    """The original's `rou_update`. A recording is reused while it fits in any case; with False,
    a line says that a new one was made all the same."""
    seed: Annotated[int, Field(ge=0, lt=2**31)] | None = None
    """Seed of SUMO and of the routes; None: the seed of the shipped recording."""
    colour: tuple[Unit, Unit, Unit] | None = None
    """Body colour of every car, RGB 0 to 1; None: sampled for each car."""
    signals: Signals | None = None
    """What the traffic lights of our own maps show; those of imported towns always work. None:
    working with a recording whose drivers obey them, as the usual ones are on maps with traffic
    lights, and with live traffic there; else amber."""
    lamps: Lamps = Lamps.WORKING
    """`working`: brake lamps are lit and indicators blink, by day too, see docs/traffic.md."""
    recording: str | None = None
    """Path of a recording to replay; None: a shipped or cached recording that fits."""

    @model_validator(mode="after")
    def _ordered(self) -> "TrafficConfig":
        low, high = self.route_length
        if low >= high:
            raise ValueError("route_length must hold the shortest and then the longest")
        if self.source is Source.LIVE and self.recording is not None:
            raise ValueError("recording must be left out where source is 'live'")
        if self.drivers is not Drivers.NORMAL and self.demand is not Demand.KEEP_ALIVE:
            raise ValueError("drivers must be 'normal' where demand is 'respawn'")
        return self
