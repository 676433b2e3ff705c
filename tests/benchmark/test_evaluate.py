"""The command: folder, table, resuming after a kill."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from itertools import pairwise

import pytest
from typer.testing import CliRunner

from eyas.benchmark.commands import _changes
from eyas.benchmark.episodes.episode import seed_sets
from eyas.benchmark.evaluation import join_shards, one_shard, run
from eyas.benchmark.flight.policy_runner import run_here
from eyas.benchmark.plan.plan import EvaluationPlan, check
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.records.record import RecordFile, read_records
from eyas.cli.app import app
from eyas.engine.core.errors import ConfigError, EyasError, OutputError

PLAN = EvaluationPlan(policy="random", episodes=2, batch=2)
FILES = ("episodes.jsonl", "result.json", "result.csv", "run.json")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole")
    run(PLAN, out, quiet=True)
    return out


def test_the_result_tells_all_that_repeats_it(whole):
    result = json.loads((whole / "result.json").read_text())
    assert result["command"] == "eyas evaluate --policy random --episodes 2 --batch 2"
    assert result["seeds"] == list(range(1_000_000, 1_000_008))
    first = result["rows"][0]
    assert (first["group"], first["n"]) == ("all", 8)
    low, high = first["figures"]["cr"]["interval"]
    assert low < first["figures"]["cr"]["mean"] < high
    assert {row["group"] for row in result["rows"]} == {"all", "visibility"}
    lines = (whole / "result.csv").read_text().splitlines()
    assert len({line.count(",") for line in lines}) == 1


def test_shards_of_several_machines_are_the_whole(whole, tmp_path, capsys):
    folders = [tmp_path / f"shard{number}" for number in (1, 2)]
    for number, folder in enumerate(folders, 1):
        run(PLAN, folder, runner=one_shard(run_here, number, 2))
        assert f"4 of 8 episodes in {folder}" in capsys.readouterr().out
        assert not (folder / "result.json").exists()
    joined, half = tmp_path / "joined", tmp_path / "half"

    def none_left(plan, left, answers):
        assert not left
        return iter(())

    join_shards(PLAN, joined, folders[::-1])
    run(PLAN, joined, resume=True, quiet=True, runner=none_left)
    join_shards(PLAN, half, folders[:1])
    run(PLAN, half, resume=True, quiet=True)  # flies the rest
    for name in FILES:
        assert (joined / name).read_bytes() == (whole / name).read_bytes()
        assert (half / name).read_bytes() == (whole / name).read_bytes()
    other = PLAN.model_copy(update={"episodes": 3})
    with pytest.raises(OutputError, match=r"shard1: cannot be continued: 'episodes' was 2"):
        join_shards(other, tmp_path / "other", folders)
    assert not (tmp_path / "other").exists()
    with pytest.raises(ConfigError, match=r"'1/9' is not allowed: at most 4 shards.*--batch"):
        run(PLAN, tmp_path / "many", runner=one_shard(run_here, 1, 9), quiet=True)


def test_the_command_that_repeats_it_survives_a_shell():
    crowd = {"extras": [{"kind": "Pedestrian", "count": 9}], "start": {"velocity": "target"}}
    plan = EvaluationPlan(policy="my runs/x.onnx", env={"action_repeat": 4}, settings=crowd)
    words = shlex.split(plan.command)
    assert words[:4] == ["eyas", "evaluate", "--policy", plan.policy]
    said = [text for option, text in pairwise(words) if option == "--set"]
    assert _changes(said) == {"env": plan.env, **plan.settings}


@pytest.mark.parametrize("maps", [("citystreet",), ("village",), ("village", "citystreet")])
@pytest.mark.parametrize("protocol", ["paper", "recover"])
def test_that_command_names_the_maps_that_are_not_the_protocol_s_own(protocol, maps):
    words = shlex.split(EvaluationPlan(policy="hover", protocol=protocol, maps=maps).command)
    named = tuple(text for option, text in pairwise(words) if option == "--map")
    assert (named or EvaluationPlan(policy="hover", protocol=protocol).maps) == maps


@pytest.mark.slow
def test_several_sets_of_seeds_are_flown_as_if_each_were_alone(tmp_path):
    sets = EvaluationPlan(policy="random", episodes=1, seeds=seed_sets("2"), batch=3)
    assert shlex.split(sets.command)[4:6] == ["--seeds", "1000000,11000000"]
    assert sets.count == 8
    flown = run(sets, tmp_path / "both", quiet=True)
    alone = [
        record
        for number, seed in enumerate(sets.seeds)
        for record in run(
            sets.model_copy(update={"seeds": (seed,)}), tmp_path / str(number), quiet=True
        )
    ]
    assert flown == alone
    result = json.loads((tmp_path / "both" / "result.json").read_text())
    assert [row["name"] for row in result["rows"]][:3] == ["all", "from 1000000", "from 11000000"]
    assert EvaluationPlan(policy="random", seeds=(77,)).command.endswith("--seed 77")


def test_sets_of_seeds_are_a_number_or_a_list_that_does_not_overlap():
    assert seed_sets("3") == (1_000_000, 11_000_000, 21_000_000)
    assert seed_sets("5000000,77000000") == (5_000_000, 77_000_000)
    for text in ("0", "-1", "a", "1,", "1000000,-2"):
        with pytest.raises(ConfigError, match=r"--seeds: .* is not allowed: the first seeds"):
            seed_sets(text)
    with pytest.raises(ConfigError, match="sets could share episodes"):
        check(EvaluationPlan(policy="hover", seeds=(1_000_000, 1_000_100)))


def test_one_seed_and_several_are_not_said_together():
    words = ["evaluate", "--policy", "hover", "--seed", "5", "--seeds", "3"]
    with pytest.raises(ConfigError, match="--seed and --seeds cannot be used together"):
        raise CliRunner().invoke(app, words).exception


def test_a_run_has_a_hundred_episodes():
    """`unseen` has them in its own six places together; `recover-camera` has two losses in each;
    `flown` has a hundred of each kind of start."""
    for protocol in map(PROTOCOLS.get, PROTOCOLS.built_in):
        # Of these, the versions of an episode are one observation.
        told = protocol.name in ("referring", "flown") or protocol.team or protocol.reference
        versions = max(len(protocol.variants), 1) if told else 1
        episodes = EvaluationPlan(policy="hover", protocol=protocol.name).count / versions
        least = 48 if protocol.name in ("recover-camera", "corrupted") else 96
        assert least <= episodes <= 144, protocol.name


def test_what_the_protocol_fixes_is_refused():
    fixed, formless = ("world.map=lake", "extras.0.count=3", "start.height=3"), ("extras", "env.=1")
    for text in (*fixed, *formless):
        said = "not allowed: env\\.KEY=VALUE" if text in fixed else "not of the form key=value"
        with pytest.raises(ConfigError, match=f"^--set .*{said}"):
            _changes([text])


SLOW = """
import os, time

def act(picture):
    time.sleep(float(os.environ.get("EYAS_TEST_SLEEP", 0)))
    return 6

act.env_settings = {"action_repeat": 20, "observation": {"width": 16, "height": 12}}
"""


@pytest.mark.slow
def test_a_killed_evaluation_continues_to_the_same_bytes(tmp_path, monkeypatch):
    """Its policy takes its time, so that no machine is fast enough to end before the kill."""
    (tmp_path / "slow_hover.py").write_text(SLOW)
    monkeypatch.syspath_prepend(tmp_path)
    plan = PLAN.model_copy(update={"policy": "slow_hover:act"})
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    run(plan, whole, quiet=True)
    command = [sys.executable, "-m", "eyas.cli.main", "evaluate", "--policy", plan.policy]
    command += ["--episodes", "2", "--batch", "2", "--out", str(killed)]
    own = {"EYAS_TEST_SLEEP": "0.015", "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, env={**os.environ, **own})
    records = killed / "episodes.jsonl"
    while not (records.exists() and records.read_bytes().count(b"\n") >= 2):
        assert process.poll() is None
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    flown = records.read_bytes().count(b"\n")
    assert flown < 8, "killed too late to test anything"
    with records.open("ab") as file:
        file.write(b'{"name": "torn')  # as a kill in the middle of a line leaves it
    run(plan, killed, resume=True, quiet=True)
    for name in FILES:
        assert (killed / name).read_bytes() == (whole / name).read_bytes(), name


def test_a_batch_of_which_a_part_is_missing_is_flown_again(whole, tmp_path):
    for name in ("run.json", "episodes.jsonl"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    lines = (whole / "episodes.jsonl").read_bytes().splitlines(keepends=True)
    (tmp_path / "episodes.jsonl").write_bytes(b"".join(lines[:3]))
    run(PLAN, tmp_path, resume=True, quiet=True)
    assert (tmp_path / "episodes.jsonl").read_bytes() == b"".join(lines)


def test_a_folder_that_is_taken_is_not_touched(whole):
    with pytest.raises(EyasError, match="--resume"):
        run(PLAN, whole, quiet=True)
    with pytest.raises(EyasError, match="'episodes' was 2, now it is 3"):
        run(PLAN.model_copy(update={"episodes": 3}), whole, resume=True, quiet=True)


def test_overwriting_deletes_only_what_an_evaluation_writes(whole, tmp_path):
    for name in FILES:
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    (tmp_path / "mine.json").write_text("{}")
    plan = EvaluationPlan(policy="hover", episodes=1)
    run(plan, tmp_path, overwrite=True, quiet=True)
    assert len(read_records(tmp_path / "episodes.jsonl")) == 4
    assert (tmp_path / "mine.json").exists()
    (tmp_path / "run.json").unlink()
    with pytest.raises(EyasError, match="--resume"):
        run(plan, tmp_path, quiet=True)


def test_a_damaged_line_is_told_with_its_number(whole, tmp_path):
    path = tmp_path / "episodes.jsonl"
    line = (whole / "episodes.jsonl").read_bytes().splitlines(keepends=True)[0]
    path.write_bytes(line + b'{"name": 3}\n')
    with pytest.raises(EyasError, match="line 2"):
        read_records(path)


def test_a_torn_last_line_is_cut_off(whole, tmp_path):
    path = tmp_path / "episodes.jsonl"
    record = read_records(whole / "episodes.jsonl")[0]
    path.write_bytes(b"torn")
    with RecordFile(path) as file:
        file.add([record])
    assert read_records(path) == [record]


def test_the_table_is_printed_as_published_too(tmp_path, capsys):
    plan = EvaluationPlan(policy="follow", episodes=1)
    run(plan, tmp_path, as_published=True)
    text = capsys.readouterr().out
    assert "cr" in text
    figures = json.loads((tmp_path / "result.json").read_text())["rows"][0]["figures"]
    assert 303.0 < figures["cr"]["mean"] < 363.0
    assert figures["tsr"]["mean"] < 0.97


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [(), ("--latency-curve",)])
def test_a_policy_that_fails_in_all_episodes_is_an_error(
    tmp_path, arguments, monkeypatch, eyas_command
):
    """Also if nothing else is to be printed: a job on a cluster must not look successful."""
    (tmp_path / "mine.py").write_text("def act(picture):\n    raise RuntimeError('boom')\n")
    monkeypatch.delitem(sys.modules, "mine", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    command = ["evaluate", "--quiet", *arguments, "--policy", "mine:act", "--episodes", "1"]
    done = eyas_command(*command, "--out", tmp_path / "out")
    assert done.returncode == 1
    assert done.stdout == ""
    said = done.stderr.partition("eyas: warning: the policy failed in 4 of 4 episodes, first in ")[
        2
    ]
    assert said.splitlines()[0].endswith(": RuntimeError: boom")
    assert f'{tmp_path / "mine.py"}", line 2, in act' in said
    if not arguments:
        assert said.count("Traceback") == 1
        for record in read_records(tmp_path / "out" / "episodes.jsonl"):
            assert f'{tmp_path / "mine.py"}", line 2, in act' in record.traceback


@contextmanager
def files_of(size):
    """Let no file grow beyond a size [bytes], as if the disk were full."""
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_a_full_disk_is_blamed_on_the_file_of_records(whole, tmp_path):
    (record, *_), path = read_records(whole / "episodes.jsonl"), tmp_path / "episodes.jsonl"
    line = re.escape(f"{path}: cannot write: ")
    with files_of(100), pytest.raises(OutputError, match=line), RecordFile(path) as file:
        file.add([record])
