"""Phrases about targets, judged by a check that shares no code with what generates them.

It reads a phrase by the plain meaning of its words, without the generator's margins, and asks of
each mover of which a part is in the picture whether it fits: one does, the target.
"""

import math
from functools import lru_cache

import numpy as np
import pytest

from eyas.core.config import updated
from eyas.core.rng import stream
from eyas.settings.file import load_settings
from eyas.settings.preset import preset_file
from eyas.sim.build import build_simulation
from eyas.sim.worlds import each_alone
from eyas.targets.catalogue import MODELS, kind_of
from eyas.targets.colour_names import COLOUR_NAMES
from eyas.targets.grammar.attributes import ATTRIBUTES, claim_of
from eyas.targets.grammar.claims import Bearing
from eyas.targets.grammar.naming import NO_PHRASE, PhraseKind, contradictory, phrase_about
from eyas.targets.grammar.wording import CHARACTERS, LONGEST, WORDINGS, Wording

CARS = {
    "BmwX5Simple": "suv",
    "RangeRoverSportSVRSimple": "suv",
    "CitroenCZeroSimple": "small_car",
    "ToyotaPriusSimple": "hatchback",
    "LincolnMKZSimple": "sedan",
    "TeslaModel3Simple": "sedan",
}
ON_ROADS = {
    **CARS,
    "MercedesBenzSprinterSimple": "van",
    "BusSimple": "bus",
    "TruckSimple": "truck",
    "TruckTrailerSimple": "truck",
    "TruckTankSimple": "truck",
    "ScooterSimple": "motorcycle",
    "MotorbikeSimple": "motorcycle",
}


def called(word, name):
    own = ON_ROADS.get(name, "person" if name.startswith("Pedestrian") else "robot")
    if word == "vehicle":
        return name in ON_ROADS
    return name in CARS if word == "car" else own == word


def nearest_name(colour):
    def away(name):
        other = COLOUR_NAMES[name]
        red = (colour[0] + other[0]) / 2
        squares = [(a - b) ** 2 for a, b in zip(colour, other, strict=True)]
        return (2 + red) * squares[0] + 4 * squares[1] + (3 - red) * squares[2]

    return min(COLOUR_NAMES, key=away)


def does(word, mover):
    moves, turn = mover["speed"] >= mover["slowest"], mover["yaw_rate"]
    return {
        "standing": not moves,
        "moving": moves,
        "straight": moves and abs(turn) < 0.15,
        "left_turn": moves and turn >= 0.15,
        "right_turn": moves and turn <= -0.15,
    }[word]


def bears(word, mover, reference):
    if mover is reference:
        return False
    east, north = mover["middle"] - reference["middle"]
    cosine, sine = math.cos(reference["yaw"]), math.sin(reference["yaw"])
    ahead, left = cosine * east + sine * north, cosine * north - sine * east
    length = (mover["size"][0] + reference["size"][0]) / 2
    width = (mover["size"][1] + reference["size"][1]) / 2
    if word == "beside":
        return abs(ahead) < length and abs(left) < width + 5.0
    along = ahead if word == "ahead" else -ahead
    return 0.0 < along < length + 15.0 and abs(left) < width + 0.5


def those_who_fit(claim, movers):
    """Return the movers that a claim fits by the plain meaning of its words."""
    fit = [one for one in movers if called(claim.body, one["name"])]
    if claim.colour is not None:
        fit = [one for one in fit if one["colour"] == claim.colour]
    if claim.doing is not None:
        fit = [one for one in fit if does(claim.doing, one)]
    if claim.other is not None:
        (reference,) = those_who_fit(claim.other, movers)
        fit = [one for one in fit if bears(claim.bearing, one, reference)]
    if claim.place is not None:
        axis = claim.place in ("top", "bottom", "topmost", "bottommost")
        sign = -1 if claim.place in ("right", "bottom", "rightmost", "bottommost") else 1
        if str(claim.place).endswith("most"):
            first = min((sign * one["place"][axis] for one in fit), default=0.0)
            fit = [one for one in fit if sign * one["place"][axis] == first]
        else:
            fit = [one for one in fit if sign * (one["place"][axis] - 0.5) < 0.0]
    return fit


@lru_cache
def grid(length, width, height, ahead):
    """Return points all over the box of a mover, in its own frame [m]."""
    x = np.linspace(ahead - length / 2, ahead + length / 2, 7)
    y, z = np.linspace(-width / 2, width / 2, 4), np.linspace(0.0, height, 3)
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)


def in_picture(simulation, tracker):
    """Return what a camera has in view, by points of each mover that are in its picture."""
    actors, model = simulation.actors_around(tracker)
    colours = simulation.looks_around(tracker).colour[0]
    cameras = simulation.snapshot.cameras
    camera, axes = cameras.position[tracker], cameras.rotation[tracker]
    wide = math.tan(cameras.field_of_view[tracker] / 2)
    target, movers = int(simulation.snapshot.targets.actor[tracker]), []
    near = np.linalg.norm(actors.position[0] - camera, axis=1) < 110.0
    for actor in np.flatnonzero(near & actors.present[0]).tolist():
        kind, size = kind_of(int(model[actor])), MODELS[int(model[actor])].size
        yaw = float(actors.yaw[0, actor])
        cosine, sine = math.cos(yaw), math.sin(yaw)
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        points = grid(*size, kind.ahead) @ turn.T + actors.position[0, actor]
        seen = (points - camera) @ axes
        depth = np.maximum(seen[:, 0], 1e-6)
        place = np.stack(
            [0.5 - seen[:, 1] / depth / wide / 2, 0.5 - seen[:, 2] / depth / wide / 1.5], axis=1
        )
        shown = (seen[:, 0] > 0.0) & ((place > 0.0) & (place < 1.0)).all(axis=1)
        if not shown.any() and actor != target:
            continue
        middle = seen.mean(axis=0)
        movers.append(
            {
                "actor": actor,
                "name": MODELS[int(model[actor])].name,
                "colour": nearest_name(colours[actor].tolist()),
                "speed": float(actors.speed[0, actor]),
                "slowest": kind.slowest,
                "yaw_rate": float(actors.yaw_rate[0, actor]),
                "yaw": yaw,
                "middle": points[:, :2].mean(axis=0),
                "size": size,
                "place": (0.5 - middle[1] / middle[0] / wide / 2,
                          0.5 - middle[2] / middle[0] / wide / 1.5),
            }
        )  # fmt: skip
    return movers


def crowded(count, **changes):
    """Return trackers 45 m above dense traffic, at the start of their episodes."""
    traffic = {
        "demand": "keep_alive",
        "vehicle_type": {"passenger": 0.7, "bus": 0.1, "truck": 0.1, "trailer": 0.05,
                         "motorcycle": 0.05},
        "max_vehicles": 320,
    }  # fmt: skip
    settings = {"traffic": traffic, "start": {"height": 45.0}, "done": {"total_steps": 500}}
    config = updated(load_settings(preset_file("dat-eval")), settings)
    simulation = build_simulation(updated(config, changes), each_alone(count))
    simulation.reset()
    return simulation


def check(simulation, count, first=0):
    """Check the phrases about the targets of some trackers; return how many there are by kind."""
    kinds = dict.fromkeys((*PhraseKind, None), 0)
    for tracker in range(count):
        target = int(simulation.snapshot.targets.actor[tracker])
        view = simulation.view.in_view(tracker)
        rng = stream(first + tracker, "phrases")
        row = view.row_of(target)
        phrase = phrase_about(view, row, rng, tuple(Wording)[tracker % 2])
        kinds[phrase.kind] += 1
        if phrase.claim is None:
            assert phrase == NO_PHRASE
            assert not phrase.attributes.any()
            continue
        assert claim_of(phrase.attributes) == phrase.claim
        movers = in_picture(simulation, tracker)
        assert [one["actor"] for one in those_who_fit(phrase.claim, movers)] == [target], phrase
        wrong = contradictory(phrase.claim, view, rng)
        if wrong is not None:
            changed = [a != b for a, b in zip(wrong, phrase.claim, strict=True)]
            assert sum(changed) == 1
            assert those_who_fit(wrong, movers) == [], (phrase, wrong)
        kinds["contradicted"] = kinds.get("contradicted", 0) + (wrong is not None)
    return kinds


def test_a_phrase_fits_its_target_and_nothing_else_in_view():
    found = check(crowded(1000), 1000)
    assert found[None] <= 20
    assert min(found[kind] for kind in PhraseKind) >= 80
    assert found["contradicted"] >= 970


@pytest.mark.slow
@pytest.mark.parametrize("place", ["citystreet", "downtown"])
def test_ten_thousand_phrases_fit_nothing_else_in_view(place):
    simulation = crowded(500, world={"map": place})
    none = 0
    for batch in range(10):
        none += check(simulation, 500, 500 * batch)[None]
        simulation.reset()
    assert none <= 100


@pytest.mark.slow
@pytest.mark.parametrize("target", ["Pedestrian", "BB-8"])
def test_people_and_robots_are_told_apart_too(target):
    extras = [{"kind": target, "count": 60}]
    found = check(crowded(60, target=target, extras=extras, start={"height": 12.0}), 60)
    assert found[None] < 12


def test_the_same_seed_gives_the_same_words_and_another_others():
    view = crowded(1).view.in_view(0)
    said = [phrase_about(view, 0, stream(seed, "words")).words for seed in (1, 1, 2, 3, 4, 5)]
    assert said[0] == said[1]
    assert len(set(said)) > 2


def test_training_and_test_have_no_expression_in_common():
    training, test = (WORDINGS[wording] for wording in (Wording.TRAINING, Wording.TEST))
    assert not set(training.sentences) & set(test.sentences)
    for group in ("doing", "place", "bearing"):
        ours, theirs = getattr(training, group), getattr(test, group)
        assert set(ours) == set(theirs)
        assert not {each for some in ours.values() for each in some} & {
            each for some in theirs.values() for each in some
        }


def test_sentences_of_training_and_test_are_disjoint():
    simulation, said = crowded(150), {wording: set() for wording in Wording}
    for tracker in range(150):
        view = simulation.view.in_view(tracker)
        for wording in Wording:
            for seed in range(4):
                words = phrase_about(view, 0, stream(seed, "words"), wording).words
                assert set(words) <= set(CHARACTERS)
                assert len(words) <= LONGEST
                said[wording].add(words)
    assert said[Wording.TRAINING] & said[Wording.TEST] == {""} & said[Wording.TEST]


def test_each_attribute_has_a_name_of_its_own():
    assert len(set(ATTRIBUTES)) == len(ATTRIBUTES)
    assert {f"bearing_{bearing}" for bearing in Bearing} < set(ATTRIBUTES)
