import pytest

from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.done import DoneReason, is_crash, judge

N = 1
# Heights are over the roads, whatever the floor is.
FLAT = Terrain.flat(-0.1)
CALM = {
    "lost": False,
    "position": [0.0, 0.0, 20.0],
    "velocity": [0.0, 0.0, 0.0],
    "angular_velocity": [0.0, 0.0, 0.0],
    "euler": [0.0, 0.0, 0.0],
    "commanded_position": [0.0, 0.0, 20.0],
    "target_centre": [5.0, 0.0, 0.3],
}
LIMITS = {"velocity": 30.0, "distance_error": 20.0, "total_steps": 1000}
BREACHES = [
    ("position", [0.0, 0.0, 1.99], DoneReason.HEIGHT),
    ("position", [0.0, 0.0, 50.01], DoneReason.HEIGHT),
    ("commanded_position", [15.0, -15.0, 20.0], DoneReason.DISTANCE),
    ("velocity", [-18.0, 24.0, 0.0], DoneReason.VELOCITY),
    ("angular_velocity", [0.0, 0.0, -6.3], DoneReason.YAW_RATE),
    ("euler", [1.23, 0.0, 0.0], DoneReason.TILT),
    ("euler", [0.0, -1.23, 0.0], DoneReason.TILT),
]
KEPT = [
    ("position", [0.0, 0.0, 2.0]),
    ("commanded_position", [14.0, 14.0, 900.0]),
    ("velocity", [29.9, 0.0, 500.0]),
    ("angular_velocity", [9.0, 9.0, 6.28]),
    ("euler", [1.21, 1.21, 3.0]),
]


@pytest.fixture
def rules(rules_with):
    return rules_with(done=LIMITS)


def fresh(step_count=500, reward=1.0, no_reward_count=0):
    """Return three trackers, of which number 1 is in the middle of an episode."""
    snapshot = Snapshot.create(3)
    episodes = snapshot.episodes
    episodes.step_count[N], episodes.reward[N] = step_count, reward
    episodes.no_reward_count[N] = no_reward_count
    return snapshot


def step(rules, snapshot, **changes):
    """Judge tracker 1 in a state that differs from a calm one; return its reason."""
    values = {**CALM, **changes}
    trackers, _, targets, episodes, _ = snapshot
    for name in CALM.keys() - {"lost", "target_centre"}:
        getattr(trackers, name)[N] = values[name]
    targets.centre[N], targets.lost[N] = values["target_centre"], values["lost"]
    reason = judge(trackers, targets, episodes, N, FLAT, rules)
    assert episodes.reason.tolist() == [0, reason, 0]
    assert episodes.done.tolist() == [False, reason > 0, False]
    return reason


def test_a_calm_tracker_goes_on(rules):
    assert step(rules, fresh()) == DoneReason.NONE


@pytest.mark.parametrize(("what", "value", "reason"), BREACHES)
def test_each_limit_has_its_reason(rules, what, value, reason):
    assert step(rules, fresh(), **{what: value}) == reason


@pytest.mark.parametrize(("what", "value"), KEPT)
def test_what_no_limit_is_about_ends_nothing(rules, what, value):
    assert step(rules, fresh(), **{what: value}) == DoneReason.NONE


def test_reasons_come_in_the_original_s_order(rules):
    snapshot = fresh(step_count=5000, reward=0.0, no_reward_count=500)
    wrong = {
        "position": [0.0, 0.0, 0.0], "commanded_position": [99.0, 0.0, 0.0],
        "velocity": [99.0, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 9.0],
        "euler": [2.0, 0.0, 0.0], "lost": True,
    }  # fmt: skip
    seen = [step(rules, snapshot, **wrong)]
    for what in wrong:
        wrong[what] = CALM[what]
        seen.append(step(rules, snapshot, **wrong))
    assert seen == list(range(DoneReason.HEIGHT, DoneReason.NO_REWARD + 1))
    snapshot.episodes.reward[N] = 1.0
    assert step(rules, snapshot) == DoneReason.STEP_LIMIT


def test_a_limit_that_is_kept_again_is_forgotten(rules):
    snapshot = fresh()
    assert step(rules, snapshot, euler=[2.0, 0.0, 0.0]) == DoneReason.TILT
    assert step(rules, snapshot) == DoneReason.NONE
    assert snapshot.episodes.breach[N] == DoneReason.NONE


def test_young_episodes_do_not_end_but_count_and_remember(rules):
    snapshot = fresh(step_count=98, reward=0.0)
    episodes = snapshot.episodes
    assert step(rules, snapshot, euler=[2.0, 0.0, 0.0], lost=True) == DoneReason.NONE
    assert episodes.breach.tolist() == [0, DoneReason.TILT, 0]
    assert episodes.no_reward_count.tolist() == [0, 1, 0]
    assert episodes.step_count.tolist() == [0, 99, 0]
    assert step(rules, snapshot, lost=True) == DoneReason.TARGET_LOST


def test_no_reward_ends_after_its_steps_and_starts_anew_with_a_reward(rules):
    snapshot = fresh(reward=0.001)
    reasons = [step(rules, snapshot) for _ in range(101)]
    assert reasons == [DoneReason.NONE] * 100 + [DoneReason.NO_REWARD]
    snapshot.episodes.reward[N] = 0.0011
    assert step(rules, snapshot) == DoneReason.NONE
    assert snapshot.episodes.no_reward_count[N] == 0


def test_no_reward_counts_during_grace(rules):
    snapshot = fresh(step_count=0, reward=0.0)
    reasons = [step(rules, snapshot) for _ in range(101)]
    assert reasons == [DoneReason.NONE] * 100 + [DoneReason.NO_REWARD]


def test_episodes_last_their_number_of_steps(rules):
    snapshot = fresh(step_count=0)
    reasons = [step(rules, snapshot) for _ in range(1001)]
    assert reasons == [DoneReason.NONE] * 999 + [DoneReason.STEP_LIMIT] * 2


@pytest.mark.parametrize("what", sorted(set(CALM) - {"lost", "commanded_position"}))
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_not_a_number_ends_at_once_and_for_good(rules, what, value):
    snapshot = fresh(step_count=3)
    broken = [*CALM[what]]
    broken[2] = value
    assert step(rules, snapshot, **{what: broken}) == DoneReason.NOT_A_NUMBER
    assert step(rules, snapshot) == DoneReason.NOT_A_NUMBER


def test_a_reward_that_is_not_a_number_ends_too(rules):
    assert step(rules, fresh(reward=float("nan"))) == DoneReason.NOT_A_NUMBER


def test_crashes_are_what_the_original_calls_so():
    crashes = [reason for reason in DoneReason if is_crash(int(reason))]
    assert crashes == [DoneReason.DISTANCE, DoneReason.YAW_RATE]


def test_every_reason_has_a_sentence_and_the_original_s_word():
    sentences = {reason.sentence for reason in DoneReason}
    assert len(sentences) == len(DoneReason)
    assert all(sentence.endswith(".") for sentence in sentences)
    words = [reason.original for reason in DoneReason]
    assert words[:6] == [
        "none", "height", "distance", "velocity", "yaw velocity", "pitch or yaw angle"
    ]  # fmt: skip
    assert set(words[6:]) == {"none"}
