"""Targets named in words among look-alikes, and somebody in a crowd."""

from dataclasses import replace

import numpy as np
import pytest

from art.cars.parked import COLOURS as PARKED
from eyas.benchmark.episodes import from_above
from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch, episode_groups
from eyas.benchmark.episodes.look_alikes import CASES, COLOURS, case_of
from eyas.benchmark.episodes.neighbours import CLOSE, COMPANY
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.crowd import TEST_TRAFFIC, switches
from eyas.benchmark.protocols.referring import ReferringScenario
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.policies.policy import Instruction, PolicyInput, Start
from eyas.engine.policies.sight import subjects
from eyas.engine.settings.env import EnvConfig
from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_distances
from eyas.engine.targets.grammar.attributes import ATTRIBUTES, attributes_of
from eyas.engine.targets.grammar.claims import Claim, fits
from eyas.engine.targets.grammar.in_view import BodyWord
from eyas.engine.targets.grammar.naming import PhraseKind
from eyas.engine.targets.grammar.wording import WORDINGS, Wording

PROTOCOL = PROTOCOLS.get("referring")
HOME = Place("citystreet", "day", "SUMO_VEHICLE")
FIRST = 1_000_000
SHORT = {"done": {"total_steps": 3_000}}
BRIEF = {"done": {"total_steps": 2_000}}
"""For policies that look: their gaps are 0.75, 1 and 0, as in twice as many longer flights."""


def group_of(seeds, variants=("right",), place=HOME):
    """Return the starts of seeds that have one."""
    specs = [EpisodeSpec(place, 0.0, s, variant=v) for s in seeds for v in variants]
    (group,) = episode_groups(specs, PROTOCOL, EnvConfig())
    return specs, group


@pytest.fixture(scope="module")
def many():
    """Seventy-eight starts, six of each case."""
    return group_of(range(FIRST, FIRST + 78))


def base_of(claim, kind):
    if kind is PhraseKind.COLOUR:
        return Claim(claim.body)
    return Claim(BodyWord.VEHICLE if kind is PhraseKind.BODY else claim.body, claim.colour)


@pytest.mark.slow
def test_words_fit_the_target_alone_and_wrong_ones_nothing(many, plain_words):
    _, group = many
    known = [(row, start) for row, start in enumerate(group.staged) if start is not None]
    assert len(known) > 70
    targets = group.simulation.snapshot.targets.actor
    for row, start in known:
        assert targets[row] == start.actor != start.other
        movers = plain_words.in_picture(group.simulation, row)

        def who(variant, start=start, movers=movers):
            found = plain_words.those_who_fit(start.phrases[variant].claim, movers)
            return [one["actor"] for one in found]

        assert who("right") == [start.actor]
        assert who("other") == [start.other]
        assert who("contradictory") == []
        assert start.phrases["none"].words == ""
        assert not start.phrases["none"].attributes.any()
        kind, count = start.case
        view = group.simulation.view.in_view(row)
        assert fits(base_of(start.phrases["right"].claim, kind), view).sum() == count + 1


@pytest.mark.slow
def test_all_cases_are_there_and_words_are_those_of_the_test_set(many):
    specs, group = many
    cases = {start.case for start in group.staged if start is not None}
    assert cases == set(CASES) == {case_of(spec.seed) for spec in specs}
    frames = [each.partition("{}")[0] for each in WORDINGS[Wording.TEST].sentences]
    for start in group.staged:
        for variant in ("right", "other", "contradictory") if start is not None else ():
            assert start.phrases[variant].words.startswith(tuple(frames))


@pytest.mark.slow
def test_where_the_named_one_is_tells_nothing(many):
    """It is neither in the middle nor at the edge, nor first in any order, more than by chance."""
    _, group = many
    sides, ranks, orders = [], [], []
    for row, start in enumerate(group.staged):
        # By action, place and relation, the phrase itself decides who can be named.
        if start is None or start.case[0] not in (PhraseKind.COLOUR, PhraseKind.BODY):
            continue
        view = group.simulation.view.in_view(row)
        base = base_of(start.phrases["right"].claim, start.case[0])
        alike = np.flatnonzero(fits(base, view))
        target = view.row_of(start.actor)
        away = np.hypot(*(view.place[alike] - 0.5).T)
        ranks.append((away < away[alike == target]).sum() / (len(alike) - 1))
        orders.append((alike < target).sum() / (len(alike) - 1))
        sides.append(view.place[target])
    spread = 0.5 / np.sqrt(len(ranks))  # at most: of 0s and 1s
    assert abs(np.mean(ranks) - 0.5) < 3 * spread
    assert abs(np.mean(orders) - 0.5) < 3 * spread
    left, top = (np.array(sides) < 0.5).mean(axis=0)
    assert abs(left - 0.5) < 3 * spread
    assert abs(top - 0.5) < 3 * spread


def test_variants_of_an_episode_begin_alike_and_starts_repeat():
    seeds = list(range(FIRST, FIRST + 4))
    _, group = group_of(seeds, tuple(PROTOCOL.variants))
    _, again = group_of(seeds[::-1])
    snapshot, other = group.simulation.snapshot, again.simulation.snapshot
    for row in range(16):
        first, later = row - row % 4, 3 - row // 4
        assert group.staged[row] is group.staged[first]
        for one, two, place in ((snapshot, snapshot, first), (snapshot, other, later)):
            assert np.array_equal(one.cameras.position[row], two.cameras.position[place])
            assert np.array_equal(one.cameras.rotation[row], two.cameras.rotation[place])
            assert one.episodes.tick[row] == two.episodes.tick[place]
            assert one.targets.actor[row] == two.targets.actor[place]
        looks = group.simulation.looks_around(row)
        assert np.array_equal(looks.colour, group.simulation.looks_around(first).colour)
        assert again.staged[later].phrases == group.staged[row].phrases


def test_what_can_be_seen_is_measured_above_the_target(monkeypatch):
    specs, _ = group_of([FIRST, FIRST + 1])
    protocol = PROTOCOL.changed({"done": {"total_steps": 640}})
    middles = []

    def looked(simulation, *others):
        away = simulation.snapshot.targets.centre - simulation.snapshot.episodes.view_centre
        middles.append(np.hypot(*away[:, :2].T))
        return subjects(simulation, *others)

    monkeypatch.setattr("eyas.benchmark.episodes.episode_batch.subjects", looked)
    from_above._seen(specs, protocol, 0.128)
    assert len(middles) == 10
    assert np.max(middles) < 2.0


def test_no_parked_car_has_a_colour_of_look_alikes():
    taxi = (0.93, 0.70, 0.08)
    distances = np.sqrt(colour_distances(np.array([*PARKED.values(), taxi])))
    for name in COLOURS:
        own = distances[:, list(COLOUR_NAMES).index(name)]
        assert (own > 1.6 * distances.min(axis=1)).all(), name


def test_observations_hold_the_words_of_the_variant_not_the_truth():
    specs, group = group_of([FIRST], tuple(PROTOCOL.variants))
    env = EnvConfig.model_validate({"observation": {"parts": ["words", "attributes"]}})
    batch = EpisodeBatch(specs, PROTOCOL, env)
    told = ReferringScenario(batch, PROTOCOL, specs).instruction()
    batch.tell(told)
    everyone = np.ones(4, np.bool_)
    batch.look(everyone, everyone)
    assert batch.observations["words"] == told.words
    assert np.array_equal(batch.observations["attributes"], told.attributes)
    (start,) = {id(each): each for each in group.staged}.values()
    assert told.words == tuple(start.phrases[name].words for name in PROTOCOL.variants)
    assert len(set(told.words)) == 4


def flown(policy, seeds, changes=None):
    """Return the figures of a policy by variant, a list of dictionaries each."""
    specs = [EpisodeSpec(HOME, 0.0, s, variant=v) for s in seeds for v in PROTOCOL.variants]
    protocol = PROTOCOL if changes is None else PROTOCOL.changed(changes)
    flight = BatchFlight(specs, protocol, open_policy(policy, {}), delay_from("0"))
    records = [record for ended in flight.fly() for record in ended]
    return {v: [r.figures for r in records if r.variant == v] for v in PROTOCOL.variants}


def gap(figures):
    both = [one["language_gap"] for v in ("right", "other") for one in figures[v]]
    return sum(both) / len(both)


def test_who_knows_the_target_succeeds_with_any_words():
    figures = flown("follow", range(FIRST, FIRST + 3), SHORT)
    for variant in PROTOCOL.variants:
        assert [one[f"success_{variant}"] for one in figures[variant]] == [1.0] * 3
    assert [one["chosen"] for one in figures["right"]] == [1.0] * 3
    assert [one["obeyed"] for one in figures["other"]] == [0.0] * 3
    assert gap(figures) == 0.0


@pytest.mark.slow
def test_who_does_not_listen_has_no_language_gap():
    for policy in ("random", "hover"):
        figures = flown(policy, range(FIRST, FIRST + 4), SHORT)
        assert gap(figures) == 0.0
        for one, two in zip(figures["right"], figures["none"], strict=True):
            assert one["success_right"] == two["success_none"]


@pytest.mark.slow
def test_words_without_pictures_are_of_little_use():
    figures = flown("own_policies:WordsOnly", range(FIRST, FIRST + 13), SHORT)
    assert sum(one["success_right"] for one in figures["right"]) <= 6


def test_a_network_may_have_the_attributes_as_an_input(tmp_path):
    pytest.importorskip("onnxruntime")
    onnx = pytest.importorskip("onnx")
    helper, kind = onnx.helper, onnx.TensorProto
    weights = np.zeros((len(ATTRIBUTES), 7), np.float32)
    weights[ATTRIBUTES.index("colour_said"), 2] = 1.0  # flies to the left if a colour is said
    biases = np.eye(7, dtype=np.float32)[6] * 0.5  # else hovers
    graph = helper.make_graph(
        [helper.make_node("Gemm", ["attributes", "weights", "biases"], ["logits"])],
        "listener",
        [
            helper.make_tensor_value_info("image", kind.UINT8, ["n", 3, 12, 16]),
            helper.make_tensor_value_info("attributes", kind.FLOAT, ["n", len(ATTRIBUTES)]),
        ],
        [helper.make_tensor_value_info("logits", kind.FLOAT, ["n", 7])],
        [onnx.numpy_helper.from_array(each, name)
         for each, name in ((weights, "weights"), (biases, "biases"))],
    )  # fmt: skip
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    entry = model.metadata_props.add()
    entry.key = "eyas"
    entry.value = '{"observation": {"width": 16, "height": 12, "layout": "chw"}}'
    onnx.save(model, tmp_path / "listener.onnx")
    policy = open_policy(str(tmp_path / "listener.onnx"), {})
    assert policy.told == {"attributes"}
    claims = [None, Claim(BodyWord.CAR), Claim(BodyWord.CAR, "red")]
    said = np.stack([attributes_of(claim) for claim in claims])
    policy.begin(
        Start(np.arange(3), lambda: np.zeros((3, 4), np.int32), Instruction(("",) * 3, said))
    )
    picture = np.zeros((3, 3, 12, 16), np.uint8)
    sight = PolicyInput(picture, np.ones(3, np.bool_), None, None, None)
    assert policy.act(sight).actions.tolist() == [6, 6, 2]


@pytest.mark.slow
def test_a_servo_that_listens_has_a_gap_and_its_twin_has_none():
    pytest.importorskip("cv2")
    seeds = range(FIRST, FIRST + 4)
    assert gap(flown("attribute-servo", seeds, BRIEF)) > 0.3
    assert gap(flown("salient-servo", seeds, BRIEF)) == 0.0


@pytest.mark.slow
def test_the_listener_listens():
    pytest.importorskip("onnxruntime")
    assert gap(flown("eyas-words", range(FIRST, FIRST + 4), BRIEF)) > 0.6


def test_switches_go_from_the_target_to_another_for_a_while():
    follows = np.array([7, 7, 3, 7, 7, 3, 3, 3, -1, 4, 4, 4, 7, 5, 5, 5])
    assert switches(follows, 7, 3) == 2
    assert switches(follows, 7, 1) == 3
    assert switches(follows, 9, 1) == 0


@pytest.mark.slow
def test_somebody_in_a_crowd_has_others_near_who_look_the_same():
    # One recording of three: who walks in it takes seconds to make.
    protocol = replace(PROTOCOLS.get("crowd"), recordings=TEST_TRAFFIC[:1])
    place = Place("citystreet", "day", "Pedestrian")
    episodes = protocol.choose([place], protocol, 1, FIRST)
    assert [episode.direction for episode in episodes] == list(protocol.directions)
    for group in episode_groups(episodes, protocol, EnvConfig()):
        targets = group.simulation.snapshot.targets
        for row in range(len(group.rows)):
            actors, models = group.simulation.actors_around(row)
            away = actors.position[0, :, :2] - targets.position[row, :2]
            near = np.hypot(*away.T) <= CLOSE
            assert (near & actors.present[0]).sum() > COMPANY
            assert len(set(models[near].tolist())) == 1
            assert len(np.unique(group.simulation.looks_around(row).colour[0], axis=0)) == 1
