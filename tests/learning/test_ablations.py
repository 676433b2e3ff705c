"""The tool that takes parts of the tracker away."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker.course import HORIZONS, Course
from eyas.benchmark.policies.tracker.detector import Detector
from eyas.benchmark.policies.tracker.motion import MotionFilter
from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.benchmark.protocols.table import protocol_named
from eyas.learning.tracking import driving, flights, lessons, training
from eyas.learning.tracking.flights import Oracle
from eyas.learning.tracking.lessons import GROUP, Samples, Shots

ROOT = Path(__file__).parents[2]


def _tool():
    spec = importlib.util.spec_from_file_location("ablations", ROOT / "tools/ablations.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


TOOL = _tool()
SIZE = 60, 80


def test_the_documents_have_its_rows():
    page = (ROOT / "docs/lab/tracker.md").read_text()
    tables = [part.split("\n\n", 1)[0] for part in page.split("| taken away |")[1:]]
    lines = [line for table in tables for line in table.splitlines()[2:]]
    assert {line.split("|")[1].strip() for line in lines} == {
        row.says for row in TOOL.ROWS.values()
    }


def taught(name):
    """Return a sample of pictures in the lessons of a row, and the keys' `known`."""
    rng = np.random.default_rng(3)
    place = rng.uniform(5.0, 55.0, (4, 6, 2)).astype(np.float32)
    nan = np.full_like(place, np.nan)
    ones = np.ones((4, 6), np.float32)
    pictures = np.zeros((4, 6, 3, *SIZE), np.uint8)
    shots = Shots(pictures, place, ones, nan, nan[..., 0], ones > 0)
    with TOOL.changed(TOOL.ROWS[name]):
        sample = Samples(shots, rng).draw(8)
        keys = sample.place.new_ones(8 * GROUP, 5)
        return sample, lessons._keys(keys, sample.seen, rng)[1]


def test_lessons_lack_the_part():
    sample, known = taught("whole")
    assert known.any()
    assert len(set(sample.spread.tolist())) > 1
    assert not taught("no-key")[1].any()
    sample, known = taught("no-place")
    assert known.any()
    flat = sample.spread == TOOL.FLAT
    assert 0.7 < flat.float().mean() < 1.0
    assert (sample.expected[flat] == sample.expected.new_tensor((40.0, 30.0))).all()


def test_flights_lack_the_part():
    with TOOL.changed(TOOL.ROWS["one-map"]):
        assert set(flights._TURN) == {"citystreet"}
    with TOOL.changed(TOOL.ROWS["one-weather"]):
        episodes = flights._episodes(np.random.default_rng(0), 2)
    assert len(episodes) == len(flights._episodes(np.random.default_rng(0), 2))
    assert {each.place.weather for each in episodes} == {"day"}


def test_the_oracle_flies_instead_of_the_tracker():
    with TOOL.changed(TOOL.ROWS["no-own-flights"]):
        assert isinstance(training._pupil("eyas", np.random.default_rng(0)), Oracle)


def looks(name, monkeypatch):
    """Return the tracker of a row after a short flight, and clue and answer of each look."""
    seen = []
    with TOOL.changed(TOOL.ROWS[name]):
        finds = Detector.find

        def noted(self, pictures, clue):
            found = finds(self, pictures, clue)
            seen.append((clue, found))
            return found

        monkeypatch.setattr(Detector, "find", noted)
        tracker = open_policy("eyas", {})
        assert isinstance(tracker, Tracker)
        protocol = protocol_named("paper").changed({"done": {"total_steps": 160}})
        place = Place("simpleway-grass", "day", "SUMO_VEHICLE")
        episodes = protocol.choose([place], protocol, 1, 60_000_000)
        for _ in BatchFlight(episodes, protocol, tracker, delay_from("0")).fly():
            pass
        monkeypatch.undo()
    return tracker, seen


def test_the_tracker_flies_without_the_part(monkeypatch):
    whole, seen = looks("whole", monkeypatch)
    assert seen[-1][0].known.all()
    assert (whole.boxes != looks("no-box", monkeypatch)[0].boxes).any()
    assert not looks("no-key", monkeypatch)[1][-1][0].known.any()
    assert (looks("no-deviation", monkeypatch)[1][-1][1].spread == 1.0).all()
    seen = looks("no-place", monkeypatch)[1]
    assert (seen[0][0].spread < 10.0).all()  # the first box
    assert seen[-1][0].known.any()
    for clue, _ in seen:
        assert ((clue.spread == TOOL.FLAT) == clue.known).all()


def test_what_is_not_seen_is_held():
    tracker = open_policy("eyas", {})
    tracker.motion, rows = MotionFilter(2, 8.0), np.arange(2)
    place, velocity = np.array(((5.0, 1.0), (2.0, 3.0))), np.full((2, 2), 4.0)
    tracker.motion.begin(rows, place, velocity, 0.5, np.ones(2))
    tracker.left, tracker.sees = place - 1.0, np.array((True, False))
    with TOOL.changed(TOOL.ROWS["no-place"]):
        tracker._wait(rows)
    np.testing.assert_array_equal(tracker.motion.place, (place[0], place[1] - 1.0))
    np.testing.assert_array_equal(tracker.motion.velocity, (velocity[0], (0.0, 0.0)))


@pytest.mark.slow
def test_rows_are_made_once(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(flights, "_STEPS", 120)
    monkeypatch.setattr(flights, "_FLIGHTS", 2)
    monkeypatch.setattr(flights, "_TURN", ("citystreet",))
    monkeypatch.setattr(flights, "WEATHERS", ("day",) * 4)
    monkeypatch.setattr(driving, "_LOOKS", 200)
    monkeypatch.setattr(driving, "_LEAST", 150)
    monkeypatch.setattr(TOOL, "PLACES", (("paper", "citystreet", "day", 1),))
    words = ["--out", str(tmp_path), "--rows", "no-box", "no-own-flights", "--share", "0.001"]
    monkeypatch.setattr(sys, "argv", ["ablations.py", *words])
    TOOL.main()
    table = capsys.readouterr().out.splitlines()[-3:]
    assert [line.split("|")[1].strip() for line in table] == [
        TOOL.ROWS[name].says for name in ("whole", "no-box", "no-own-flights")
    ]
    assert not (tmp_path / "no-box/policy.onnx").exists()
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.jsonl")}
    TOOL.main()
    assert capsys.readouterr().out.splitlines()[-3:] == table
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.jsonl")}


@pytest.mark.parametrize("name", ["whole", "no-course"])
def test_what_is_not_seen_goes_straight_on(name):
    tracker, rows = open_policy("eyas", {}), np.arange(1)
    tracker.motion, tracker.course = MotionFilter(1, 8.0), Course(1)
    velocity = np.array(((6.0, 0.0),))
    tracker.motion.begin(rows, np.zeros((1, 2)), velocity, 0.5, np.ones(1))
    tracker.course.note(rows, np.zeros((1, 2)), velocity)
    tracker.course.set_out(rows)
    ahead = np.zeros((1, len(HORIZONS), 3), np.float32)
    ahead[..., 1] = HORIZONS  # to the left
    tracker.course.answer(rows, ahead)
    tracker.course.pass_time(rows, np.ones(1))
    with TOOL.changed(TOOL.ROWS[name]):
        tracker._go_on(rows)
    turned = name == "whole"
    np.testing.assert_allclose(tracker.motion.velocity, ((6.0, 1.0 * turned),), atol=1e-6)
