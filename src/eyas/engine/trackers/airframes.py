"""Drones by size. Each constant names its source; an estimate says so.

The gains of the controller are ours: those of position and velocity are the original's for each kg,
those of attitude give a frequency that the motors can follow, with the original's damping.
"""

from typing import NamedTuple

from eyas.engine.trackers.airframe import ORIGINAL, Airframe
from eyas.engine.trackers.battery import Battery
from eyas.engine.trackers.config import AirframeName

Vector = tuple[float, float, float]


class AirframeModel(NamedTuple):
    """An airframe with its rotors and its battery."""

    frame: Airframe
    radius: float  # Of a rotor [m]
    battery: Battery


def _airframe(
    frame: Airframe,  # The other constants
    frequency: float,  # Natural frequency of its attitude [rad/s]
) -> Airframe:
    """Return an airframe with gains for its mass and inertia."""
    share = frame.mass / ORIGINAL.assumed_mass
    x, y, z = ORIGINAL.position_gain
    roll, pitch, yaw = frame.inertia
    stiff, slow = frequency * frequency, 0.25 * frequency * frequency
    return frame._replace(
        position_gain=(share * x, share * y, share * z),
        velocity_gain=share * ORIGINAL.velocity_gain,
        assumed_mass=frame.mass,
        assumed_gravity=frame.gravity,
        attitude_gain=(stiff * roll, stiff * pitch, slow * yaw),
        rate_gain=1.9 * frequency * 0.5 * (roll + pitch),
    )


_FIVE = _airframe(
    ORIGINAL._replace(
        mass=0.752,
        inertia=(0.0025, 0.0021, 0.0043),
        arm=0.0875,
        thrust_constant=1.562522e-6,
        torque_constant=0.022 * 1.562522e-6,
        rotor_limit=2332.0,
        motor_time_constant=0.033,
        drag_area=0.0418,
        tilt_limit=1.2,
        feet=0.05,
    ),
    frequency=14.0,
)
"""The quadrotor of Agilicious (Foehn et al., "Agilicious: open-source and open-hardware agile
quadrotor for vision-based flight", Science Robotics 7, 2022): mass, inertia, rotor constants, time
constant, 8.5 N for each rotor; its arms, 0.075 and 0.10 m, are taken as equal. The drag area is
an estimate, with which it flies 36 m/s at full thrust. Tilt limit and feet are ours."""

_TEN = _airframe(
    ORIGINAL._replace(
        mass=2.064,
        inertia=(0.02167, 0.02167, 0.04),
        arm=0.174,
        thrust_constant=8.54858e-6,
        torque_constant=0.016 * 8.54858e-6,
        rotor_limit=1000.0,
        motor_time_constant=0.0188,
        drag_area=0.034,
        tilt_limit=0.785,
        feet=0.24,
    ),
    frequency=12.0,
)
"""The Holybro X500 as PX4 simulates it (PX4-gazebo-models, `models/x500`): mass with rotors,
inertia, arms, rotor constants, the mean of its two time constants (12.5 and 25 ms), the drag of its
rotors at 12 m/s, feet. Tilt limit: PX4's `MPC_TILTMAX_AIR`, 45 degrees."""

_TWENTY = _airframe(
    ORIGINAL._replace(
        mass=6.3,
        inertia=(0.150, 0.160, 0.277),
        arm=0.316,
        thrust_constant=1.70e-4,
        torque_constant=0.0258 * 1.70e-4,
        rotor_limit=500.0,
        motor_time_constant=0.05,
        drag_area=0.110,
        tilt_limit=0.524,
        feet=0.25,
    ),
    frequency=9.0,
)
"""The DJI Matrice 300 RTK (its user manual and specifications, 2020): 6.3 kg with two TB60, 895 mm
between opposite rotors, propellers of 21 inches, a tilt of 30 degrees at 23 m/s, from which the
drag area follows, and 55 minutes, from which the torque of its rotors follows. Not published, so
estimates: the inertia is that of the M100 in proportion to mass and size, the thrust constant has
the thrust coefficient 0.068 of the M100's and X500's, rotor limit and time constant are those of
such rotors."""

AIRFRAMES = {
    AirframeName.M100: AirframeModel(
        ORIGINAL,
        0.165,  # 13 inches, as of DJI's M100
        # TB47D; 6 cells of 5 mohm, an estimate; 2.1 kg of a DJI E800, whose motors it has.
        Battery(cells=6.0, capacity=4.5, resistance=0.030, fastest=899.0),
    ),
    AirframeName.INCH_5: AirframeModel(
        _FIVE,
        0.0648,  # 5.1 inches
        # 4 cells of 1.8 Ah, as in the paper; resistance: an estimate.
        Battery(cells=4.0, capacity=1.8, resistance=0.016, fastest=2332.0),
    ),
    AirframeName.INCH_10: AirframeModel(
        _TEN,
        0.127,
        # 4 cells of 5 Ah, the maker's advice; resistance: an estimate.
        Battery(cells=4.0, capacity=5.0, resistance=0.016, fastest=1000.0),
    ),
    AirframeName.INCH_20: AirframeModel(
        _TWENTY,
        0.2667,
        # Two TB60 of 12 cells and 5.935 Ah side by side; resistance: an estimate.
        Battery(cells=12.0, capacity=11.87, resistance=0.030, fastest=500.0, idle=20.0),
    ),
}
"""The airframes by name."""
