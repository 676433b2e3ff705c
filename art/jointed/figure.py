"""How a person or robot is built and how it moves: what the files of the catalogue write down.

The model frame is x forward, y left, z up, with the origin on the ground. The trunk's frame is the
same while it stands still. Angles: roll about x, pitch about y, yaw about z, so that a positive
pitch lowers what is ahead. A cycle is one stride: every leg steps once.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from art.parts import Shape
from eyas.lanes import exact

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Swing:
    """An angle [rad] or a distance [m] that depends on the cycle.

    rest + lean + size * sin(2 pi (beats * cycle + phase)) while it moves, rest while it stands.
    """

    rest: float = 0.0
    lean: float = 0.0
    size: float = 0.0
    phase: float = 0.0  # [cycles of this oscillation]
    beats: int = 1  # Oscillations in a cycle

    def at(self, cycle: NDArray[np.float64], *, moving: bool) -> NDArray[np.float64]:
        """Return the values at parts of a cycle, shape (K,)."""
        if not moving or self.size == 0.0:  # nearly all
            return np.full(len(cycle), self.rest + self.lean * float(moving))
        wave = exact.sin(2.0 * np.pi * (self.beats * cycle + self.phase))
        return self.rest + (self.lean + self.size * wave)


STILL = Swing()


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A part that turns about a point of another one."""

    name: str
    shape: Shape | None  # None: it is not drawn, but others turn with it
    parent: str = "trunk"
    """Name of another joint, `trunk`, or `ground`: the model frame, which does not sway."""
    pivot: Point = (0.0, 0.0, 0.0)  # Its origin in the frame of its parent [m]
    roll: Swing = STILL
    pitch: Swing = STILL
    yaw: Swing = STILL
    spins: bool = False
    """Whether it rolls about its y axis with the distance travelled, like a wheel."""
    scale: float = 1.0  # Factor on the size of its shape, not on the places of what turns with it
    steers: float = 0.0
    """How far it is ahead of the axle that does not steer [m]; negative behind; 0: no steering."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """A leg of two bones, which follows its foot: no foot slides while it is on the ground.

    The frame of a bone has its origin at the upper end, z along the bone to that end, and x to the
    side to which the knee bends.
    """

    parent: str = "trunk"  # Name of the joint that it is fixed to, or `trunk`
    hip: Point  # Upper end in the frame of its parent [m]
    foot: Point
    """Middle of the lower end while standing, in the model frame; z is the height of the ankle."""
    bones: tuple[float, float]  # Lengths of the upper and the lower bone [m]
    knee: Point  # Direction to which the knee bends, in the frame of the parent
    phase: float
    """Part of the cycle by which it is ahead of a leg that touches the ground at its beginning."""
    shapes: tuple[Shape, Shape, Shape | None]
    """Upper bone, lower bone, and foot; a foot's frame is level, with its origin at the ankle."""
    circle: float | None = None
    """Radius of the circle in which the foot goes round `foot`, once in a cycle, as on a pedal [m];
    0: it stays there, as a hand on handlebars; None: it steps."""
    coxa: tuple[float, Shape] | None = None
    """Length and shape of a bone before the upper one, which turns about z to the foot's side."""
    sole: tuple[float, float] = (0.0, 0.0)  # Length of the foot behind and ahead of the ankle [m]
    roll: tuple[float, float] = (0.0, 0.0)
    """How far the toes point up when the heel strikes, and down when they push off [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Gait:
    """How a figure moves."""

    stride: float = 1.0  # Distance travelled in a cycle [m]
    duty: float = 0.5  # Part of the cycle during which a foot is on the ground
    lift: float = 0.0  # How high feet are lifted [m]
    shift: float = 0.0  # How far the middle of a step is ahead of where the foot stands at rest [m]
    slowest: float = 0.1  # Speed below which the motion fades into the resting pose [m/s]
    x: Swing = STILL  # Sway of the trunk along x [m], and so on
    y: Swing = STILL
    z: Swing = STILL
    roll: Swing = STILL
    pitch: Swing = STILL
    yaw: Swing = STILL


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A person or robot."""

    joints: tuple[Joint, ...]  # Parents before what turns with them
    legs: tuple[Leg, ...] = ()
    gait: Gait = Gait()
    wheel_radius: float = 0.0  # Radius of what spins [m]; 0: nothing does
    upright: bool = False  # Whether it stays upright on slopes; else it tilts with the ground
    scale: float = 1.0  # Factor on all lengths, also on those of the gait

    @property
    def period(self) -> float:
        """Distance after which its motion repeats [m]."""
        turn = 2.0 * math.pi * self.wheel_radius
        return self.scale * (self.gait.stride if self.legs or not turn else turn)
