"""Where the parts of a figure are through a cycle of its motion."""

import numpy as np
from numpy.typing import NDArray

from eyas.mesh.shell import Shape
from eyas.targets.jointed.figure import Figure, Gait, Joint
from eyas.targets.jointed.frames import level, turned
from eyas.targets.jointed.stepping import leg_frames

__all__ = ["frames_of", "shapes_of"]


def shapes_of(figure: Figure) -> list[Shape]:
    """Return the shape of each drawn part, in the order of `frames_of`."""
    shapes = [joint.shape for joint in figure.joints if joint.shape is not None]
    for leg in figure.legs:
        bones = (leg.coxa[1] if leg.coxa else None, *leg.shapes)
        shapes += [shape for shape in bones if shape is not None]
    return shapes


def frames_of(figure: Figure, cycle: NDArray[np.float64], *, moving: bool) -> NDArray[np.float64]:
    """Return the frames of the drawn parts in the model frame, shape (K, S, 3, 4) [m].

    Args:
        figure: The figure.
        cycle: Parts of a cycle, shape (K,).
        moving: Whether it moves; else it rests, and all K frames are alike.
    """
    frames = {"ground": level(len(cycle)), "trunk": _trunk(figure.gait, cycle, moving=moving)}
    drawn = []
    for joint in figure.joints:
        frames[joint.name] = _joint(frames[joint.parent], joint, cycle, moving=moving)
        if joint.shape is not None:
            drawn.append(frames[joint.name])
    for leg in figure.legs:
        drawn += leg_frames(figure.gait, leg, frames[leg.parent], cycle, moving=moving)
    return np.stack(drawn, axis=1)


def _trunk(gait: Gait, cycle: NDArray[np.float64], *, moving: bool) -> NDArray[np.float64]:
    place = [s.at(cycle, moving=moving) for s in (gait.x, gait.y, gait.z)]
    angles = [s.at(cycle, moving=moving) for s in (gait.roll, gait.pitch, gait.yaw)]
    return turned(level(len(cycle)), np.stack(place, axis=1), *angles)


def _joint(
    parent: NDArray[np.float64], joint: Joint, cycle: NDArray[np.float64], *, moving: bool
) -> NDArray[np.float64]:
    angles = [s.at(cycle, moving=moving) for s in (joint.roll, joint.pitch, joint.yaw)]
    return turned(parent, np.array(joint.pivot), *angles)
