"""The other moving objects of a frame, on the shipped map and traffic."""

from dataclasses import asdict, fields, is_dataclass

import numpy as np
import pytest

from eyas.engine.exports.capture import FrameMoment, frame_of, moment_of, others_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.targets.words import words_of

MEASURED = ("box", "visible_box", "whole_box", "seen_pixels", "covered_pixels")


@pytest.fixture(scope="module")
def simulation():
    simulation = build_simulation(SimConfig(), together(2))
    simulation.reset()
    simulation.advance(np.zeros((2, 4)), 30)
    return simulation


def picture_of(simulation, **wanted) -> Picture:
    picture = Picture.create(2, 48, 64, subject=True, **wanted)
    simulation.draw(np.arange(2, dtype=np.int32), picture)
    return picture


def seen_by(simulation, tracker, picture):
    return others_of(moment_of(simulation, tracker, picture, tracker), tracker, picture, tracker)


def test_another_s_target_is_described_like_a_target(simulation):
    picture = picture_of(simulation, actors=simulation.actors)
    picture.actor_pixels[:] = 3, 4  # as if every actor was seen
    picture.actor_box[:] = 1, 2, 3, 4
    moment = FrameMoment(simulation.snapshot, simulation.snapshot.episodes)
    target = frame_of(moment, 1, picture, 1, 0, RecordedAction(-1, None)).target
    others = seen_by(simulation, 0, picture)
    own = ACTOR_OBJECT + int(simulation.snapshot.targets.actor[0])
    everyone = [ACTOR_OBJECT + actor for actor in range(simulation.actors)]
    assert [other.object_id for other in others] == [id_ for id_ in everyone if id_ != own]
    (same,) = (other for other in others if other.object_id == target.object_id)
    for field in fields(target):
        if field.name not in (*MEASURED, "words"):
            expected = getattr(target, field.name)
            told = getattr(same, field.name)
            if is_dataclass(expected):
                told, expected = asdict(told), asdict(expected)
            np.testing.assert_equal(told, expected, err_msg=field.name)
    (model,), (colour,) = simulation.looks_around(0)
    actor = target.object_id - ACTOR_OBJECT
    assert same.words == words_of(int(model[actor]), colour[actor])
    assert (same.box.tolist(), same.seen_pixels, same.covered_pixels) == ([1, 2, 3, 4], 3, 4)


def test_they_are_those_whose_pixels_are_in_the_picture(simulation):
    picture = picture_of(simulation, actors=simulation.actors, object_id=True, class_id=True)
    for tracker in range(2):
        own = ACTOR_OBJECT + int(simulation.snapshot.targets.actor[tracker])
        shown, count = np.unique(picture.object_id[tracker], return_counts=True)
        seen = {i: n for i, n in zip(shown.tolist(), count.tolist(), strict=True) if i != own}
        others = seen_by(simulation, tracker, picture)
        expected = {i: n for i, n in seen.items() if i >= ACTOR_OBJECT}
        assert {other.object_id: other.seen_pixels for other in others} == expected
        for other in others:
            classes = picture.class_id[tracker][picture.object_id[tracker] == other.object_id]
            assert set(classes.tolist()) == {int(other.object_class)}


def test_there_are_none_where_nobody_wants_them(simulation):
    moment = FrameMoment(simulation.snapshot, simulation.snapshot.episodes)
    frame = frame_of(moment, 0, picture_of(simulation), 0, 0, RecordedAction(-1, None))
    assert (frame.others, frame.target.words) == ((), "")


def test_trackers_of_a_world_share_its_actors_and_are_told_the_same(simulation):
    picture = picture_of(simulation, actors=simulation.actors)
    first, second = around = simulation.view.around([0, 1])
    assert first is second
    for tracker, shared in enumerate(around):
        own, same = (
            moment_of(simulation, tracker, picture, tracker, {"words"}, given)
            for given in (None, shared)
        )
        assert own.words == same.words
        np.testing.assert_array_equal(own.whole_box, same.whole_box)


def test_a_frame_keeps_only_the_arrays_that_are_wanted(simulation):
    picture = picture_of(simulation, depth=True)
    moment = FrameMoment(simulation.snapshot, simulation.snapshot.episodes)
    frame = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None), {"rgb"})
    assert frame.rgb is not None
    assert frame.depth is None


@pytest.mark.parametrize("wanted", [set(), {"words"}])
def test_the_target_is_in_words_only_where_somebody_wants_them(simulation, wanted):
    picture = picture_of(simulation, actors=simulation.actors)
    moment = moment_of(simulation, 0, picture, 0, wanted)
    words = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None)).target.words
    assert words == (simulation.view.words(0, picture.aspect) if wanted else "")
