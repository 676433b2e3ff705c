"""The tracker that is shown its target once: its geometry, its filter, and what it knows."""

from types import SimpleNamespace

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.entry import EntryClass, entry_class
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker.course import HORIZONS, LAGS, PAST, Course
from eyas.benchmark.policies.tracker.detector import Detector, TargetPrior
from eyas.benchmark.policies.tracker.ground import Ground
from eyas.benchmark.policies.tracker.motion import MotionFilter
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.benchmark.policies.tracker.steering import Steering
from eyas.benchmark.protocols.table import protocol_named
from eyas.engine.core.errors import ConfigError
from eyas.engine.policies.policy import PolicyInput, Start, env_config

ROWS = np.arange(2)
STEP = np.full(2, 0.032)


def test_pixels_and_offsets_are_inverse():
    ground = Ground(TrackerSettings(), (60, 80))
    pixels = np.array([[1.0, 2.0], [40.0, 30.0], [79.0, 59.0]])
    offsets = ground.offsets(pixels)
    np.testing.assert_allclose(ground.pixels(offsets), pixels, atol=1e-9)
    np.testing.assert_allclose(offsets[1], ground.middle, atol=1e-9)
    assert offsets[0, 0] > ground.middle[0]  # the upper rows are ahead
    assert offsets[0, 1] > 0.0 > offsets[2, 1]  # and the first columns to the left
    further = ground.pixels(offsets[1:2] + np.array([[0.0, 1.0]]))
    assert pixels[1, 0] - further[0, 0] == pytest.approx(ground.pixels_per_metre, rel=1e-9)


@pytest.mark.parametrize(("lag", "last"), [(0.0, 7.81), (2.0, 2.34)])
def test_a_drone_that_follows_late_is_not_asked_twice_for_the_same_way(lag, last):
    """It stands yet, 5 m from its target; its commands of a second lead it most of the way."""
    env = env_config({"actions": "velocity", "action_repeat": 4})
    ground = Ground(TrackerSettings(), (60, 80))
    steering = Steering(1, env, ground, 0.05, lag)
    row, place = np.zeros(1, np.int64), np.zeros((1, 2))
    target = ground.middle[None] + [5.0, 0.0], np.zeros((1, 2))
    told = []
    for _ in range(40):
        since = steering.time_since(row, None)
        told.append(steering.steer(row, (place, np.zeros(1)), since, target)[0, 0])
    assert told[0] == pytest.approx(5.0 * 0.05 / 0.032)
    assert told[-1] == pytest.approx(last, abs=0.01)


class Answers:
    """Stands in for a network that believes in two cells of a picture of 8x4 cells."""

    def __init__(self, first, second, unseen):
        self.scores = np.full((1, 33), -50.0, np.float32)
        self.scores[0, [10, 12, 32]] = np.log([first, second, unseen])
        self.places = np.zeros((1, 32, 3), np.float32)
        self.places[0, 10], self.places[0, 12] = (10.0, 6.0, np.log(0.5)), (18.0, 6.0, np.log(0.5))

    def get_inputs(self):
        return [SimpleNamespace(name="key", shape=["n", 2])]

    def run(self, _names, _feed):
        return self.scores, self.places, np.zeros((1, 32, 2), np.float32), AHEAD


AHEAD = np.zeros((1, len(HORIZONS), 3), np.float32)


def told():
    past = np.zeros((1, PAST), np.float32)
    key, known = np.zeros((1, 2), np.float32), np.ones(1, np.bool_)
    return TargetPrior(np.zeros((1, 2)), np.ones(1), key, known, past)


def found(*shares):
    clue = told()
    detector = Detector(Answers(*shares), (16, 32))
    return detector.find(np.zeros((1, 3, 16, 32), np.uint8), clue)


def test_a_place_is_the_less_sure_the_more_cells_disagree():
    sure, torn = found(0.7, 1e-9, 0.3), found(0.4, 0.3, 0.3)
    np.testing.assert_allclose(sure.place, [[10.0, 6.0]], atol=1e-5)
    np.testing.assert_allclose(sure.spread, 0.5, rtol=1e-4)
    np.testing.assert_allclose(torn.belief, 0.7, rtol=1e-5)
    np.testing.assert_allclose(torn.place, [[10.0 + 8.0 * 3.0 / 7.0, 6.0]], atol=1e-5)
    apart = 0.5 * 8.0**2 * (4.0 / 7.0) * (3.0 / 7.0)  # variance of column and row, their mean
    np.testing.assert_allclose(torn.spread, np.sqrt(0.25 + apart), rtol=1e-5)


def test_what_is_surely_not_seen_has_a_place_all_the_same():
    detector = Detector(answers := Answers(0.5, 0.3, 0.2), (16, 32))
    answers.scores[0, :32] = -3000.0
    clue = told()
    with np.errstate(divide="raise", invalid="raise"):
        nothing = detector.find(np.zeros((1, 3, 16, 32), np.uint8), clue)
    assert nothing.belief == 0.0
    assert np.isfinite(nothing.place).all()


def started():
    motion = MotionFilter(2, widest=8.0)
    motion.acceleration[:] = 12.0, 2.0
    still = np.zeros((2, 2))
    motion.begin(ROWS, still, still, 0.5, np.array([8.0, 1.5]))
    return motion


def test_the_filter_finds_a_velocity_and_goes_on_with_it():
    motion, velocity = started(), np.array([[10.0, -4.0], [1.0, 0.5]])
    for look in range(1, 101):
        motion.predict(ROWS, STEP)
        motion.update(ROWS, look * 0.032 * velocity, np.full(2, 0.01), np.ones(2))
    np.testing.assert_allclose(motion.velocity, velocity, atol=0.01)
    seen = motion.spread(ROWS)
    motion.predict(ROWS, np.full(2, 1.0))
    np.testing.assert_allclose(motion.place, (3.2 + 1.0) * velocity, atol=0.02)
    hidden = motion.spread(ROWS)
    assert (hidden > seen).all()
    assert hidden[0] > 2.0 * hidden[1]  # what walks is not far
    motion.predict(ROWS, np.full(2, 60.0))
    assert (motion.spread(ROWS) <= 8.0).all()


def test_the_filter_does_not_lag_behind_what_turns():
    motion, speed, rate = started(), 8.0, 0.6
    motion.acceleration[:] = 4.0
    for look in range(1, 101):
        angle = look * 0.032 * rate
        place = speed / rate * np.tile([np.sin(angle), 1.0 - np.cos(angle)], (2, 1))
        motion.predict(ROWS, STEP)
        motion.update(ROWS, place, np.full(2, 0.81), np.ones(2))
    velocity = speed * np.array([np.cos(angle), np.sin(angle)])
    # A filter that knows of no acceleration is wrong by 1.7 m/s.
    assert np.abs(motion.velocity - velocity).max() < 1.0


def test_what_is_seen_counts_by_its_variance_and_is_near_or_far():
    motion = started()
    distance = motion.distance(ROWS, np.array([[3.0, 4.0], [0.0, 0.0]]), np.full(2, 0.75))
    np.testing.assert_allclose(distance, [5.0, 0.0])  # 0.5^2 + 0.75 = 1
    motion.update(ROWS, np.full((2, 2), 1.0), np.array([0.25, 1e6]), np.ones(2))
    np.testing.assert_allclose(motion.place[0], 0.5)
    np.testing.assert_allclose(motion.place[1], 0.0, atol=1e-5)


def test_what_is_half_believed_moves_the_filter_half_as_far_and_leaves_it_unsure():
    sure, unsure = started(), started()
    seen, variance = np.full((2, 2), 1.0), np.full(2, 0.25)
    sure.update(ROWS, seen, variance, np.ones(2))
    unsure.update(ROWS, seen, variance, np.full(2, 0.5))
    np.testing.assert_allclose(unsure.place, 0.5 * sure.place)
    assert (unsure.spread(ROWS) > sure.spread(ROWS)).all()
    # Half of the gain, and the distance of both cases: 0.25 - 0.5 * 0.125 + 0.25 * 0.5^2.
    np.testing.assert_allclose(unsure.spread(ROWS) ** 2, 0.25)


def test_rows_are_independent():
    one, both = started(), started()
    alone = np.array([1])
    one.predict(alone, STEP[:1])
    both.predict(ROWS, STEP)
    assert one.place[0].tolist() == [0.0, 0.0]
    assert one.spread(alone) == both.spread(alone)
    assert one.spread(np.array([0])) == 0.5


def on_course():
    """Two that were followed for three seconds, straight at 8 m/s and to the left at 4 m/s."""
    course, velocity = Course(2), np.array([[8.0, 0.0], [0.0, 4.0]])
    for look in range(95):
        course.pass_time(ROWS, STEP)
        course.note(ROWS, look * 0.032 * velocity, velocity)
    return course, velocity


def test_the_network_is_told_how_a_target_moved():
    course, velocity = on_course()
    course.set_out(ROWS)
    speed = np.array([8.0, 4.0])
    np.testing.assert_allclose(course.past[:, 0], speed)
    lags = course.past[:, 1:].reshape(2, len(LAGS), 4)
    np.testing.assert_allclose(lags[..., 0], np.repeat(speed[:, None], len(LAGS), 1), atol=1e-5)
    np.testing.assert_allclose(lags[..., [1, 3]], 0.0, atol=1e-5)  # in the frame of its velocity
    np.testing.assert_allclose(lags[..., 2], speed[:, None] * LAGS, atol=0.016 * speed.max())
    places = np.array([[94 * 0.032 * v + v * h + (0, 1) for h in HORIZONS] for v in velocity])
    off = course.off(ROWS, places)  # a metre further north: to the left of the first, ahead of the
    np.testing.assert_allclose(off[0], np.tile((0.0, 1.0), (len(HORIZONS), 1)), atol=1e-9)
    np.testing.assert_allclose(off[1], np.tile((1.0, 0.0), (len(HORIZONS), 1)), atol=1e-9)  # second


def test_an_unseen_target_is_where_the_network_says():
    course, velocity = on_course()
    course.set_out(ROWS)
    assert not course.known(ROWS).any()  # the network was not asked yet
    ahead = np.zeros((2, len(HORIZONS), 3), np.float32)
    ahead[:, :, 1] = 2.0 * HORIZONS  # it drifts to the left with 2 m/s
    ahead[:, :, 2] = np.log(HORIZONS)
    course.answer(ROWS, ahead)
    course.answer(ROWS, 9.0 + ahead)  # the first answer counts
    start = 94 * 0.032 * velocity
    left = np.array([[0.0, 2.0], [-2.0, 0.0]])
    for time in (0.128, 1.3, 0.5):
        course.pass_time(ROWS, np.full(2, time))
        assert course.known(ROWS).all()
        place, now, spread, since = course.here(ROWS)
        np.testing.assert_allclose(place, start + since[:, None] * (velocity + left), atol=1e-5)
        np.testing.assert_allclose(now, velocity + left, atol=1e-5)
        np.testing.assert_allclose(spread, since, rtol=1e-5)
    course.leave(ROWS[:1])
    assert course.known(ROWS).tolist() == [False, True]


def test_a_covered_target_is_expected_straight_on_and_early():
    course, velocity = on_course()
    course.set_out(ROWS)
    ahead = np.zeros((2, len(HORIZONS), 3), np.float32)
    ahead[:, :, 1] = 6.0 * HORIZONS  # it would turn to the left
    course.answer(ROWS, ahead)
    start = 94 * 0.032 * velocity
    course.pass_time(ROWS, np.full(2, 2.0))
    turned = course.here(ROWS)[0] - start
    np.testing.assert_allclose(turned[0], (16.0, 12.0), atol=1e-5)
    course.pass_time(ROWS, np.full(2, 1.0))
    place, now, _, since = course.here(ROWS)
    speed = np.hypot(velocity.sum(axis=1), 6.0)
    heading = velocity / velocity.sum(axis=1, keepdims=True)
    way = speed * 4.0  # of two seconds, then of twice the last one
    np.testing.assert_allclose(place, start + way[:, None] * heading, atol=1e-4)
    np.testing.assert_allclose(now, 2.0 * speed[:, None] * heading, atol=1e-4)
    np.testing.assert_allclose(since, 3.0)


def test_what_stands_or_was_just_seen_first_has_no_course_or_a_short_past():
    course, velocity = on_course()
    course.note(ROWS, np.zeros((2, 2)), np.array([[0.3, 0.3], [0.0, 4.0]]))
    course.set_out(ROWS)
    assert np.isnan(course.seen).tolist() == [True, False]
    course.forget(ROWS)
    course.note(ROWS, np.zeros((2, 2)), velocity)
    course.set_out(ROWS)
    assert np.isfinite(course.past).all()
    np.testing.assert_allclose(course.past[:, 3::4], 0.0)  # no way behind them


class Recorder:
    """Flies a policy, and keeps what it sees and answers."""

    def __init__(self, policy):
        self.policy, self.env, self.told, self.sampled = policy, policy.env, policy.told, False
        self.seen, self.answers = [], []

    def begin(self, start):
        self.boxes = start.boxes()
        self.policy.begin(start)

    def act(self, sight):
        decision = self.policy.act(sight)
        kept = {name: part.copy() for name, part in sight.observation.items()}
        self.seen.append((kept, sight.deciding.copy(), sight.clock))
        self.answers.append(decision.actions.copy())
        return decision


@pytest.fixture(scope="module")
def flown():
    recorder = Recorder(open_policy("eyas", {}))
    protocol = protocol_named("paper").changed({"done": {"total_steps": 400}})
    episodes = protocol.choose(
        [Place("citystreet", "day", "SUMO_VEHICLE")], protocol, 1, 60_000_000
    )
    for _ in BatchFlight(episodes, protocol, recorder, delay_from("40")).fly():
        pass
    return recorder


def unknown():
    raise AssertionError("it looks at the truth")


def replayed(recorder, row=None):
    """Show what was recorded again, without any truth; one drone alone, or all."""
    rows = slice(None) if row is None else slice(row, row + 1)
    policy = open_policy("eyas", {})
    count = len(recorder.boxes[rows])
    policy.begin(Start(np.zeros(count, np.int64), lambda: recorder.boxes[rows]))
    answers = []
    for seen, deciding, clock in recorder.seen:
        own = {name: part[rows] for name, part in seen.items()}
        covered = np.zeros(count, np.bool_)
        sight = PolicyInput(own, deciding[rows], unknown, unknown, covered, clock=clock)
        answers.append(policy.act(sight).actions)
    return np.array(answers)


def test_it_answers_the_same_without_the_truth(flown):
    assert entry_class(flown.policy) is EntryClass.BOX
    assert (replayed(flown) == np.array(flown.answers)).all()
    assert np.abs(flown.answers).max() > 1.0


@pytest.mark.parametrize("row", range(4))
def test_one_drone_alone_flies_as_in_a_batch(flown, row):
    """To the last bits of the network, whose sums depend on the batch."""
    alone, together = replayed(flown, row), np.array(flown.answers)[:, row : row + 1]
    np.testing.assert_allclose(alone, together, atol=2e-3)


def test_it_flies_on_unseen_for_45_metres_and_waits_there(flown):
    policy = open_policy("eyas", {})
    policy.begin(Start(np.zeros(4, np.int64), lambda: flown.boxes))
    covered = np.zeros(4, np.bool_)
    shown = [seen for seen, _, _ in flown.seen]
    clocks = [clock for _, _, clock in flown.seen]
    dark = {**shown[-1], "image": np.zeros_like(shown[-1]["image"])}
    for seen, clock in zip(shown, clocks, strict=True):
        policy.act(PolicyInput(seen, ~covered, unknown, unknown, covered, clock=clock))
    drove = np.hypot(*policy.motion.velocity.T) > 5.0
    assert drove.any()
    for look in range(1, 401):
        clock = clocks[-1] + 0.032 * look
        policy.act(PolicyInput(dark, ~covered, unknown, unknown, covered, clock=clock))
    away = np.hypot(*(policy.motion.place - policy.left).T)
    assert (away[drove] >= 45.0).all()
    assert (away < 46.0).all()
    assert (policy.motion.velocity[drove] == 0.0).all()


def test_without_a_first_box_it_fails_in_one_line(fly):
    (record,) = {record.error for record in fly("eyas", protocol="search")}
    assert "first box" in record
    assert "\n" not in record


def test_it_follows_a_target_with_a_latency(fly):
    assert np.mean([record.tsr for record in fly("eyas", latency="80", episodes=2)]) > 0.8


def test_it_sees_as_it_was_trained():
    with pytest.raises(ConfigError, match="as it was trained"):
        open_policy("eyas", {"observation": {"width": 48}})
    with pytest.raises(ConfigError, match="--sample"):
        open_policy("eyas", {}, sampled=True)
