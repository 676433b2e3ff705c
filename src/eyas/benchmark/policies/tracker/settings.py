"""Settings of the tracker; they stand in the file of its network."""

from typing import Annotated

from pydantic import Field

from eyas.engine.core.config import Config

Positive = Annotated[float, Field(gt=0.0, le=1e3)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class TrackerSettings(Config):
    """Where the camera is, how targets move, and when the network is believed."""

    height: Positive = 22.0
    """Height of the drone above the target's centre at the start [m]."""
    pitch: Annotated[float, Field(gt=0.0, le=1.6)] = 1.37
    """Pitch of the camera, positive down [rad]."""
    small: Positive = 1.0
    """A target whose first box has a smaller area than the square of this walks [m]."""
    acceleration: Positive = 4.0
    """Standard deviation of a vehicle's acceleration, each axis [m/s^2]."""
    lasting: Positive = 1.0
    """Time constant of an acceleration [s]."""
    speed: Positive = 8.0
    """Standard deviation of a vehicle's velocity at the start, each axis [m/s]."""
    walking_acceleration: Positive = 2.0
    """Standard deviation of a walker's acceleration, each axis [m/s^2]."""
    walking_speed: Positive = 1.5
    """Standard deviation of a walker's velocity at the start, each axis [m/s]."""
    widest: Positive = 8.0
    """Largest standard deviation of a place [m]."""
    floor: Positive = 0.5
    """Standard deviation of what the filter does not know of, which the network is told too [m]."""
    doubt: Positive = 2.5
    """Factor of what the network says of a place that it finds, a standard deviation. Its mistakes
    last for several looks, which the filter takes for independent: without the factor it would
    follow them."""
    noise: Positive = 0.5
    """Standard deviation of such a place, besides that [m]."""
    unsure: Positive = 2.5
    """Factor of what the network says of a course, a standard deviation: drivers surprise."""
    drift: Positive = 0.3
    """Standard deviation of what it does not say of one, grows by this in a second [m/s]."""
    believed: Share = 0.5
    """Least probability of one place, with those around it, at which the filter takes it."""
    remembered: Share = 0.9
    """Least probability at which the memory of the target is renewed."""
    gate: Positive = 3.0
    """Largest distance of a place from the expected one, in standard deviations."""
    straight: Positive = 45.0
    """How far a target is followed unseen, straight on; there it is waited for [m]."""
    gain: Share = 0.6
    """Share of the distance from the middle that an action makes up for."""

    lag: Annotated[float, Field(ge=0.0, le=1e3)] = 0.0
    """Time constant with which the place to which its commands lead a drone is taken to be where it
    is [s]; 0: at once, as supervised ones are."""


FLOWN = TrackerSettings(gain=0.05, lag=2.0)
"""For a drone that its flight controller flies: it cannot follow commands at once, so that a larger
gain, or steering where it is, makes it swing about its target."""
