"""Terms of the reward of one's own."""

import sys

import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.task.config import RewardConfig
from eyas.engine.task.terms import BUILTIN, RewardTerms

MODULE = """
import numpy as np

def height(snapshot):
    return snapshot.trackers.position[:, 2]

def still(snapshot):
    return [1.0 if speed == 0.0 else 0.0 for speed in snapshot.targets.speed]

def total(snapshot):
    return np.float64(1.0)

def columns(snapshot):
    return snapshot.trackers.position

def near(offset, visible, weight=2.0):
    return weight * visible / (1.0 + offset)

def lateral(target_position_body):
    return abs(target_position_body[:, 1])

def ends(snapshot):
    raise SystemExit(0)

def words(snapshot):
    return "none"

def misspelt(ofset, visible):
    return visible

def alone(ofset):
    return ofset

number = 3.0
"""


@pytest.fixture
def module(tmp_path, monkeypatch):
    """A module of terms by the name `own_terms`, as long as the test lasts."""
    (tmp_path / "own_terms.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "own_terms", raising=False)
    yield
    sys.modules.pop("own_terms", None)  # another folder has one by this name, too


@pytest.fixture
def scored(snapshot):
    """Three trackers at heights of 1, 2 and 3 m with built-in rewards of 0.1, 0.2 and 0.3."""
    snapshot.trackers.position[:, 2] = 1.0, 2.0, 3.0
    snapshot.targets.speed[:] = 0.0, 4.0, 0.0
    snapshot.episodes.reward[:] = 0.1, 0.2, 0.3
    return snapshot


def test_without_terms_the_reward_is_the_built_in_one(scored):
    total, terms = RewardTerms(RewardConfig()).of(scored)
    assert total.tolist() == scored.episodes.reward.tolist()
    assert list(terms) == [BUILTIN]


@pytest.mark.usefixtures("module")
def test_terms_are_added_by_their_weights_and_told_without(scored):
    weights = {"own_terms:height": -0.5, "own_terms:still": 10.0}
    total, terms = RewardTerms(RewardConfig(weight=2.0, terms=weights)).of(scored)
    assert list(terms) == [BUILTIN, *weights]
    assert terms[BUILTIN].tolist() == [0.1, 0.2, 0.3]
    assert terms["own_terms:height"].tolist() == [1.0, 2.0, 3.0]
    assert terms["own_terms:still"].tolist() == [1.0, 0.0, 1.0]
    assert total == pytest.approx([0.2 - 0.5 + 10.0, 0.4 - 1.0, 0.6 - 1.5 + 10.0])


@pytest.mark.usefixtures("module")
def test_values_told_stay_though_a_term_gave_the_snapshot_s_own_array(scored):
    _, terms = RewardTerms(RewardConfig(terms={"own_terms:height": 1.0})).of(scored)
    scored.trackers.position[:] = 99.0
    scored.episodes.reward[:] = 99.0
    assert terms["own_terms:height"].tolist() == [1.0, 2.0, 3.0]
    assert terms[BUILTIN].tolist() == [0.1, 0.2, 0.3]


@pytest.mark.usefixtures("module")
@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("no_such_module:height", "there is no module 'no_such_module'"),
        ("own_terms:no_such", "the module 'own_terms' has no 'no_such'"),
        ("own_terms", "cannot be imported "),
        (":height", "is not a path; allowed: package.module:attribute"),
        ("", "cannot be imported "),
        ("own_terms:number", "is not a function"),
    ],
)
def test_what_is_no_function_is_refused_in_one_line(name, line):
    with pytest.raises(ConfigError, match=rf"^reward\.terms: '{name}':? {line}") as caught:
        RewardTerms(RewardConfig(terms={name: 1.0}))
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("module")
@pytest.mark.parametrize(("name", "shape"), [("total", "()"), ("columns", "(3, 3)")])
def test_another_shape_is_refused_in_one_line(scored, name, shape):
    terms = RewardTerms(RewardConfig(terms={f"own_terms:{name}": 1.0}))
    with pytest.raises(ConfigError) as caught:
        terms.of(scored)
    assert str(caught.value) == (
        f"reward.terms.own_terms:{name}: it returned an array of shape {shape}; "
        "allowed: (3,), a number for each tracker"
    )


@pytest.mark.usefixtures("module")
def test_a_term_may_ask_for_quantities_by_name(scored):
    scored.episodes.offset[:] = 0.0, 1.0, 3.0
    scored.targets.centre[:] = 10.0, 0.0, 0.0
    scored.trackers.position[:] = scored.cameras.position[:] = 0.0
    scored.episodes.relative_position[:, 1] = -1.0, 0.0, 2.0
    weights = {"own_terms:near": 1.0, "own_terms:lateral": -1.0}
    _, terms = RewardTerms(RewardConfig(terms=weights)).of(scored)
    assert terms["own_terms:near"].tolist() == [2.0, 1.0, 0.5]
    assert terms["own_terms:lateral"].tolist() == [1.0, 0.0, 2.0]


@pytest.mark.parametrize("term", ["misspelt", "alone"])
@pytest.mark.usefixtures("module")
def test_a_quantity_that_does_not_exist_is_refused_with_the_nearest(term):
    with pytest.raises(ConfigError, match="asks for 'ofset'; did you mean 'offset'"):
        RewardTerms(RewardConfig(terms={f"own_terms:{term}": 1.0}))


@pytest.mark.usefixtures("module")
def test_a_term_that_ends_the_program_or_gives_no_numbers_is_one_line(scored):
    for name, line in (
        ("ends", r"'own_terms:ends': its code tried to end the program: SystemExit\(0\) in .*"),
        ("words", r"own_terms:words: it returned no numbers; allowed: an array of shape \(3,\)"),
    ):
        with pytest.raises(ConfigError, match=line):
            RewardTerms(RewardConfig(terms={f"own_terms:{name}": 1.0})).of(scored)
