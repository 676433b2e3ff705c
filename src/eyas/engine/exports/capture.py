"""Frames as they are taken: copies of what steps and pictures change later."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.optics.lens import NO_LENS, Lens
from eyas.engine.exports.frame import (
    OUTPUTS,
    CameraPicture,
    CameraPose,
    Floats,
    Frame,
    Output,
    RecordedAction,
    RecordedBody,
    Subject,
)
from eyas.engine.exports.movement import Movement
from eyas.engine.render.outputs import picture_size
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.views.parked import SeenParked
from eyas.engine.sim.views.view import View
from eyas.engine.state.draw import Picture
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.motion import ActorState, ActorView
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.state.snapshot import CameraState, Snapshot, TrackerState
from eyas.engine.targets.catalogue import MODELS, extent_of, kind_of, sections_of
from eyas.engine.targets.words import words_of
from eyas.engine.task.direction import TargetDirection, target_centre, target_direction
from eyas.engine.task.done import DoneReason
from eyas.engine.task.packet_rows import SENSOR_COLUMNS
from eyas.engine.trackers.tracker import ROTORS
from eyas.lanes import interpreted

Number = TypeVar("Number", bound=np.generic)

_target_centre = interpreted(target_centre)
_target_direction = interpreted(target_direction)


class FrameMoment(NamedTuple):
    """State of a tracker at the time of a frame."""

    shown: Snapshot  # The state that its picture shows
    now: EpisodeState  # The episodes at the time of the frame, which is later if pictures are late
    actors: ActorView | None = None
    """The actors around it that the picture shows; None: only the target is wanted."""
    whole_box: Floats | None = None
    """See `Subject.whole_box`, of each of these actors, shape (A, 4); only rows of the target and
    of actors in the picture are read."""
    lens: Lens | None = None  # The lens of its camera; None: it is a pinhole
    lamps: NDArray[np.uint8] | None = None
    """See `Subject.lamps`, of each actor, shape (A,); None: nobody signals."""
    words: str = ""  # The target in words that nothing else in view shares
    parked: Sequence[SeenParked] = ()
    """The parked objects in its picture, in the order of their ids."""
    further: Mapping[str, Any] = {}  # Other fields of `Frame`; nothing changes them later


def moment_of(
    simulation: Simulation,
    tracker: int,
    picture: Picture,
    view: int,
    wanted: Collection[Output] = (),
    around: ActorView | None = None,
) -> FrameMoment:
    """Return what is known of a tracker at the time of its picture, which has just been drawn.

    Args:
        simulation: The simulation.
        tracker: The tracker.
        picture: The picture; if it measures actors, they are wanted, and if it then has objects
            and depths, so is what is parked.
        view: The tracker's row in `picture`.
        wanted: What is asked for besides: "words", "parts", "clean", "cameras", "events",
            "traffic"; others are in the picture.
        around: The actors around it, see `View.around`; None: not known yet.
    """
    seen, shown = simulation.view, simulation.view.state.shown
    around, whole_box = around or seen.actors(tracker), None
    parked: Sequence[SeenParked] = ()
    if picture.actor_pixels is not None:
        if picture.object_id is not None and picture.depth is not None:
            parked = seen.parked(tracker, picture.object_id[view], picture.depth[view])
        boxed = picture.actor_pixels[view, :, 0] > 0
        boxed[shown.targets.actor[tracker]] = True
        whole_box = np.zeros((simulation.actors, 4))
        whole_box[boxed] = seen.whole_boxes(tracker, around, np.flatnonzero(boxed))
    lidar, exposed = seen.lidar, seen.exposure
    rotors = simulation.told().get(ROTORS)
    further = {
        "lidar": None if lidar is None else lidar.ranges(seen.state.late)[tracker],
        "sensors": seen.packets()[0][tracker, SENSOR_COLUMNS],
        "exposure": None if exposed is None else (exposed.time[tracker], exposed.iso[tracker]),
        "rotors": None if rotors is None else rotors[tracker],
        "signals": {name: values[tracker] for name, values in seen.further_readings().items()},
        "parts": seen.parts(tracker, around) if "parts" in wanted else None,
        "clean": seen.clean(tracker, *picture_size(picture)) if "clean" in wanted else None,
        "cameras": _through_further(seen, tracker) if "cameras" in wanted else (),
        "events": _events(seen, tracker) if "events" in wanted else None,
        "traffic": _kept(around) if "traffic" in wanted else None,
    }
    return FrameMoment(
        shown,
        simulation.snapshot.episodes,
        actors=around if picture.actor_pixels is not None else None,
        whole_box=whole_box,
        lens=seen.lens_of(tracker),
        lamps=seen.lamps(tracker),
        words=seen.words(tracker, picture.aspect, around) if "words" in wanted else "",
        parked=parked,
        further=further,
    )


def _events(seen: View, tracker: int) -> NDArray[np.void] | None:
    """Return the events of a tracker's event camera since the last time; None if it has none."""
    sensors = seen.events(np.array([tracker], np.int32))
    return None if sensors is None else sensors.events_of(tracker)


def _kept(actors: ActorView) -> ActorView:
    """Return actors with looks that the next reset does not change."""
    return actors._replace(model=actors.model.copy(), colour=actors.colour.copy())


def _through_further(seen: View, tracker: int) -> tuple[CameraPicture, ...]:
    """Return pictures of all further cameras of a tracker."""
    pictures = []
    for name, camera in seen.further.items():
        picture = Picture.create(1, camera.config.height, camera.config.width)
        camera.draw(np.array([tracker], np.int32), picture)
        assert picture.rgb is not None
        pose = _camera(camera.cameras, tracker, picture, camera.lens_of(tracker))
        pictures.append(CameraPicture(name, pose, picture.rgb[0]))
    return tuple(pictures)


def frame_of(
    moment: FrameMoment,
    tracker: int,
    picture: Picture,
    view: int,
    number: int,
    action: RecordedAction,
    kept: Collection[Output] = OUTPUTS,
) -> Frame:
    """Return a frame that later steps and pictures do not change.

    Args:
        moment: What is known.
        tracker: The tracker of the frame.
        picture: The picture, with the box and pixels of the target, and of all actors if the
            moment has them.
        view: The tracker's row in `picture`.
        number: Number of the frame in its episode.
        action: The tracker's action.
        kept: Which of the arrays of its picture are wanted; others may serve to measure it.
    """
    shown, now = moment.shown, moment.now
    others: tuple[Subject, ...] = ()
    if moment.actors is not None:
        others = others_of(moment, tracker, picture, view)
    return Frame(
        number=number,
        time=float(shown.episodes.tick[tracker]) * PHYSICS_STEP,
        step=int(shown.episodes.step_count[tracker]),
        tracker=_body(shown.trackers, tracker),
        camera=_camera(shown.cameras, tracker, picture, moment.lens),
        target=_target(moment, tracker, picture, view),
        others=others,
        action=action,
        reward=float(now.reward[tracker]),
        direction=TargetDirection(shown.episodes.direction[tracker]),
        reason=DoneReason(now.reason[tracker]),
        rgb=_plane(picture.rgb, view) if "rgb" in kept else None,
        depth=_plane(picture.depth, view) if "depth" in kept else None,
        object_id=_plane(picture.object_id, view) if "object_id" in kept else None,
        class_id=_plane(picture.class_id, view) if "class_id" in kept else None,
        normal=_plane(picture.normal, view) if "normal" in kept else None,
        **moment.further,
    )


def _plane(array: NDArray[Number] | None, view: int) -> NDArray[Number] | None:
    return None if array is None else array[view].copy()


def _body(trackers: TrackerState, tracker: int) -> RecordedBody:
    return RecordedBody(
        position=trackers.position[tracker].copy(),
        velocity=trackers.velocity[tracker].copy(),
        acceleration=trackers.acceleration[tracker].copy(),
        orientation=trackers.orientation[tracker].copy(),
        angular_velocity=trackers.angular_velocity[tracker].copy(),
        gimbal=trackers.gimbal[tracker].copy(),
    )


def _camera(cameras: CameraState, tracker: int, picture: Picture, lens: Lens | None) -> CameraPose:
    height, width = picture_size(picture)
    return CameraPose(
        position=cameras.position[tracker].copy(),
        rotation=cameras.rotation[tracker].copy(),
        field_of_view=float(cameras.field_of_view[tracker]),
        width=width,
        height=height,
        lens=lens or NO_LENS,
    )


def _target(moment: FrameMoment, tracker: int, picture: Picture, view: int) -> Subject:
    targets = moment.shown.targets
    assert picture.subject_box is not None
    assert picture.subject_visible_box is not None
    assert picture.subject_pixels is not None
    seen, covered = (int(pixels) for pixels in picture.subject_pixels[view])
    model, speed = int(targets.model[tracker]), float(targets.speed[tracker])
    slope, travelled = float(targets.slope[tracker]), float(targets.travelled[tracker])
    actor = int(targets.actor[tracker])
    return Subject(
        object_id=ACTOR_OBJECT + actor,
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
            direction=TargetDirection(moment.shown.episodes.direction[tracker]),
            rise=float(targets.rise[tracker]),
            hitch=float(targets.hitch[tracker]),
            upright=kind_of(model).object_class is ObjectClass.PERSON,
            extent=extent_of(model, travelled, speed, slope),
        ),
        box=picture.subject_box[view].copy(),
        visible_box=picture.subject_visible_box[view].copy(),
        whole_box=_whole_box(moment, actor),
        seen_pixels=seen,
        covered_pixels=covered,
        words=moment.words,
        sections=sections_of(model),
        lamps=_lamps(moment, actor),
    )


def _lamps(moment: FrameMoment, actor: int) -> int:
    return 0 if moment.lamps is None else int(moment.lamps[actor])


def _whole_box(moment: FrameMoment, actor: int) -> Floats:
    return np.zeros(4) if moment.whole_box is None else moment.whole_box[actor].copy()


def others_of(
    moment: FrameMoment,  # What is known, with the actors that the picture shows
    tracker: int,  # The tracker of the picture
    picture: Picture,  # The picture, with the boxes and pixels of all actors
    view: int,  # The tracker's row in `picture`
) -> tuple[Subject, ...]:
    """Return all visible objects except the tracker's target, in the order of their ids."""
    assert picture.actor_pixels is not None
    visible = picture.actor_pixels[view, :, 0] > 0
    visible[moment.shown.targets.actor[tracker]] = False
    return (
        *map(_parked, moment.parked),
        *(_other(moment, actor, picture, view) for actor in np.flatnonzero(visible).tolist()),
    )


def _parked(seen: SeenParked) -> Subject:
    """Return a parked object."""
    what = seen.what
    x, y, z = what.foot
    rise = 0.5 * what.size[2]
    return Subject(
        object_id=what.object_id,
        type=what.type,
        object_class=what.object_class,
        size=np.array(what.size),
        position=np.array(what.foot),
        centre=np.array([x, y, z + rise]),
        velocity=np.zeros(3),
        yaw=what.yaw,
        motion=Movement(
            acceleration=np.zeros(3),
            yaw_rate=0.0,
            slope=0.0,
            travelled=0.0,
            direction=TargetDirection.STOP,
            rise=rise,
        ),
        box=seen.box,
        visible_box=seen.visible_box,
        whole_box=seen.whole_box,
        seen_pixels=seen.seen_pixels,
        covered_pixels=seen.covered_pixels,
        words=f"a {what.type.rstrip(' 0123456789')}",
        parked=True,
    )


def _other(moment: FrameMoment, actor: int, picture: Picture, view: int) -> Subject:
    """Return an actor that is not the target."""
    around = moment.actors
    assert around is not None
    assert picture.actor_box is not None
    assert picture.actor_pixels is not None
    assert picture.actor_visible_box is not None
    actors, model = around.state, int(around.model[actor])
    kind, (x, y, z) = kind_of(model), actors.position[0, actor].tolist()
    yaw = float(actors.yaw[0, actor])
    seen, covered = (int(pixels) for pixels in picture.actor_pixels[view, actor])
    height = z + MODELS[model].rise
    return Subject(
        object_id=ACTOR_OBJECT + actor,
        type=MODELS[model].name,
        object_class=kind.object_class,
        size=np.array(MODELS[model].size, np.float64),
        position=np.array([x, y, height]),
        centre=np.array([*_target_centre(x, y, yaw, kind.ahead), height]),
        velocity=actors.velocity[0, actor].copy(),
        yaw=yaw,
        motion=_movement(actors, around.before, actor, model),
        box=picture.actor_box[view, actor].copy(),
        visible_box=picture.actor_visible_box[view, actor].copy(),
        whole_box=_whole_box(moment, actor),
        seen_pixels=seen,
        covered_pixels=covered,
        words=words_of(model, around.colour[actor].tolist()),
        sections=sections_of(model),
        lamps=_lamps(moment, actor),
    )


def _movement(actors: ActorState, before: ActorState, actor: int, model: int) -> Movement:
    """Return the movement of an actor, from its states now and a step earlier."""
    yaw, speed = float(actors.yaw[0, actor]), float(actors.speed[0, actor])
    yaw_rate, velocity = float(actors.yaw_rate[0, actor]), actors.velocity[0, actor]
    if before.present[0, actor]:
        acceleration = (velocity - before.velocity[0, actor]) / PHYSICS_STEP
    else:
        acceleration = yaw_rate * np.array([-velocity[1], velocity[0], 0.0])
    way = speed * PHYSICS_STEP
    last_yaw = yaw - yaw_rate * PHYSICS_STEP
    direction = _target_direction(way, 0.0, yaw, last_yaw, kind_of(model).slowest)
    slope, travelled = float(actors.slope[0, actor]), float(actors.travelled[0, actor])
    return Movement(
        acceleration=acceleration,
        yaw_rate=yaw_rate,
        slope=slope,
        travelled=travelled,
        direction=TargetDirection(direction),
        rise=MODELS[model].rise,
        hitch=float(actors.hitch[0, actor]),
        upright=kind_of(model).object_class is ObjectClass.PERSON,
        extent=extent_of(model, travelled, speed, slope),
    )
