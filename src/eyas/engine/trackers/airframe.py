"""The constants of the flown drone, which its kernels read.

They are those of body, rotors, flight controller and gimbal; besides, there is what is optional.
The values are those of the drone `M100` of the DAT benchmark and of its flight controller, unless
their text names another source.
"""

from typing import NamedTuple

Vector = tuple[float, float, float]


class GimbalServo(NamedTuple):
    """The three motors of the gimbal; each number for roll, pitch, yaw."""

    proportional: Vector = (2.0, 4.0, 4.0)  # Torque for an error of the angle [N m/rad]
    integral: Vector = (0.02, 0.02, 0.02)  # Torque for an error that lasts [N m/(rad s)]
    derivative: Vector = (0.0005, 0.001, 0.001)  # Torque against a rate of the joint [N m s/rad]
    integral_limit: float = 0.1  # Largest torque of the integral part [N m]
    torque_limit: float = 1.0  # Largest torque [N m]; the motors would reach 3
    damping: float = 0.001  # Torque of the joint against its rate [N m s/rad]
    rate_limit: float = 35.0  # Largest rate of a joint [rad/s]
    inertia: Vector = (1e-5, 2e-5, 4e-5)
    """Moment of inertia of what each joint moves [kg m^2]. An estimate: a body of 33 g and 4 cm has
    0.9e-5; the pitch joint moves two, the yaw joint three. The original does not state it."""


class Airframe(NamedTuple):
    """Constants of a quadrotor with rotors at (+-arm, +-arm), body frame."""

    mass: float = 3.0069
    """Of the body (2.70703), three links of the gimbal (0.0333 each) and the lidar (0.2) [kg]."""
    inertia: Vector = (0.0341171, 0.0363089, 0.0627386)
    """Principal moments of inertia, about x, y, z [kg m^2]; those of gimbal and lidar are left out,
    and the centre of mass is the origin."""
    gravity: float = 9.81  # [m/s^2]
    arm: float = 0.22978  # Distance of the rotors from the body's middle along x and along y [m]
    thrust_constant: float = 2.55e-5  # Thrust of a rotor over its squared rate [N s^2/rad^2]
    torque_constant: float = 5.1e-7
    """Torque about z of a rotor over its squared rate [N m s^2/rad^2]."""
    rotor_limit: float = 10_000.0  # Largest rate of a rotor [rad/s]

    position_gain: Vector = (8.0, 8.0, 17.0)  # Force for an error of position, world frame [N/m]
    velocity_gain: float = 10.0  # Force for an error of velocity [N s/m]
    assumed_mass: float = 3.0  # Mass that the controller takes the drone to have [kg]
    assumed_gravity: float = 9.8  # Gravity that the controller assumes [m/s^2]
    tilt_limit: float = 0.6283185307179586  # Largest commanded tilt, pi / 5 [rad]
    attitude_gain: Vector = (4.0, 4.0, 2.0)
    """Torque for an error of attitude, about x, y, z [N m/rad]."""
    rate_gain: float = 0.7  # Torque against a turn rate [N m s/rad]

    servo: GimbalServo = GimbalServo()
    as_original: int = 0
    """1: mixer and gimbal act as in the original's code where they are at a limit; 0: mended, see
    `eyas.engine.trackers.config.Flight`."""

    motor_time_constant: float = 0.0
    """With which rotors reach their commanded rates [s]; 0: at once, as in the original."""
    drag_area: float = 0.0  # Drag coefficient times area [m^2]; 0: no drag, as in the original
    air_density: float = 1.225  # Of the International Standard Atmosphere at sea level [kg/m^3]
    feet: float = 0.183
    """Height of the middle over the feet, half the height of the original's bounding box [m]. There
    is one below each rotor."""
    contact_stiffness: float = 0.0
    """Force of the ground on a foot over its depth [N/m]; 0: the drone passes through it."""
    contact_damping: float = 60.0
    """The same over the rate of sinking [N s/m]; our choice, 0.8 of critical damping."""
    contact_friction: float = 0.8
    """Largest horizontal over vertical force of a foot; our choice, rubber on a road."""


FIRM_GROUND = 2000.0
"""A `contact_stiffness`, our choice: a foot is 4 mm deep when the drone stands [N/m]."""

ORIGINAL = Airframe()  # The original's drone, without any option
