"""The moving objects of a picture besides its target."""

from dataclasses import replace

import numpy as np

from eyas.core.clock import PHYSICS_STEP
from eyas.exports.frame import Subject
from eyas.exports.movement import Movement
from eyas.lanes import interpreted
from eyas.sim.simulation import Simulation
from eyas.state.draw import Picture
from eyas.state.motion import ActorState
from eyas.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.targets.catalogue import MODELS, extent_of, kind_of, sections_of
from eyas.targets.words import words_of
from eyas.task.direction import TargetDirection, target_centre, target_direction

__all__ = ["others_of"]

_target_centre = interpreted(target_centre)
_target_direction = interpreted(target_direction)


def others_of(
    simulation: Simulation, tracker: int, picture: Picture, view: int
) -> tuple[Subject, ...]:
    """Return all visible moving objects except the tracker's target, in the order of their ids.

    Args:
        simulation: The simulation, whose agents see that picture.
        tracker: The tracker of the picture.
        picture: The picture, with the boxes and pixels of all actors, if they were measured.
        view: The tracker's row in `picture`.
    """
    if picture.actor_pixels is None:
        return ()
    visible = picture.actor_pixels[view, :, 0] > 0
    sight = simulation.perception.sight
    visible[sight.shown.targets.actor[tracker]] = False
    age = sight.age_of(tracker)
    actors, models = simulation.actors_around(tracker, age)
    (colours,) = simulation.looks_around(tracker).colour
    before, _ = simulation.actors_around(tracker, age + 1)
    return tuple(
        replace(
            _subject(actors, before, actor, int(models[actor]), picture, view),
            words=words_of(int(models[actor]), colours[actor].tolist()),
        )
        for actor in np.flatnonzero(visible).tolist()
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


def _subject(  # where it is, and where it is seen
    actors: ActorState, before: ActorState, actor: int, model: int, picture: Picture, view: int
) -> Subject:
    assert picture.actor_box is not None
    assert picture.actor_pixels is not None
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
        motion=_movement(actors, before, actor, model),
        box=picture.actor_box[view, actor].copy(),
        seen_pixels=seen,
        covered_pixels=covered,
        sections=sections_of(model),
    )
