import pytest

from eyas.engine.targets.catalogue import KINDS, MODELS, kind_of, model_index
from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_name
from eyas.engine.targets.words import (
    ObjectInView,
    colour_words,
    distinguishing_phrase,
    phrases,
    words_of,
)

RED, BLUE = (0.74, 0.10, 0.09), (0.13, 0.27, 0.62)


def test_colours_have_the_names_that_people_give_them():
    for name, colour in COLOUR_NAMES.items():
        assert colour_name(colour) == name
    assert colour_name((1.0, 0.0, 0.0)) == "red"
    assert colour_name((0.0, 0.0, 1.0)) == "blue"
    assert colour_name((1.0, 1.0, 1.0)) == "white"
    assert colour_name((0.0, 0.0, 0.0)) == "black"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_all_colours_of_a_kind_have_names_of_their_own(kind):
    assert len(colour_words(MODELS.index(kind.models[0]))) == len(set(kind.colours))


def test_the_longest_words_tell_every_model_from_every_other():
    seen = [phrases(m, kind_of(m).colours[0])[-1] for m in range(len(MODELS))]
    assert len(set(seen)) == len(MODELS)
    assert all(model.motion for model in MODELS)


@pytest.mark.parametrize("model", range(len(MODELS)), ids=lambda m: MODELS[m].name)
def test_phrases_of_a_model_differ(model):
    own = phrases(model, kind_of(model).colours[0])
    assert len(set(own)) == len(own)
    assert own[0].startswith(("a ", "an "))
    assert words_of(model, kind_of(model).colours[0]) == own[0]


def seen(model: str, colour=RED, **changes: float) -> ObjectInView:
    return ObjectInView(model_index(model), colour, 10.0, 0.0, 0.5, 25.0)._replace(**changes)


def test_words_say_as_little_as_tells_a_target_from_the_others():
    sedan, suv, tesla = seen("LincolnMKZSimple"), seen("BmwX5Simple"), seen("TeslaModel3Simple")
    assert distinguishing_phrase(sedan, []) == "a red car"
    assert distinguishing_phrase(sedan, [seen("LincolnMKZSimple", BLUE)]) == "a red car"
    assert distinguishing_phrase(sedan, [suv]) == "a red sedan"
    assert distinguishing_phrase(tesla, [suv, sedan]) == "a red sedan with a glass roof"
    assert distinguishing_phrase(sedan, [seen("LincolnMKZSimple", BLUE), suv]) == "a red sedan"
    assert distinguishing_phrase(seen("CitroenCZeroSimple"), [suv]) == "a small red car"


def test_words_that_hold_for_another_do_not_tell_a_target():
    assert distinguishing_phrase(seen("BmwX5Simple"), [seen("RangeRoverSportSVRSimple")]) == (
        "a red BMW X5 SUV"
    )
    assert distinguishing_phrase(seen("LincolnMKZSimple"), [seen("TeslaModel3Simple")]) == (
        "a red Lincoln MKZ sedan"
    )
    truck, trailer = seen("TruckSimple"), seen("TruckTankSimple")
    assert distinguishing_phrase(truck, [trailer]) == "a red truck without a trailer"


def test_slow_robots_are_not_said_to_stand():
    slow, still = seen("Sojourner", speed=0.04), seen("Sojourner", speed=0.0)
    assert distinguishing_phrase(slow, [still]).endswith("solar panel, moving")
    assert distinguishing_phrase(still, [slow]).endswith("solar panel, standing still")
    spinning = seen("Create", speed=0.0, yaw_rate=2.0)
    told = distinguishing_phrase(spinning, [seen("Create", speed=0.0)])
    assert told.endswith("robot, turning on the spot")


def test_those_who_look_the_same_are_told_by_what_they_do():
    moving, still = seen("BmwX5Simple"), seen("BmwX5Simple", speed=0.0)
    left, right = (seen("BmwX5Simple", yaw_rate=rate) for rate in (0.4, -0.4))
    assert distinguishing_phrase(still, [moving, left]) == "a red car, standing still"
    assert distinguishing_phrase(moving, [still, left]) == "a red car, driving straight on"
    assert distinguishing_phrase(left, [right, still]) == "a red car, turning left"
    assert distinguishing_phrase(right, [left, moving]) == "a red car, turning right"
    walker = seen("Pedestrian2", BLUE, speed=1.3, yaw_rate=1.0)
    waiting = seen("Pedestrian2", BLUE, speed=0.0)
    assert distinguishing_phrase(walker, [waiting]) == "a pedestrian in a blue coat, walking"
    robots = seen("BB-8", speed=1.0), seen("BB-8", speed=0.0)
    assert distinguishing_phrase(robots[0], robots[1:]).endswith("on a ball, moving")


def test_those_who_do_the_same_are_told_by_their_places_with_as_few_rivals_as_may_be():
    row = [seen("BmwX5Simple", column=k / 10, distance=20.0 + 3 * k) for k in range(1, 8)]
    assert distinguishing_phrase(row[0], row[1:2]) == "a red car, the left one of two"
    assert distinguishing_phrase(row[1], row[:1]) == "a red car, the right one of two"
    between = ("second", "third", "fourth", "fifth", "sixth")
    places = [
        distinguishing_phrase(one, [other for other in row if other is not one]) for one in row
    ]
    assert places == [
        f"a red car, the {place} of seven"
        for place in ("leftmost", *(f"{nth} from the left" for nth in between), "rightmost")
    ]
    near, far = row[0]._replace(column=0.5), row[3]._replace(column=0.51)
    assert distinguishing_phrase(near, [far]) == "a red car, the nearer one of two"
    assert (
        distinguishing_phrase(far, [near, row[0]._replace(column=0.9)])
        == "a red car, the farthest of three"
    )
    sedans = [seen("LincolnMKZSimple", column=0.9)]
    assert distinguishing_phrase(row[0], [row[1], *sedans]) == "a red SUV, the left one of two"


def test_people_are_known_by_their_clothes():
    first, coat = model_index("Pedestrian"), model_index("Pedestrian2")
    assert words_of(coat, BLUE) == "a pedestrian in a blue coat"
    assert words_of(first, (0.88, 0.44, 0.10)) == "a pedestrian in an orange shirt"
    told = distinguishing_phrase(seen("Pedestrian2", BLUE), [seen("Pedestrian7", BLUE)])
    assert told == "a pedestrian in a blue coat and black trousers, with long brown hair"
