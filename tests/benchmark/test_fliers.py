"""Batches that others fly: in any order, and again if they were lost."""

import pickle

import pytest

from eyas.benchmark.evaluation import run
from eyas.benchmark.flight.policy_runner import flown
from eyas.benchmark.plan.plan import EvaluationPlan, batches, stamp
from eyas.benchmark.records.record import read_records
from eyas.engine.core.errors import ConfigError

PLAN = EvaluationPlan(policy="random", episodes=2, batch=3)
FILES = ("episodes.jsonl", "result.json", "result.csv", "run.json")


def sent(thing):
    """Return what another process would get."""
    return pickle.loads(pickle.dumps(thing))


def last_first(plan, parts, answers):
    """Fly as a cluster does whose last worker is the first to finish."""
    for part in reversed(parts):
        yield sent(flown(*sent((stamp(plan), part))))


class LostError(Exception): ...


def dying_after(count):
    """Return a cluster from which only so many batches come back."""

    def runner(plan, parts, answers):
        for number, records in enumerate(last_first(plan, parts, answers)):
            if number == count:
                raise LostError
            yield records

    return runner


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole")
    run(PLAN, out, quiet=True)
    return out


def same(one, other):
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


def test_batches_that_come_in_another_order_make_the_same_files(whole, tmp_path):
    run(PLAN, tmp_path, quiet=True, runner=last_first)
    same(tmp_path, whole)
    assert not (tmp_path / "timing.json").exists()


@pytest.mark.parametrize("then", [last_first, None])
def test_what_came_back_before_the_end_is_kept_and_the_rest_is_flown(whole, tmp_path, then):
    with pytest.raises(LostError):
        run(PLAN, tmp_path, quiet=True, runner=dying_after(1))
    kept = read_records(tmp_path / "episodes.jsonl")
    assert {record.name for record in kept} == {episode.name for episode in batches(PLAN)[-1]}
    run(PLAN, tmp_path, quiet=True, resume=True, **({"runner": then} if then else {}))
    same(tmp_path, whole)


def test_a_worker_with_another_build_or_another_policy_is_refused(tmp_path):
    made = stamp(PLAN)
    build = made.build.model_copy(update={"rooms": made.build.rooms | {"task": "0"}})
    with pytest.raises(ConfigError, match=r"another build of Eyas, which differs in task$"):
        flown(made.model_copy(update={"build": build}), batches(PLAN)[0])
    (tmp_path / "a.onnx").write_bytes(b"1")
    made = stamp(PLAN.model_copy(update={"policy": str(tmp_path / "a.onnx")}))
    (tmp_path / "a.onnx").write_bytes(b"2")
    with pytest.raises(ConfigError, match="another policy"):
        flown(made, batches(PLAN)[0])
    (tmp_path / "a.onnx").unlink()
    with pytest.raises(ConfigError, match=r"a\.onnx: cannot read"):
        flown(made, batches(PLAN)[0])
