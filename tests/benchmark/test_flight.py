"""Flights of the built-in policies and of users' own."""

import numpy as np
import pytest

from eyas.benchmark.flight.meter import published
from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.plan import EvaluationPlan, batches, check
from eyas.benchmark.records.record import EpisodeRecord
from eyas.engine.core.errors import EyasError


def figure(records, name):
    return float(np.mean([getattr(record, name) for record in records]))


@pytest.fixture(scope="module")
def follow(fly):
    return fly("follow")


@pytest.fixture(scope="module")
def hover(fly):
    return fly("hover")


def test_exact_following_is_near_the_ceiling(follow):
    assert figure(follow, "cr") > 373.0
    assert figure(follow, "tsr") == 1.0
    assert figure(follow, "losses") == 0.0
    assert figure(follow, "centre_error") < 0.5


@pytest.mark.parametrize("name", ["hover", "random"])
def test_doing_nothing_and_flying_at_random_are_near_the_floor(fly, name):
    records = fly(name)
    assert 20.0 < figure(records, "cr") < 80.0
    assert 0.1 < figure(records, "tsr") < 0.4
    assert all(record.losses == 1 and record.lost_after is not None for record in records)


def test_a_servo_that_sees_only_pictures_is_between(fly, follow, hover):
    servo = figure(fly("servo"), "cr")
    assert figure(hover, "cr") + 50.0 < servo < figure(follow, "cr")


@pytest.mark.slow
def test_a_servo_whose_drone_is_slow_sees_more_if_it_also_turns_its_camera(fly):
    slow = {"forward_speed": 8, "backward_speed": -8, "left_speed": 8, "right_speed": -8}
    fixed, turning = (
        fly(name, protocol="gimbal", env={"speeds": slow}) for name in ("servo", "gimbal-servo")
    )
    assert figure(turning, "cr") > figure(fixed, "cr") + 10.0


@pytest.mark.slow
def test_a_box_tracker_of_opencv_is_between(fly, follow, hover):
    pytest.importorskip("cv2")
    plan = EvaluationPlan(
        policy="csrt", episodes=1, batch=1
    )  # one episode: it takes 60 ms a picture
    (csrt,) = next(fly_batch(plan, batches(plan)[0]))
    assert hover[0].cr + 50.0 < csrt.cr < follow[0].cr


def test_what_is_seen_while_following_is_what_can_be_seen(follow):
    for record in follow:
        assert record.visible == pytest.approx(record.clear, abs=0.06)


def test_the_same_again_whatever_flies_beside_it(fly, hover):
    assert fly("hover", batch=1) == hover
    assert fly("random", episodes=2)[:4] == fly("random", episodes=1)


def test_late_answers_are_worse_and_repeat(fly, follow, hover, tmp_path):
    late = fly("follow", latency="160")
    little = figure(fly("follow", latency="20"), "cr")
    assert figure(follow, "cr") > little > figure(late, "cr") + 5.0
    assert figure(late, "cr") > figure(hover, "cr") + 50.0
    # Answers that are no later than actions last change nothing but when the actions begin.
    assert fly("follow", latency="0.0") == follow
    file = tmp_path / "latencies.txt"
    file.write_text("160\n\n160.0\n")
    assert fly("follow", latency=str(file)) == late
    file.write_text("0\n320\n")
    drawn = fly("follow", latency=str(file))
    assert drawn == fly("follow", latency=str(file), batch=2)
    assert figure(drawn, "cr") < figure(follow, "cr")


def test_measured_latency_flies_one_by_one(fly):
    assert figure(fly("hover", latency="measured"), "tsr") > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["forward", "together", "BoxTracker"])
def test_users_policies_fly(fly, name):
    records = fly(f"own_policies:{name}")
    assert [record.error for record in records] == [None] * 4


def test_a_box_tracker_that_hovers_gets_what_hover_gets(fly, hover):
    assert fly("own_policies:BoxTracker") == hover


@pytest.mark.slow
def test_a_policy_that_fails_is_a_record_with_its_error(fly, hover):
    records = sorted(fly("own_policies:Fails"), key=lambda record: record.name)
    failed = [record for record in records if record.error]
    assert len(failed) == 2
    for record in failed:
        assert record.error == "RuntimeError: no idea"
        assert record.reason == "policy_failed"
        assert record.duration == pytest.approx(0.4)
        assert record.losses == 1
    others = [record for record in records if not record.error]
    assert all(record in hover for record in others)


def test_a_policy_that_cannot_begin_is_a_record_too(fly):
    records = fly("own_policies:CannotBegin")
    assert [(each.error, each.cr, each.duration) for each in records] == [
        ("OSError: no weights", 0.0, 0.0)
    ] * 4


def test_actions_that_are_not_allowed_are_errors(fly):
    assert all("7 is not allowed" in record.error for record in fly("own_policies:wrong"))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"policy": "hovr"}, "did you mean 'hover'"),
        ({"policy": "own_policies:nothing"}, "has no 'nothing'"),
        ({"policy": "missing.onnx"}, "no such file"),
        ({"policy": "hover", "sampled": True}, "--sample"),
        ({"policy": "hover", "protocol": "papr"}, "did you mean 'paper'"),
        ({"policy": "hover", "latency": "-1"}, "0 to 10000 ms"),
        ({"policy": "hover", "latency": "no-file"}, "cannot read"),
        ({"policy": "hover", "maps": ["citystret"]}, "did you mean 'citystreet'"),
        ({"policy": "hover", "weathers": ["hail"]}, "hail"),
        ({"policy": "own_policies:forward", "env": {"action_repeats": 4}}, "action_repeat"),
    ],
)
def test_what_cannot_be_flown_is_one_line(changes, said):
    with pytest.raises(EyasError, match=said):
        check(EvaluationPlan(**changes))


def test_figures_as_published_are_lower():
    """Of 375 equal rewards, the original's code sums 304 to 362, and divides by 375."""
    figures = published(np.full(375, 0.5), 375, seed=1)
    assert 305 <= figures.actions <= 363
    assert figures.cr == 0.5 * (figures.actions - 1)
    assert figures.tsr == pytest.approx((figures.actions - 1) / 375)
    assert published(np.zeros(375), 375, seed=1).cr == 0.0
    half = published(np.full(187, 0.5), 375, seed=1)
    assert half.actions == pytest.approx(figures.actions / 2, abs=2)


def test_records_survive_their_file(follow):
    for record in follow:
        assert EpisodeRecord.model_validate_json(record.model_dump_json()) == record
