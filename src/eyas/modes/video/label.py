"""The label of a frame, read from the simulation."""

import math

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import rotate_back
from eyas.exports.labels import FrameLabel, rounded, rounded_list
from eyas.sim.simulation import Simulation
from eyas.state.draw import Picture
from eyas.targets.catalogue import VEHICLES

__all__ = ["label_of"]


def label_of(
    sim: Simulation, tracker: int, picture: Picture, view: int, frame: int, action: int
) -> FrameLabel:
    """Return what is known about a frame.

    Args:
        sim: The simulation at the instant of the frame.
        tracker: Whose frame it is.
        picture: What was drawn, with the subject's box and pixels.
        view: The tracker's row in `picture`.
        frame: Number of the frame in its episode.
        action: Number of the tracker's action.
    """
    assert picture.subject_box is not None
    assert picture.subject_pixels is not None
    seen, covered = (int(pixels) for pixels in picture.subject_pixels[view])
    trackers, cameras, targets, episodes, _ = sim.snapshot
    yaw, speed = float(targets.yaw[tracker]), float(targets.speed[tracker])
    offset = targets.centre[tracker] - trackers.position[tracker]
    step = int(episodes.step_count[tracker])
    return FrameLabel(
        frame=frame,
        time=round(float(episodes.tick[tracker]) * PHYSICS_STEP, 6),
        step=step,
        episode_time=round(step * PHYSICS_STEP, 6),
        target_box=picture.subject_box[view].tolist(),
        visible_fraction=round(seen / covered, 6) if covered else 0.0,
        occluded=seen < covered,
        in_view=covered > 0,
        tracker_position=rounded_list(trackers.position[tracker]),
        tracker_velocity=rounded_list(trackers.velocity[tracker]),
        tracker_orientation=rounded_list(trackers.orientation[tracker]),
        camera_position=rounded_list(cameras.position[tracker]),
        camera_rotation=[rounded_list(row) for row in cameras.rotation[tracker]],
        target_type=VEHICLES[targets.model[tracker]].name,
        target_size=rounded_list(targets.size[tracker]),
        target_position=rounded_list(targets.position[tracker]),
        target_centre=rounded_list(targets.centre[tracker]),
        target_velocity=rounded_list([speed * math.cos(yaw), speed * math.sin(yaw), 0.0]),
        target_yaw=rounded(yaw),
        relative_position=rounded_list(rotate_back(trackers.orientation[tracker], *offset)),
        reward=rounded(episodes.reward[tracker]),
        action=action,
        direction=int(episodes.direction[tracker]),
        done=bool(episodes.reason[tracker] > 0),
    )
