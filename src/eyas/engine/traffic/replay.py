"""Traffic whose whole motion is known in advance."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import ActorState, Motion
from eyas.engine.traffic.interpolation import interpolate_actors
from eyas.engine.traffic.smoothing import runs
from eyas.engine.traffic.source import Stays

ROUNDING: Final = 1e-9  # Tolerance for rounding errors in times that are multiples of 2 ms [s]


class Replay:
    """A motion as a `TrafficSource`.

    Attributes:
        motion: Motion of all actors.

    Args:
        motion: Motion of all actors; its first time must be 0.
        targets: Whether each actor may be a target, shape (A,); None: all.
    """

    live: Final = False

    def __init__(self, motion: Motion, targets: NDArray[np.bool_] | None = None) -> None:
        assert motion.first_time == 0.0, f"motion: begins at {motion.first_time} s"
        self.motion: Final = motion
        present = motion.footing["present"] > 0.0
        followed = range(self.actors) if targets is None else np.flatnonzero(targets).tolist()
        present = present[motion.track["footing"]][motion.places(np.arange(motion.samples))]
        stays = [(actor, *stay) for actor in followed for stay in runs(present[:, actor])]
        who, enters, leaves = np.array(stays, np.int64).reshape(-1, 3).T.copy()
        self._stays = Stays(who, enters / motion.rate, (leaves - 1) / motion.rate, math.inf)

    @property
    def actors(self) -> int:
        """Number of actors."""
        return len(self.motion.kind)

    @property
    def duration(self) -> float:
        """Last time of the traffic [s]; the first is 0."""
        return (self.motion.samples - 1) / self.motion.rate

    def prepare(self, until: float) -> None:
        """Do nothing: everything is known."""

    def close(self) -> None:
        """Do nothing: nothing drives."""

    def at(self, time: NDArray[np.float64], out: ActorState) -> None:
        """Write all actors of W worlds at the time of each world [s], shape (W,)."""
        interpolate_actors(self.motion, time, out)

    def stays(self) -> Stays:
        """Return when each actor that may be a target is in the world."""
        return self._stays


def check_time(time: float, duration: float) -> None:
    """Refuse a time [s] outside traffic of a duration [s].

    Raises:
        ConfigError: The traffic does not last that long.
    """
    if not 0.0 <= time <= duration + ROUNDING:
        raise ConfigError(
            f"traffic: the recording lasts {duration:g} s, but {time:g} s was asked for; "
            "shorten the episode or record more (eyas traffic record --duration)"
        )
