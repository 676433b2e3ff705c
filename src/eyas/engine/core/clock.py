"""Time: physics runs at 500 Hz, and all `*_steps` settings count its 2 ms steps."""

from eyas.engine.core.errors import ConfigError

PHYSICS_RATE = 500  # Physics steps per second [Hz]
PHYSICS_STEP = 1.0 / PHYSICS_RATE  # Length of a physics step [s]; kernels read it


def physics_steps(
    control_frequency: float,  # Actions per second [Hz], 1 to 500
) -> int:
    """Return how many physics steps one action lasts: the whole part of `500 / control_frequency`.

    Raises:
        ConfigError: The frequency is out of range.
    """
    if not 1 <= control_frequency <= PHYSICS_RATE:
        raise ConfigError(
            f"control.frequency: {control_frequency} is out of range; "
            f"allowed: 1 to {PHYSICS_RATE} Hz"
        )
    return int(PHYSICS_RATE / control_frequency)
