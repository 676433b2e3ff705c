import pytest

from eyas.targets.catalogue import KINDS, MODELS, kind_of, model_index
from eyas.targets.colour_names import COLOUR_NAMES, colour_name
from eyas.targets.words import looks_in_words, motion_in_words, phrases, words_among, words_of

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
    assert len(looks_in_words(MODELS.index(kind.models[0]))) == len(kind.colours)


def test_the_longest_words_tell_every_model_from_every_other():
    seen = [phrases(m, kind_of(m).colours[0])[-1] for m in range(len(MODELS))]
    assert len(set(seen)) == len(MODELS)
    assert all(motion_in_words(m) for m in range(len(MODELS)))


@pytest.mark.parametrize("model", range(len(MODELS)), ids=lambda m: MODELS[m].name)
def test_phrases_of_a_model_differ(model):
    own = phrases(model, kind_of(model).colours[0])
    assert len(set(own)) == len(own)
    assert own[0].startswith(("a ", "an "))
    assert words_of(model, kind_of(model).colours[0]) == own[0]


def test_words_say_as_little_as_tells_a_target_from_the_others():
    sedan, suv = model_index("LincolnMKZSimple"), model_index("BmwX5Simple")
    tesla = model_index("TeslaModel3Simple")
    assert words_among(sedan, RED, []) == "a red car"
    assert words_among(sedan, RED, [(sedan, BLUE)]) == "a red car"
    assert words_among(sedan, RED, [(suv, RED)]) == "a red sedan"
    assert words_among(tesla, RED, [(suv, RED), (sedan, RED)]) == "a red sedan with a glass roof"
    assert words_among(sedan, RED, [(sedan, RED)]) == "a red Lincoln MKZ sedan"


def test_people_are_known_by_their_clothes():
    first, coat = model_index("Pedestrian"), model_index("Pedestrian2")
    assert words_of(coat, BLUE) == "a pedestrian in a blue coat"
    assert words_of(first, (0.88, 0.44, 0.10)) == "a pedestrian in an orange shirt"
    other = model_index("Pedestrian7")
    told = words_among(coat, BLUE, [(other, BLUE)])
    assert told == "a pedestrian in a blue coat and black trousers, with long brown hair"
