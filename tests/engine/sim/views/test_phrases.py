"""Phrases about targets, judged by a reader that shares no code with what generates them."""

import pytest

from eyas.engine.core.config import updated
from eyas.engine.core.rng import stream
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.targets.grammar.attributes import ATTRIBUTES, claim_of
from eyas.engine.targets.grammar.claims import Bearing
from eyas.engine.targets.grammar.naming import NO_PHRASE, PhraseKind, contradictory, phrase_about
from eyas.engine.targets.grammar.wording import CHARACTERS, LONGEST, WORDINGS, Wording


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


def check(simulation, plain, count, first=0):
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
        movers = plain.in_picture(simulation, tracker)
        assert [one["actor"] for one in plain.those_who_fit(phrase.claim, movers)] == [target], (
            phrase
        )
        wrong = contradictory(phrase.claim, view, rng)
        if wrong is not None:
            changed = [a != b for a, b in zip(wrong, phrase.claim, strict=True)]
            assert sum(changed) == 1
            assert plain.those_who_fit(wrong, movers) == [], (phrase, wrong)
        kinds["contradicted"] = kinds.get("contradicted", 0) + (wrong is not None)
    return kinds


def test_a_phrase_fits_its_target_and_nothing_else_in_view(plain_words):
    found = check(crowded(400), plain_words, 400)
    assert found[None] <= 20  # three of four cars are white, grey, black or silver
    assert min(found[kind] for kind in PhraseKind) >= 30
    assert found["contradicted"] >= 370


@pytest.mark.thorough
@pytest.mark.parametrize("place", ["citystreet", "downtown"])
def test_ten_thousand_phrases_fit_nothing_else_in_view(place, plain_words):
    simulation = crowded(500, world={"map": place})
    none = 0
    for batch in range(10):
        none += check(simulation, plain_words, 500, 500 * batch)[None]
        simulation.reset()
    assert none <= 250


@pytest.mark.slow
@pytest.mark.parametrize("target", ["Pedestrian", "BB-8"])
def test_people_and_robots_are_told_apart_too(target, plain_words):
    extras = [{"kind": target, "count": 60}]
    found = check(
        crowded(60, target=target, extras=extras, start={"height": 12.0}), plain_words, 60
    )
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
    simulation, said = crowded(40), {wording: set() for wording in Wording}
    for tracker in range(40):
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
