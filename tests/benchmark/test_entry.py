"""Classes of entry, the envelope, and policies in a process of their own."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from eyas.benchmark.evaluation import run
from eyas.benchmark.plan.entry import EntryClass, entry_class
from eyas.benchmark.plan.plan import EvaluationPlan, batches, check
from eyas.benchmark.policies.sandbox import receive, send
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.envelope import ENVELOPE
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.core.errors import ConfigError

HERE = Path(__file__).parent


def mean(records, name):
    return float(np.mean([getattr(record, name) for record in records]))


def class_of(policy, **changes):
    return check(EvaluationPlan(policy=policy, **changes)).entry_class


@pytest.mark.slow
@pytest.mark.parametrize(
    ("policy", "expected"),
    [
        ("hover", "pixels"),
        ("random", "pixels"),
        ("servo", "pixels"),
        ("follow", "privileged"),
        ("sighted", "privileged"),
        ("constant-velocity", "privileged"),
        ("road-graph", "privileged"),
        ("own_policies:forward", "pixels"),
        ("own_policies:together", "pixels"),
        ("own_policies:BoxTracker", "box"),
        ("own_policies:Fails", "privileged"),
        ("own_box_trackers:Drifting", "box"),
        ("cheats:TrueState", "privileged"),
    ],
)
def test_every_policy_has_the_class_of_what_it_knows(policy, expected):
    assert class_of(policy) == expected


def test_shipped_networks_see_pixels_only():
    pytest.importorskip("onnxruntime")
    assert class_of("fast") == EntryClass.PIXELS


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        (["image", "depth"], "depth"),
        (["image", "lidar"], "lidar"),
        (["image", "sensors"], "pixels"),
        (["image", "classes"], "privileged"),
        (["image", "privileged"], "privileged"),
    ],
)
def test_what_an_observation_holds_decides_the_class(parts, expected):
    policy = open_policy("own_policies:forward", {"observation": {"parts": parts}})
    assert entry_class(policy) == expected


def test_own_code_beside_the_simulator_is_privileged():
    assert class_of("own_policies:forward", in_process=True) == EntryClass.PRIVILEGED
    # Ours may.
    assert class_of("servo", in_process=True) == EntryClass.PIXELS


def test_a_result_tells_class_and_all_that_the_policy_sees_and_does(tmp_path):
    plan = EvaluationPlan(policy="cheats:TrueState", episodes=1)
    run(plan, tmp_path, quiet=True)
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["class"] == "privileged"
    stamp = json.loads((tmp_path / "run.json").read_text())
    for told in (result["entry"], stamp["entry"]):
        assert told["entry_class"] == "privileged"
        assert told["apart"] is True
        assert told["observation"]["parts"] == ["privileged"]
        assert (told["actions"], told["action_repeat"], told["latency"]) == ("velocity", 1, "0")
        assert told["speeds"]["forward_speed"] == 40.0


# Attempts that must not look good.


def test_a_blind_climber_sees_no_more_than_one_that_hovers(fly):
    """Without the envelope it reached 49.5 m and a TSR of .51."""
    hover, climber = fly("hover"), fly("cheats:Climber")
    assert all(record.error is None for record in climber)
    assert mean(climber, "height") < mean(hover, "height") + 3.0
    assert mean(climber, "tsr") < mean(hover, "tsr") + 0.05


def test_a_flown_climber_stays_inside_too(fly):
    climber = fly("cheats:Climber", settings={"tracker": {"supervised": False}})
    assert mean(climber, "height") < ENVELOPE.highest


def test_a_spinner_sees_no_more_than_one_that_hovers(fly):
    assert mean(fly("cheats:Spinner"), "tsr") < mean(fly("hover"), "tsr") + 0.05


def test_the_true_state_is_good_but_told(fly):
    assert mean(fly("cheats:TrueState"), "tsr") > 0.95
    assert class_of("cheats:TrueState") == EntryClass.PRIVILEGED


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"forward_speed": 400.0}, r"env\.speeds\.forward_speed: 400 is not allowed .*-40 to 40"),
        ({"right_speed": -40.5}, r"env\.speeds\.right_speed: -40\.5 is not allowed"),
        ({"vertical_speed": 0.1}, r"env\.speeds\.vertical_speed: 0\.1 .*-0\.01 to 0\.01"),
        ({"clockwise_rate": -3.0}, r"env\.speeds\.clockwise_rate: -3 .*-2 to 2"),
    ],
)
def test_speeds_beyond_the_envelope_are_one_line(change, line):
    with pytest.raises(ConfigError, match=line):
        check(EvaluationPlan(policy="follow", env={"speeds": change}))


def test_the_camera_turns_in_a_protocol_of_its_own_only():
    turning = {"actions": "velocity+gimbal"}
    for name in set(PROTOCOLS.names()) - {"gimbal"}:
        with pytest.raises(ConfigError, match="protocol of its own, 'gimbal'"):
            check(EvaluationPlan(policy="own_policies:forward", protocol=name, env=turning))
    with pytest.raises(ConfigError, match="protocol of its own"):
        check(EvaluationPlan(policy="gimbal-servo"))
    check(EvaluationPlan(policy="gimbal-servo", protocol="gimbal"))
    for name, value in (("pitch_rate", 20.0), ("yaw_rate", 20.0), ("least_pitch", -1.6)):
        env = {"gimbal": {name: value}}
        plan = EvaluationPlan(policy="gimbal-servo", protocol="gimbal", env=env)
        with pytest.raises(ConfigError, match=f"env.gimbal.{name}"):
            check(plan)


def test_speeds_inside_the_envelope_are_a_choice():
    check(EvaluationPlan(policy="follow", env={"speeds": {"forward_speed": 12.0}}))


def test_a_policy_that_asks_for_more_is_refused():
    with pytest.raises(ConfigError, match=r"forward_speed: 400 is not allowed in protocol 'paper'"):
        check(EvaluationPlan(policy="cheats:Fast"))


@pytest.mark.slow
def test_one_that_looks_into_the_simulator_finds_it_only_beside_it(fly):
    hover = mean(fly("hover", batch=1), "tsr")
    apart = fly("cheats:Peeper", batch=1)
    assert all(record.error is None for record in apart)
    assert mean(apart, "tsr") == pytest.approx(hover, abs=0.01)
    beside = EvaluationPlan(policy="cheats:Peeper", in_process=True)
    assert check(beside).entry_class == EntryClass.PRIVILEGED


def test_commands_end_at_the_limits_of_height_and_are_else_untouched():
    commands = np.array([[40.0, -40.0, up, 2.0] for up in (0.01, 0.01, 0.01, -0.01, -0.01, 0.0)])
    heights = np.array([22.0, 24.9, 30.0, 12.0, 5.0, 30.0])
    held = ENVELOPE.held(commands, heights)
    assert (held[:, [0, 1, 3]] == commands[:, [0, 1, 3]]).all()
    assert held[:, 2] == pytest.approx([0.01, 0.0004, 0.0, 0.0, 0.0, 0.0])


# A process of its own.


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["own_policies:forward", "own_policies:together"])
def test_apart_and_beside_give_the_same_records(fly, policy):
    assert fly(policy) == fly(policy, in_process=True)


def test_a_process_knows_no_seeds(fly):
    assert [record.error for record in fly("cheats:Seeds")] == [None] * 4
    beside = fly("cheats:Seeds", in_process=True)
    assert all("knows a seed" in record.error for record in beside)


@pytest.mark.slow
def test_each_batch_has_a_process_of_its_own(fly):
    lines = {record.error for record in fly("cheats:Counts", batch=1)}
    assert len(lines) == 4


@pytest.mark.slow
def test_one_that_remembers_a_start_does_no_better_in_another_weather(fly):
    """It flies by night what it flew by day from the same start, which it knows by its GPS."""
    first = fly("cheats:Remembers", weathers=("day",))
    both = fly("cheats:Remembers", weathers=("day", "night"))
    assert [one.path for one in both] == [one.path for one in first] * 2


def test_starts_that_weathers_or_variants_share_are_in_batches_of_their_own():
    for name, weathers in (("paper", ("day", "night")), ("recover-camera", ("day",))):
        plan = EvaluationPlan(policy="hover", protocol=name, weathers=weathers, episodes=1)
        parts = batches(plan)
        assert sum(map(len, parts)) == plan.count
        for part in parts:
            starts = {(each.place.map, each.direction, each.seed) for each in part}
            assert len(starts) == len(part)


@pytest.mark.skipif(sys.platform != "linux", reason="Linux")
def test_the_evaluators_memory_and_command_line_are_closed(fly, monkeypatch):
    monkeypatch.setattr("eyas.benchmark.policies.sandbox.wrapped", lambda: ())  # as without bwrap
    for record in fly("cheats:Reader"):
        assert (
            record.error == "RuntimeError: {'mem': 'closed', 'environ': 'closed', 'maps': 'closed'}"
        )
    words = Path("/proc/self/cmdline").read_bytes().rstrip(b"\0").split(b"\0")
    assert len(words) <= 2


@pytest.mark.slow
def test_a_process_that_ends_is_one_line_and_the_next_batch_has_another(fly):
    records = fly("cheats:Dies", batch=2)
    assert {record.error for record in records} == {
        "the policy's process has ended with exit code 7"
    }


def test_what_a_policy_prints_does_not_disturb_it(fly):
    assert fly("cheats:Talks") == fly("cheats:Spinner")


@pytest.mark.slow
def test_what_cannot_be_imported_is_one_line():
    for policy, line in (
        ("no_such_module:Policy", "there is no module 'no_such_module'"),
        ("cheats:Nothing", "has no 'Nothing'"),
        ("cheats:np", "is not allowed: a function"),
    ):
        with pytest.raises(ConfigError, match=line):
            check(EvaluationPlan(policy=policy))


def test_messages_are_numbers_and_texts_only(tmp_path):
    path = tmp_path / "message"
    arrays = [np.arange(6, dtype=np.float32).reshape(2, 3), np.zeros(0, np.uint8)]
    with path.open("wb") as stream:
        send(stream, {"act": ["image"]}, arrays)
    with path.open("rb") as stream:
        head, found = receive(stream)
    assert head == {"act": ["image"]}
    assert all((a == b).all() and a.dtype == b.dtype for a, b in zip(arrays, found, strict=True))
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    with path.open("rb") as stream, pytest.raises(EOFError):
        receive(stream)
    path.write_bytes(whole.replace(b"<f4", b"|O8"))
    with path.open("rb") as stream, pytest.raises(ValueError, match="an array of"):
        receive(stream)


def test_an_evaluation_that_is_killed_leaves_no_process(tmp_path):
    """The policy's process ends when its pipe is closed, even by SIGKILL."""
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from eyas.benchmark.policies.sandbox import open_sandboxed\n"
        "policy = open_sandboxed('cheats:Spinner', {}, sampled=False)\n"
        "print(policy._take()._process.pid, flush=True)\n"
        "sys.stdin.read()"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", code, str(HERE)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    child = int(parent.stdout.readline())
    os.kill(child, 0)
    parent.kill()
    parent.communicate()
    for _ in range(100):
        status = Path(f"/proc/{child}/stat")
        if not status.exists() or status.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.1)
    raise AssertionError("the policy's process runs on")
