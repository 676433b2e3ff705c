"""What machines are told of evaluated episodes, read by the library of the format's owners."""

import json
import warnings
from hashlib import sha256

import pytest

from eyas.benchmark.evaluation import run
from eyas.benchmark.plan.plan import EvaluationPlan


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("flown") / "hover"
    run(EvaluationPlan(policy="hover", episodes=1, weathers=("day", "snow")), out, quiet=True)
    return out


def test_the_metadata_are_valid_and_the_records_are_read(folder):
    mlcroissant = pytest.importorskip("mlcroissant")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of mlcroissant's own
        data = mlcroissant.Dataset(folder / "croissant.json")
        records = list(data.records("episodes"))
    assert not data.metadata.ctx.issues.errors
    flown = [json.loads(line) for line in (folder / "episodes.jsonl").read_text().splitlines()]
    assert [each["episodes/name"].decode() for each in records] == [each["name"] for each in flown]
    shares = [each["episodes/tsr"] for each in records]
    assert shares == pytest.approx([each["tsr"] for each in flown], abs=1e-12)
    assert {each["episodes/weather"] for each in records} == {b"day", b"snow"}


def test_the_part_for_responsible_ai_is_there_and_the_file_is_known_by_its_hash(folder):
    said = json.loads((folder / "croissant.json").read_text())
    for name in ("dataLimitations", "dataBiases", "dataUseCases", "dataCollection"):
        assert said[f"rai:{name}"]
    assert said["rai:dataSocialImpact"]
    (file,) = said["distribution"]
    assert file["sha256"] == sha256((folder / "episodes.jsonl").read_bytes()).hexdigest()
    assert said["conformsTo"][1].endswith("RAI/1.0")
