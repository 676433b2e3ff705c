"""Frames as they are taken: copies of what steps and pictures change later."""

from eyas.core.clock import PHYSICS_STEP
from eyas.exports.frame import Action, Body, CameraPose, Floats, Frame, Subject
from eyas.exports.movement import Movement
from eyas.state.draw import Picture
from eyas.state.episode import EpisodeState
from eyas.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.state.snapshot import CameraState, Snapshot, TrackerState
from eyas.targets.catalogue import MODELS, extent_of, kind_of, sections_of
from eyas.task.direction import TargetDirection
from eyas.task.done import DoneReason

__all__ = ["frame_of"]


def frame_of(  # noqa: PLR0913  # everything that a frame holds
    shown: Snapshot,
    now: EpisodeState,
    tracker: int,
    picture: Picture,
    view: int,
    number: int,
    action: Action,
    others: tuple[Subject, ...] = (),
    lidar: Floats | None = None,
    words: str = "",
) -> Frame:
    """Return a frame that later steps and pictures do not change.

    Args:
        shown: The state that the picture shows.
        now: The episodes at the time of the frame, which is later if pictures are late.
        tracker: The tracker of the frame.
        picture: The picture, with the box and pixels of the target.
        view: The tracker's row in `picture`.
        number: Number of the frame in its episode.
        action: The tracker's action.
        others: Other moving objects in the picture, see `eyas.exports.others.others_of`.
        lidar: Distances of its lidar, which nothing changes later.
        words: The target in words.
    """
    return Frame(
        number=number,
        time=float(shown.episodes.tick[tracker]) * PHYSICS_STEP,
        step=int(shown.episodes.step_count[tracker]),
        tracker=_body(shown.trackers, tracker),
        camera=_camera(shown.cameras, tracker),
        target=_target(shown, tracker, picture, view),
        others=others,
        action=action,
        reward=float(now.reward[tracker]),
        direction=TargetDirection(shown.episodes.direction[tracker]),
        reason=DoneReason(now.reason[tracker]),
        rgb=None if picture.rgb is None else picture.rgb[view].copy(),
        depth=None if picture.depth is None else picture.depth[view].copy(),
        object_id=None if picture.object_id is None else picture.object_id[view].copy(),
        class_id=None if picture.class_id is None else picture.class_id[view].copy(),
        lidar=lidar,
        target_words=words,
    )


def _body(trackers: TrackerState, tracker: int) -> Body:
    return Body(
        position=trackers.position[tracker].copy(),
        velocity=trackers.velocity[tracker].copy(),
        acceleration=trackers.acceleration[tracker].copy(),
        orientation=trackers.orientation[tracker].copy(),
        angular_velocity=trackers.angular_velocity[tracker].copy(),
        gimbal=trackers.gimbal[tracker].copy(),
    )


def _camera(cameras: CameraState, tracker: int) -> CameraPose:
    return CameraPose(
        position=cameras.position[tracker].copy(),
        rotation=cameras.rotation[tracker].copy(),
        field_of_view=float(cameras.field_of_view[tracker]),
    )


def _target(snapshot: Snapshot, tracker: int, picture: Picture, view: int) -> Subject:
    targets = snapshot.targets
    assert picture.subject_box is not None
    assert picture.subject_pixels is not None
    seen, covered = (int(pixels) for pixels in picture.subject_pixels[view])
    model, speed = int(targets.model[tracker]), float(targets.speed[tracker])
    slope, travelled = float(targets.slope[tracker]), float(targets.travelled[tracker])
    return Subject(
        object_id=ACTOR_OBJECT + int(targets.actor[tracker]),
        type=MODELS[model].name,
        object_class=kind_of(model).object_class,
        size=targets.size[tracker].copy(),
        position=targets.position[tracker].copy(),
        centre=targets.centre[tracker].copy(),
        velocity=targets.velocity[tracker].copy(),
        yaw=float(targets.yaw[tracker]),
        motion=Movement(
            acceleration=targets.acceleration[tracker].copy(),
            yaw_rate=float(targets.yaw_rate[tracker]),
            slope=slope,
            travelled=travelled,
            direction=TargetDirection(snapshot.episodes.direction[tracker]),
            rise=float(targets.rise[tracker]),
            hitch=float(targets.hitch[tracker]),
            upright=kind_of(model).object_class is ObjectClass.PERSON,
            extent=extent_of(model, travelled, speed, slope),
        ),
        box=picture.subject_box[view].copy(),
        seen_pixels=seen,
        covered_pixels=covered,
        sections=sections_of(model),
    )
