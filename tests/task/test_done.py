import numpy as np
import pytest

from eyas.task.columns import BREACH, MEMORY_COLUMNS, NO_REWARD_COUNT, REWARD, STEP_COUNT
from eyas.task.done import DoneReason, is_crash, judge

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


def fresh(step_count=500, reward=1.0):
    memory = np.zeros(MEMORY_COLUMNS)
    memory[STEP_COUNT], memory[REWARD] = step_count, reward
    return memory


def step(rules, memory, **changes):
    values = {**CALM, **changes}
    arrays = [np.array(values[name], np.float64) for name in CALM if name != "lost"]
    return judge(rules, values["lost"], *arrays, memory)


def test_a_calm_tracker_goes_on(rules):
    assert step(rules, fresh()) == DoneReason.NONE


@pytest.mark.parametrize(("what", "value", "reason"), BREACHES)
def test_each_limit_has_its_reason(rules, what, value, reason):
    assert step(rules, fresh(), **{what: value}) == reason


@pytest.mark.parametrize(("what", "value"), KEPT)
def test_what_no_limit_is_about_ends_nothing(rules, what, value):
    assert step(rules, fresh(), **{what: value}) == DoneReason.NONE


def test_reasons_come_in_the_original_s_order(rules):
    memory = fresh(step_count=5000, reward=0.0)
    memory[NO_REWARD_COUNT] = 500
    wrong = {
        "position": [0.0, 0.0, 0.0], "commanded_position": [99.0, 0.0, 0.0],
        "velocity": [99.0, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 9.0],
        "euler": [2.0, 0.0, 0.0], "lost": True,
    }  # fmt: skip
    seen = [step(rules, memory, **wrong)]
    for what in list(wrong)[:-1]:
        wrong[what] = CALM[what]
        seen.append(step(rules, memory, **wrong))
    assert seen == list(range(DoneReason.HEIGHT, DoneReason.TARGET_LOST + 1))
    memory = fresh(step_count=5000, reward=0.0)
    memory[NO_REWARD_COUNT] = 500
    assert step(rules, memory) == DoneReason.NO_REWARD
    memory[REWARD] = 1.0
    assert step(rules, memory) == DoneReason.STEP_LIMIT


def test_a_limit_that_is_kept_again_is_forgotten(rules):
    memory = fresh()
    assert step(rules, memory, euler=[2.0, 0.0, 0.0]) == DoneReason.TILT
    assert step(rules, memory) == DoneReason.NONE
    assert memory[BREACH] == DoneReason.NONE


def test_a_lost_target_stays_lost(rules):
    memory = fresh()
    assert step(rules, memory, lost=True) == DoneReason.TARGET_LOST
    assert step(rules, memory, lost=False) == DoneReason.TARGET_LOST


def test_young_episodes_do_not_end_but_count_and_remember(rules):
    memory = fresh(step_count=98, reward=0.0)
    assert step(rules, memory, euler=[2.0, 0.0, 0.0], lost=True) == DoneReason.NONE
    assert memory[BREACH] == DoneReason.TILT
    assert memory[NO_REWARD_COUNT] == 1
    assert memory[STEP_COUNT] == 99
    assert step(rules, memory) == DoneReason.TARGET_LOST


def test_no_reward_ends_after_its_steps_and_starts_anew_with_a_reward(rules):
    memory = fresh(reward=0.001)
    reasons = [step(rules, memory) for _ in range(101)]
    assert reasons == [DoneReason.NONE] * 100 + [DoneReason.NO_REWARD]
    memory[REWARD] = 0.0011
    assert step(rules, memory) == DoneReason.NONE
    assert memory[NO_REWARD_COUNT] == 0


def test_no_reward_counts_during_grace(rules):
    memory = fresh(step_count=0, reward=0.0)
    reasons = [step(rules, memory) for _ in range(101)]
    assert reasons == [DoneReason.NONE] * 100 + [DoneReason.NO_REWARD]


def test_episodes_last_their_number_of_steps(rules):
    memory = fresh(step_count=0)
    reasons = [step(rules, memory) for _ in range(1001)]
    assert reasons == [DoneReason.NONE] * 999 + [DoneReason.STEP_LIMIT] * 2


@pytest.mark.parametrize("what", sorted(set(CALM) - {"lost", "commanded_position"}))
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_not_a_number_ends_at_once_and_for_good(rules, what, value):
    memory = fresh(step_count=3)
    broken = [*CALM[what]]
    broken[2] = value
    assert step(rules, memory, **{what: broken}) == DoneReason.NOT_A_NUMBER
    assert step(rules, memory) == DoneReason.NOT_A_NUMBER


def test_a_reward_that_is_not_a_number_ends_too(rules):
    assert step(rules, fresh(reward=float("nan"))) == DoneReason.NOT_A_NUMBER


def test_crashes_are_what_the_original_calls_so():
    crashes = [reason for reason in DoneReason if is_crash(float(reason))]
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
