"""A battery: what it still holds, how its voltage sags, and what thrust that leaves the rotors.

An open-circuit voltage that depends on the charge, behind a resistance: the static part of the
model of Chen and Rincon-Mora, "Accurate electrical battery model capable of predicting runtime and
I-V performance" (IEEE Transactions on Energy Conversion 21, 2006).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.trackers.airframe import Airframe
from eyas.engine.trackers.rigid_body import Thrusts
from eyas.lanes import kernel
from eyas.lanes.elementary import exp

FULL_CELL = 4.1031  # Voltage of a full cell without a load, see `open_voltage` [V]


class Battery(NamedTuple):
    """Constants of a battery, and of what it drives."""

    cells: float = 0.0
    """Number of cells in a row; 0: there is no battery, and what there is lasts for ever."""
    capacity: float = 1.0  # [A h]
    resistance: float = 0.0  # Of all cells and the wires [ohm]
    efficiency: float = 0.8
    """Mechanical power of the rotors over electrical power: motors and their controllers; our
    choice, typical of both together."""
    idle: float = 10.0  # Power of everything but the rotors [W]; our choice
    fastest: float = 1000.0
    """Rate of the rotors that full cells reach without sagging; at less voltage, in proportion
    less [rad/s]."""
    charge: float = 1.0  # Charge with which an episode begins, of 1


@kernel
def open_voltage(
    charge: float,  # From 0 to 1
) -> float:
    """Return the voltage of a cell without a load [V].

    The fit of Chen and Rincon-Mora (2006) to cells of lithium-ion polymer.
    """
    curve = 0.2156 + charge * (-0.1178 + charge * 0.3201)
    return 3.685 + charge * curve - 1.031 * exp(-35.0 * charge)


@kernel
def strongest_thrust(frame: Airframe, battery: Battery, charge: float, voltage: float) -> float:
    """Return the largest thrust of a rotor at a voltage [N]; an empty battery gives none."""
    if charge <= 0.0:
        return 0.0
    rate = battery.fastest * voltage / (FULL_CELL * battery.cells)
    return min(frame.thrust_constant * rate * rate, _most(frame))


@kernel
def _most(frame: Airframe) -> float:
    return frame.thrust_constant * frame.rotor_limit * frame.rotor_limit


@kernel
def within_power(thrusts: Thrusts, most: float) -> Thrusts:
    """Return thrusts of which none is more than the largest possible one [N].

    All are lowered by what one has too much, which keeps the torque, as flight controllers do; none
    below 0.
    """
    a, b, c, d = thrusts
    excess = max(0.0, max(max(a, b), max(c, d)) - most)
    return (max(0.0, a - excess), max(0.0, b - excess), max(0.0, c - excess), max(0.0, d - excess))


@kernel
def discharge(
    frame: Airframe,  # The constants of its rotors are used
    battery: Battery,
    charge: NDArray[np.float64],  # Of N batteries, of 1; updated
    voltage: NDArray[np.float64],  # Of N batteries under their load [V]; set
    n: int,  # Index of the drone
    thrusts: Thrusts,  # Of the rotors, without what the ground adds [N]
) -> None:
    """Take what the rotors of drone `n` need in a step of 2 ms from its battery."""
    power = 0.0
    for thrust in thrusts:
        power += thrust * math.sqrt(thrust / frame.thrust_constant)
    power *= frame.torque_constant / (frame.thrust_constant * battery.efficiency)
    power += battery.idle
    source = battery.cells * open_voltage(charge[n])
    # The current that gives this power, or the most that the resistance allows.
    under_root = max(0.0, source * source - 4.0 * battery.resistance * power)
    voltage[n] = 0.5 * (source + math.sqrt(under_root))
    used = power / voltage[n] * PHYSICS_STEP / (3600.0 * battery.capacity)
    charge[n] = max(0.0, charge[n] - used)
