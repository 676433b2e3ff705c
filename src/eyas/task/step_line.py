"""The line that a log has for each step, in the original's words."""

from eyas.core.clock import PHYSICS_STEP
from eyas.state.snapshot import Snapshot
from eyas.task.done import DoneReason

__all__ = ["step_line"]


def step_line(snapshot: Snapshot, tracker: int, name: str) -> str:
    """Return the line of a tracker's last step, without a line break.

    It has what the original prints for each step if its `Verbose` is true: name, end, reward, steps
    and simulated time, turn of the target, pitch of the camera, and the limit that the body
    violates.

    Args:
        snapshot: The state after the step.
        tracker: The tracker.
        name: Name of the tracker.
    """
    episodes = snapshot.episodes
    return (
        f"id: {name} done: {int(episodes.done[tracker])} reward: {episodes.reward[tracker]:g}"
        f" count: {episodes.step_count[tracker]}"
        f" time: {episodes.tick[tracker] * PHYSICS_STEP:g}"
        f" carDir: {episodes.direction[tracker]}"
        f" pitchAngle: {snapshot.trackers.gimbal[tracker, 1]:g}"
        f" doneState: {DoneReason(int(episodes.breach[tracker])).original}"
    )
