"""Motion of moving objects, and the boxes in which they fit."""

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.kind import Section
from eyas.engine.task.direction import TargetDirection
from eyas.engine.traffic.trailer import folded
from eyas.lanes import exact, interpreted

Floats: TypeAlias = NDArray[np.float64]

_ENDS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Ends of length and width: counter-clockwise from the right of the tail."""

_folded = interpreted(folded)


@dataclass(frozen=True, slots=True)
class Movement:
    """Motion of a moving object, and its stance on the ground."""

    acceleration: Floats  # Change of the velocity, world frame [m/s^2], shape (3,)
    yaw_rate: float  # Counter-clockwise [rad/s]
    slope: float  # Pitch of the ground along its heading, positive up [rad]
    travelled: float  # Way since it entered the world [m]
    direction: TargetDirection  # Turn of the target
    rise: float  # Height of its reference point above the ground [m]
    hitch: float = 0.0  # Heading of its trailer less that of its truck [rad]; 0 of all others
    upright: bool = False
    """Whether it stays upright on slopes, like people; else it tilts with the ground."""
    extent: Floats | None = None
    """The box of its limbs at this moment: least and largest coordinates ahead, left and up of the
    point on the ground below its middle [m], shape (2, 3); None of what is rigid."""


class SectionBox(NamedTuple):
    """The 3D box of a section of an articulated vehicle."""

    name: str  # "truck" or "trailer"
    size: tuple[float, float, float]  # Length, width, height [m]
    yaw: float  # Heading, counter-clockwise from east [rad]
    corners: Floats  # Corners in the order of `box_corners` [m], shape (8, 3)


def box_corners(
    centre: Floats, size: Floats, yaw: float, motion: Movement, sections: tuple[Section, ...] = ()
) -> Floats:
    """Return the corners of a 3D box: four on the ground, counter-clockwise from the right of its
    tail, and those above them [m], shape (8, 3).

    Args:
        centre: Middle of the body, at the height of its reference point [m], shape (3,).
        size: Length, width, height [m], shape (3,). If its trailer swings, the box has another
            length and width: those that contain its sections.
        yaw: Heading [rad].
        motion: Slope of the ground, height of the reference point above it, and whether it tilts.
        sections: Those of an articulated vehicle.
    """
    length, width, height = size.tolist()
    plan = 0.5 * _ENDS * (length, width)
    if motion.hitch != 0.0 and sections:
        outlines = np.concatenate([_outline(section, motion.hitch)[0] for section in sections])
        plan = np.where(_ENDS < 0.0, outlines.min(axis=0), outlines.max(axis=0))
    return _raised(plan, height, centre, yaw, motion)


def posed_corners(
    centre: Floats,  # Middle of the body, at the height of its reference point [m], shape (3,)
    yaw: float,  # Heading [rad]
    motion: Movement,  # Its extent, and how it stands
) -> Floats | None:
    """Return the corners of the box around the limbs of a person or robot at this moment.

    Returns:
        In the order of `box_corners`, shape (8, 3); None of what is rigid.
    """
    if motion.extent is None:
        return None
    low, high = motion.extent
    plan = np.where(_ENDS < 0.0, low[:2], high[:2])
    if motion.upright:  # it is sheared, not tilted, so that its feet are on the ground
        plan[:, 0] /= exact.cos(motion.slope)
    foot, top = (_raised(plan, float(z), centre, yaw, motion)[4:] for z in (low[2], high[2]))
    return np.concatenate([foot, top])


def section_boxes(
    sections: tuple[Section, ...], centre: Floats, yaw: float, motion: Movement
) -> tuple[SectionBox, ...]:
    """Return the boxes of the sections of an articulated vehicle; arguments as of `box_corners`."""
    boxes = []
    for section in sections:
        plan, turn = _outline(section, motion.hitch)
        corners = _raised(plan, section.size[2], centre, yaw, motion)
        boxes.append(SectionBox(section.name, section.size, yaw + turn, corners))
    return tuple(boxes)


def _outline(section: Section, hitch: float) -> tuple[Floats, float]:
    """Return the outline of a section [m], shape (4, 2), and its heading [rad], in the frame of the
    whole vehicle.
    """
    x, y, cosine, sine = _folded(hitch, section.towed)
    along, aside = (0.5 * _ENDS * section.size[:2] + (section.ahead, 0.0)).T
    ahead, left = x + cosine * along - sine * aside, y + sine * along + cosine * aside
    return np.column_stack([ahead, left]), exact.atan2(sine, cosine)


def _raised(plan: Floats, height: float, centre: Floats, yaw: float, motion: Movement) -> Floats:
    """Return the corners of a box on an outline, ahead and left of the middle [m]."""
    pitch, cosine, sine = motion.slope, exact.cos(yaw), exact.sin(yaw)
    ahead = np.array([cosine * exact.cos(pitch), sine * exact.cos(pitch), exact.sin(pitch)])
    left, up = np.array([-sine, cosine, 0.0]), np.array([0.0, 0.0, 1.0])
    # The product of `ahead` and `left`, which np.cross takes 40 us for.
    tilted = [-ahead[2] * cosine, -ahead[2] * sine, ahead[0] * cosine + ahead[1] * sine]
    standing = up if motion.upright else np.array(tilted)
    ground = centre - motion.rise * up + (plan[:, :1] * ahead + plan[:, 1:] * left)
    return np.concatenate([ground, ground + height * standing])
