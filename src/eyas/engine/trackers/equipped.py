"""The flown drone with what it carries: `eyas.engine.trackers.flown`, with more in its step.

Only a drone with such an option flies by these kernels, so it costs others nothing.
"""

import math
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.engine.trackers.airframes import AirframeModel
from eyas.engine.trackers.battery import (
    Battery,
    discharge,
    open_voltage,
    strongest_thrust,
    within_power,
)
from eyas.engine.trackers.commands import follow_command
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.equipment import MOUNTED, Equipment, Part, loaded
from eyas.engine.trackers.flown import (
    FlightMemory,
    air_around,
    arrive,
    body_of,
    flown_drone,
    wanted_thrusts,
    with_options,
)
from eyas.engine.trackers.flown import aim as aim_flown
from eyas.engine.trackers.flown import carry as carry_flown
from eyas.engine.trackers.flown import start as start_flown
from eyas.engine.trackers.ground_effect import ROTOR_HEIGHT, ground_effect
from eyas.engine.trackers.loaded_body import moved_with_load
from eyas.engine.trackers.rigid_body import Thrusts, spun_up
from eyas.engine.trackers.steady import launch as launch_flown
from eyas.engine.trackers.tracker import ROTORS, Tracker
from eyas.engine.trackers.wind_field import OPEN, WindField, wind_among
from eyas.lanes import kernel

Vector = tuple[float, float, float]

_BATTERY = {"battery": "charge", "battery_voltage": "voltage"}
_ROTORS = {ROTORS: "asked"}


class EquippedMemory(NamedTuple):
    """What N flown drones with equipment remember."""

    flight: FlightMemory
    equipment: Equipment
    charge: NDArray[np.float64]  # Of their batteries, of 1, shape (N,)
    field: WindField  # The mean wind among buildings
    asked: NDArray[np.float64]  # Rates that the controller asks of the rotors [rad/s], shape (N, 4)
    voltage: NDArray[np.float64]
    """Of their batteries under load [V], shape (N,); 0 without batteries."""

    @classmethod
    def create(
        cls,
        equipment: Equipment,
        turbulence: float,
        count: int,
        terrain: Terrain,
        field: WindField = OPEN,
    ) -> "EquippedMemory":
        """Return the memory of drones at rest."""
        flight = FlightMemory.create(equipment.frame, turbulence, count, terrain)
        return cls(
            flight,
            equipment,
            charge=np.ones(count),
            field=field,
            asked=np.zeros((count, 4)),
            voltage=np.zeros(count),
        )


@kernel(inline=True)
def start(
    trackers: TrackerState,
    memory: EquippedMemory,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Place drone `n` at rest, see `Tracker.start`."""
    start_flown(trackers, memory.flight, n, x, y, z, yaw, pitch)
    battery = memory.equipment.battery
    memory.charge[n] = battery.charge
    memory.voltage[n] = battery.cells * open_voltage(battery.charge)


@kernel(inline=True)
def launch(
    trackers: TrackerState, memory: EquippedMemory, n: int, east: float, north: float
) -> None:
    """Let drone `n` fly on at a velocity, see `Tracker.launch`.

    What pulls its centre of mass aside tilts it only then: it begins as if that were its middle.
    """
    launch_flown(trackers, memory.flight, n, east, north)


@kernel(inline=True)
def carry(
    trackers: TrackerState, memory: EquippedMemory, n: int, x: float, y: float, z: float, yaw: float
) -> None:
    """Move a level drone to a pose within one physics step."""
    carry_flown(trackers, memory.flight, n, x, y, z, yaw)


@kernel(inline=True)
def advance(
    trackers: TrackerState, memory: EquippedMemory, n: int, command: NDArray[np.float64]
) -> None:
    """Fly drone `n` for one physics step of 2 ms, see `Tracker.advance`."""
    flight, equipment = memory.flight, memory.equipment
    east, north, _ = follow_command(trackers, flight.filters, n, command)
    wanted = wanted_thrusts(trackers, flight, n, east, north)
    frame, battery, before = flight.frame, equipment.battery, body_of(trackers, n)
    if battery.cells > 0.0:
        most = strongest_thrust(frame, battery, memory.charge[n], memory.voltage[n])
        wanted = within_power(wanted, most)
    for rotor in range(4):
        memory.asked[n, rotor] = math.sqrt(wanted[rotor] / frame.thrust_constant)
    pushed = spun_up(frame, flight.rotor[n], wanted)
    if battery.cells > 0.0:
        discharge(frame, battery, memory.charge, memory.voltage, n, pushed[2])
    if equipment.radius > 0.0:
        x, y, z = before.position
        height = z + ROTOR_HEIGHT - ground_at(flight.terrain, x, y)
        share = ground_effect(frame, equipment.radius, height)
        pushed = _times(pushed[0], share), _times(pushed[1], share), _times(pushed[2], share)
    air = air_around(flight, n, before)
    if memory.field.known == 1:
        air = _among(memory, n, before.position, air)
    after = moved_with_load(equipment, before, pushed, air, flight.terrain, PHYSICS_STEP)
    arrive(trackers, flight, n, before, after)


@kernel
def _among(
    memory: EquippedMemory,  # Wind and ground are read
    n: int,  # Index of the drone
    place: Vector,  # Of the drone, world frame [m]
    air: Vector,  # The wind, with the same mean wind everywhere [m/s]
) -> Vector:
    """Return the wind at a place with the mean wind there [m/s]."""
    flight, x, y = memory.flight, place[0], place[1]
    (east, north), along = flight.wind.mean[n], flight.wind.along[n]
    speed = math.sqrt(east * east + north * north)
    height = place[2] - ground_at(flight.terrain, x, y)
    a, b, c = wind_among(memory.field, along[0], along[1], x, y, height)
    return air[0] - east + speed * a, air[1] - north + speed * b, air[2] + speed * c


@kernel
def _times(thrusts: Thrusts, share: float) -> Thrusts:
    return share * thrusts[0], share * thrusts[1], share * thrusts[2], share * thrusts[3]


@kernel(inline=True)
def aim(trackers: TrackerState, memory: EquippedMemory, cameras: CameraState, n: int) -> None:
    """Write the pose of the camera on the gimbal."""
    aim_flown(trackers, memory.flight, cameras, n)


def is_equipped(config: TrackerConfig) -> bool:
    """Return whether a flown drone has an option that these kernels fly."""
    carries = config.off_centre or config.payload.mass > 0.0
    carries = carries or config.wind.buildings
    return carries or config.tells_rotors or config.ground_effect or config.battery.enabled


def equipped_drone(
    config: TrackerConfig,  # The options
    model: AirframeModel,  # The drone with its gimbal and lidar; options replace its own constants
) -> Tracker:
    """Return the flown drone with what it carries."""
    equipment = _equipment(config, model)
    plain = flown_drone(config, model.frame)
    draw = plain.sample

    def sample(memory: EquippedMemory, n: int, key: EpisodeKey) -> None:
        assert draw is not None
        draw(memory.flight, n, key)

    return replace(
        plain,
        memory=partial(EquippedMemory.create, equipment, float(config.wind.turbulence)),
        start=start,
        advance=advance,
        carry=carry,
        aim=aim,
        launch=launch,
        sample=None if draw is None else sample,
        sampled="flight.wind",
        told=(_BATTERY if config.battery.enabled else {})
        | (_ROTORS if config.tells_rotors else {}),
    )


def _equipment(config: TrackerConfig, model: AirframeModel) -> Equipment:
    """Return what a drone of some settings carries."""
    parts: list[Part] = []
    frame, payload = with_options(config, model.frame), config.payload
    if config.off_centre:
        parts += MOUNTED
        frame = frame._replace(mass=frame.mass - sum(part.mass for part in MOUNTED))
    if payload.mass > 0.0:
        parts.append(Part(float(payload.mass), payload.position))
    battery = model.battery._replace(charge=float(config.battery.charge))
    return loaded(frame, parts)._replace(
        radius=model.radius if config.ground_effect else 0.0,
        battery=battery if config.battery.enabled else Battery(),
    )
