"""The listener: which vehicle a claim means, and following it among others."""

import numpy as np
import pytest

from eyas.benchmark.policies.listener.candidates import Candidates
from eyas.benchmark.policies.listener.detector import BODIES, NAMES, Detections
from eyas.benchmark.policies.listener.judge import judged
from eyas.benchmark.policies.table import open_policy
from eyas.engine.core.errors import ConfigError
from eyas.engine.targets.grammar.claims import Bearing, Claim, MotionWord, PicturePlace
from eyas.engine.targets.grammar.in_view import BodyWord

PERIOD = 0.064
EAST = 0.0


def sure(words, chosen):
    """Logarithms of probabilities of words that say one of them."""
    return np.log(np.where(np.arange(len(words)) == words.index(chosen), 0.9, 0.1 / len(words)))


def shown(*vehicles):
    """A picture of vehicles: colour and body each."""
    count = len(vehicles)
    colours = [sure(NAMES, colour) for colour, _ in vehicles]
    bodies = [sure(BODIES, body) for _, body in vehicles]
    nothing = np.zeros((count, 2))
    return Detections(
        np.full(count, 0.9),
        nothing,
        np.zeros((count, 4)),
        np.array(colours).reshape(count, len(NAMES)),
        np.array(bodies).reshape(count, len(BODIES)),
    )


def heading(angles):
    angles = np.array(angles, np.float64)
    return np.stack([np.cos(angles), np.sin(angles), np.cos(2 * angles), np.sin(2 * angles)], 1)


def watched(vehicles, ways, angles, looks=18):
    """Candidates that have been watched: `ways` and `angles` are functions of the time."""
    candidates = Candidates()
    for look in range(looks):
        time = look * PERIOD
        where = np.array([way(time) for way in ways])
        turned = heading([angle(time) for angle in angles])
        candidates.look(shown(*vehicles), where, turned, PERIOD if look else 0.0)
    return candidates


def still(*place):
    return lambda _: place


def at(angle):
    return lambda _: angle


def meant(claim, candidates, place):
    seen = candidates.seen()
    assert len(seen.row) == len(place)
    return int(judged(claim, seen, np.array(place)).argmax())


CARS = [("red", BodyWord.SEDAN), ("green", BodyWord.SEDAN), ("red", BodyWord.VAN)]
PLACES = [(0.2, 0.5), (0.5, 0.2), (0.8, 0.9)]


@pytest.mark.parametrize(
    ("claim", "who"),
    [
        (Claim(BodyWord.SEDAN, "green"), 1),
        (Claim(BodyWord.VEHICLE, "green"), 1),
        (Claim(BodyWord.VAN, "red"), 2),
        (Claim(BodyWord.CAR, "red", place=PicturePlace.RIGHT), 2),
        (Claim(BodyWord.CAR, "red", place=PicturePlace.LEFTMOST), 0),
        (Claim(BodyWord.VEHICLE, place=PicturePlace.TOPMOST), 1),
        (Claim(BodyWord.VEHICLE, place=PicturePlace.BOTTOMMOST), 2),
    ],
)
def test_looks_and_places(claim, who):
    places = [still(0.0, 0.0), still(20.0, 0.0), still(0.0, 20.0)]
    candidates = watched(CARS, places, [at(EAST)] * 3)
    assert meant(claim, candidates, PLACES) == who


@pytest.mark.parametrize(
    ("doing", "who"),
    [
        (MotionWord.STANDING, 0),
        (MotionWord.STRAIGHT, 1),
        (MotionWord.LEFT_TURN, 2),
        (MotionWord.RIGHT_TURN, 3),
    ],
)
def test_what_they_do_tells_them_apart(doing, who):
    def bend(sign):
        radius = 10.0

        def way(time):
            angle = 0.6 * time
            return 30.0 + radius * np.sin(angle), sign * (30.0 + radius * (1.0 - np.cos(angle)))

        return way

    ways = [still(0.0, 0.0), lambda time: (10.0 + 6.0 * time, 0.0), bend(1.0), bend(-1.0)]
    angles = [at(EAST), at(EAST), lambda time: 0.6 * time, lambda time: -0.6 * time]
    candidates = watched([("red", BodyWord.SEDAN)] * 4, ways, angles)
    claim = Claim(BodyWord.SEDAN, "red", doing=doing)
    assert meant(claim, candidates, [(0.5, 0.5)] * 4) == who


@pytest.mark.parametrize(
    ("bearing", "who"), [(Bearing.BEHIND, 1), (Bearing.AHEAD, 2), (Bearing.BESIDE, 3)]
)
def test_where_they_are_from_another_as_that_one_heads(bearing, who):
    """The truck stands and heads east, as its picture tells."""
    cars = [("blue", BodyWord.TRUCK), *[("red", BodyWord.SEDAN)] * 3]
    places = [still(0.0, 0.0), still(-11.0, 0.0), still(11.0, 0.0), still(1.0, 4.0)]
    candidates = watched(cars, places, [at(EAST)] * 4)
    claim = Claim(
        BodyWord.SEDAN, "red", bearing=bearing, other_body=BodyWord.TRUCK, other_colour="blue"
    )
    assert meant(claim, candidates, [(0.5, 0.5)] * 4) == who


def test_a_target_that_has_vanished_is_found_again_by_its_looks():
    """It comes out from under cover where nobody expects it, beside one of another colour."""
    candidates = watched(CARS[:1], [still(0.0, 0.0)], [at(EAST)])
    candidates.target = 0
    for _ in range(10):
        candidates.look(shown(), np.zeros((0, 2)), np.zeros((0, 4)), PERIOD)
    where = np.array([(3.4, 0.0), (3.0, 3.0)])
    for _ in range(4):
        candidates.look(shown(CARS[0], ("blue", BodyWord.VAN)), where, heading([0, 0]), PERIOD)
    np.testing.assert_allclose(candidates.motion.place[candidates.target], where[0], atol=0.3)


def test_one_that_looks_otherwise_is_not_taken_for_a_hidden_target():
    """It drives slowly over the place where the target stands under cover."""
    candidates = watched(CARS[:1], [still(0.0, 0.0)], [at(EAST)])
    candidates.target = 0
    for look in range(12):
        where = np.array([(0.3 * look - 0.6, 0.0)])
        candidates.look(shown(("blue", BodyWord.VAN)), where, heading([0]), PERIOD)
    assert candidates.target == 0
    np.testing.assert_allclose(candidates.motion.place[0], (0.0, 0.0), atol=0.1)


def test_a_listener_sees_as_it_was_trained():
    with pytest.raises(ConfigError, match="'eyas-words' sees and acts as it was trained"):
        open_policy("eyas-words", {"observation": {"width": 80, "height": 60}})
    with pytest.raises(ConfigError, match="--sample: not allowed for 'eyas-words'"):
        open_policy("eyas-words", {}, sampled=True)
