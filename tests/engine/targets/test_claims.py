"""What a claim says of those in view: each statement counts, whether strictly or nearly."""

import numpy as np
import pytest

from eyas.engine.targets.catalogue import model_index
from eyas.engine.targets.grammar.claims import (
    Bearing,
    Claim,
    Doing,
    PicturePlace,
    fits,
    holds,
    tells_apart,
)
from eyas.engine.targets.grammar.in_view import BodyWord, InView
from eyas.engine.targets.grammar.naming import PhraseKind, contradictory, phrase_about

RED, BLUE = (0.74, 0.10, 0.09), (0.13, 0.27, 0.62)
SEDAN = "LincolnMKZSimple"


def view_of(*cars):
    """Return a view of cars of (yaw rate, speed, colour), one 8 m ahead of the other."""
    count = len(cars)
    rows = np.arange(count)
    place = np.stack([np.full(count, 0.5), 0.9 - 0.8 * rows / max(count - 1, 1)], axis=1)
    return InView(
        actor=rows,
        model=np.full(count, model_index(SEDAN)),
        colour=np.array([car[2] for car in cars]),
        speed=np.array([car[1] for car in cars], np.float64),
        yaw_rate=np.array([car[0] for car in cars], np.float64),
        place=place,
        middle=np.stack([8.0 * rows, np.zeros(count)], axis=1),
        heading=np.zeros(count),
        size=np.tile([4.9, 1.9], (count, 1)),
    )


TURNING, STRAIGHT, STANDING = (0.5, 8.0, RED), (0.0, 8.0, RED), (0.0, 0.0, RED)


@pytest.mark.parametrize(
    ("doing", "nearly"),
    [
        (Doing.LEFT_TURN, [True, False, False, False]),
        (Doing.RIGHT_TURN, [False, False, False, True]),
        (Doing.STRAIGHT, [False, True, False, False]),
        (Doing.MOVING, [True, True, False, True]),
        (Doing.STANDING, [False, False, True, False]),
    ],
)
def test_what_something_does_is_asked_strictly_and_nearly(doing, nearly):
    view = view_of(TURNING, STRAIGHT, STANDING, (-0.5, 8.0, RED))
    claim = Claim(BodyWord.SEDAN, doing=doing)
    assert fits(claim, view).tolist() == nearly
    assert holds(claim, view).tolist() == nearly


def test_a_close_call_fits_but_does_not_hold():
    view = view_of((0.1, 8.0, RED), TURNING)
    claim = Claim(BodyWord.SEDAN, doing=Doing.LEFT_TURN)
    assert fits(claim, view).tolist() == [True, True]
    assert holds(claim, view).tolist() == [False, True]
    assert not tells_apart(claim, view, 1)  # a reader may mean the other


def test_motion_alone_tells_two_of_the_same_look_apart():
    view = view_of(TURNING, STRAIGHT)
    assert not tells_apart(Claim(BodyWord.SEDAN, "red"), view, 0)
    assert tells_apart(Claim(BodyWord.SEDAN, "red", Doing.LEFT_TURN), view, 0)
    for kinds in [(PhraseKind.BODY,), (PhraseKind.COLOUR,)]:
        assert phrase_about(view, 0, np.random.default_rng(1), kinds=kinds).claim is None
    for seed in range(20):
        phrase = phrase_about(view, 0, np.random.default_rng(seed), kinds=(PhraseKind.ACTION,))
        assert phrase.kind is PhraseKind.ACTION
        assert phrase.claim.doing is Doing.LEFT_TURN


def test_motion_that_all_share_tells_nothing_apart():
    view = view_of(STRAIGHT, STRAIGHT)
    phrase = phrase_about(view, 0, np.random.default_rng(1), kinds=(PhraseKind.ACTION,))
    assert phrase.claim is None


def test_a_wrong_motion_fits_nothing_in_view():
    view = view_of(TURNING, STRAIGHT)
    claim = Claim(BodyWord.SEDAN, "red", Doing.LEFT_TURN)
    for seed in range(20):
        wrong = contradictory(claim, view, np.random.default_rng(seed))
        assert wrong.doing in (Doing.RIGHT_TURN, Doing.STANDING)
        assert wrong == claim._replace(doing=wrong.doing)


def test_places_and_bearings_count_too():
    view = view_of(STRAIGHT, STRAIGHT, STRAIGHT)
    assert fits(Claim(BodyWord.SEDAN, place=PicturePlace.BOTTOMMOST), view).tolist() == [
        True,
        False,
        False,
    ]
    blue = view_of((0.0, 8.0, BLUE), STRAIGHT, STRAIGHT)
    ahead = Claim(
        BodyWord.SEDAN, bearing=Bearing.AHEAD, other_body=BodyWord.SEDAN, other_colour="blue"
    )
    assert holds(ahead, blue).tolist() == [False, True, False]
