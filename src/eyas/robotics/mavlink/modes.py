"""Flight modes, by the numbers of PX4 (src/modules/commander/px4_custom_mode.h)."""

from enum import Enum


class Mode(Enum):
    """A flight mode: PX4's main mode and sub mode."""

    POSITION = (3, 0)  # A stick moves it
    TAKEOFF = (4, 2)
    HOLD = (4, 3)
    RETURN = (4, 5)
    LAND = (4, 6)
    FOLLOW = (4, 8)  # It follows what `FOLLOW_TARGET` tells
    OFFBOARD = (6, 0)  # A program outside tells where or how fast to fly

    @property
    def custom(self) -> int:
        """The mode as `HEARTBEAT.custom_mode`."""
        main, sub = self.value
        return main << 16 | sub << 24

    @property
    def automatic(self) -> bool:
        """Whether it goes on without a ground station."""
        return self in (Mode.TAKEOFF, Mode.HOLD, Mode.RETURN, Mode.LAND)

    @classmethod
    def of(cls, main: int, sub: int) -> "Mode | None":
        """Return the mode of PX4's numbers; None if there is none here."""
        return next((mode for mode in cls if mode.value == (main, sub)), None)


class Landed(Enum):
    """Whether a vehicle stands or flies, by MAVLink's `MAV_LANDED_STATE`."""

    GROUND = 1
    AIR = 2
    TAKEOFF = 3
    LANDING = 4
