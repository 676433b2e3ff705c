"""`eyas bench` from end to end: it measures, prints and writes. How fast is not asked here."""

import json
import re
import time
from types import SimpleNamespace

import pytest

from eyas.cli.bench import measurement, pictures

UNITS = {"s", "/s", "steps/s", "ms", "MiB", "decisions/s"}


@pytest.mark.slow
def test_bench_prints_and_writes_what_it_has_measured(tmp_path, monkeypatch, eyas_command):
    hurry = SimpleNamespace(
        perf_counter=lambda: 10.0 * time.perf_counter(), process_time=time.process_time
    )
    for module in (measurement, pictures):
        monkeypatch.setattr(module, "time", hurry)
    path = tmp_path / "bench.json"
    done = eyas_command("bench", "--quick", "--stages", "--out", path)
    assert done.returncode == 0
    starts = ("eyas: made ", "eyas: making ")
    assert all(line.startswith(starts) for line in done.stderr.splitlines())
    document = json.loads(path.read_text())
    names = [result["name"] for result in document["results"]]
    assert len(set(names)) == len(names) >= 17
    starts = {name.split()[0] for name in names}
    assert starts >= {"first", "pictures", "steps,", "reset", "peak", "textures"}
    learning = next(row for row in document["results"] if row["name"].startswith("learning"))
    assert 95 <= sum(map(int, re.findall(r" (\d+)%", learning["includes"]))) <= 110
    for words in ("48x48, 64 views", "night", "snow", "4 samples", "horizon", "1280x720"):
        assert any(words in name for name in names), words
    for result in document["results"]:
        timed = result["name"].startswith(("first", "pictures", "steps", "reset"))
        assert not timed or result["cpu_microseconds"] > 0
        assert result["value"] > 0
        assert result["unit"] in UNITS
        assert result["repeats"] >= 1
    # The title is broken where the terminal ends, perhaps within the processor's name.
    assert "".join(document["machine"].split()) in "".join(done.stdout.split())
    stages = {(row["pictures"], row["stage"]) for row in document["stages"]}
    assert len(stages) == len(document["stages"]) == 4 * 6
