"""Flights of people, recorded for a leaderboard; server, socket, simulator and files are real."""

import json
import math
import shutil

import pytest

from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.plan import batches
from eyas.benchmark.policies.person import read_log
from eyas.benchmark.records.result import load_run
from eyas.benchmark.report.leaderboard import page
from eyas.benchmark.report.leaderboard.mark import KEY_VARIABLE
from eyas.benchmark.report.leaderboard.pack import pack
from eyas.benchmark.report.leaderboard.submission import read_card, submissions_in
from eyas.benchmark.report.leaderboard.verify import EntryVerdict, verify
from eyas.demo.reference import FILE, plan_for
from eyas.engine.core.errors import EyasError

from .conftest import Viewer

pytestmark = pytest.mark.slow  # flights are in real time

GRASS = ["--record-for", "paper", "--map", "simpleway-grass", "--episodes", "1"]


def stage_of(viewer, wanted, seconds=120):
    """Read until the page is told of a stage."""
    while viewer.told.get("reference", {}).get("stage") != wanted:
        if viewer.read(seconds) is not None:
            viewer.say("ack", frame=viewer.last)
    return viewer.told["reference"]


class Person(Viewer):
    """A page that flies the recorded flights."""

    def read(self, timeout=30.0):
        found = super().read(timeout)
        if found is not None:
            self.last = found[0]["frame"]
        return found

    def begin(self, pilot, device="keyboard"):
        told = stage_of(self, "ready")
        self.told.pop("reference")
        self.say("ready", pilot=pilot, device=device)
        return told

    def fly(self, seconds, *controls):
        """Hold controls until a time of the flight; return the states that were shown."""
        states = []
        while not states or states[-1].get("time", 0.0) < seconds:
            states.append(self.frame())
            self.hold(*controls)
        return states


@pytest.fixture(scope="module")
def flown(serve):
    """Four flights: one to its end, one left, one ended by a kill, and one by someone else."""
    demo = serve(*GRASS, "--out", "people", quick=[])
    folder = demo.folder / "people"
    ann = Person(demo.socket)
    facts = {"first": ann.begin("Ann")}
    facts["states"] = ann.fly(2.5, "forward")
    ann.begin("Ann")
    ann.fly(0.5, "turn_left")
    ann.say("leave")
    ann.begin("Ann")
    ann.fly(0.3)
    demo.process.kill()
    demo.process.wait(20)
    ann.close()
    facts["torn"] = read_log(folder / FILE)
    again = serve(*GRASS, "--out", "people", folder=demo.folder, quick=[])
    bob = Person(again.socket)
    facts["last"] = bob.begin("Bob", "gamepad")
    bob.fly(2.5, "back")
    stage_of(bob, "over")
    bob.close()
    assert again.process.wait(60) == 0
    facts["said"] = again.process.stdout.read()
    return folder, facts


def test_each_episode_has_one_attempt_which_counts_as_far_as_it_was_flown(flown):
    folder, facts = flown
    assert (facts["first"]["number"], facts["first"]["total"]) == (1, 4)
    assert facts["last"]["number"] == 4
    assert len(facts["torn"].attempts) == 3
    assert len(facts["torn"].flown) == 2
    stamp, records = load_run(folder)
    log = read_log(folder / FILE)
    assert [own.attempt for own in log.attempts.values()] == [1, 2, 3, 4]
    assert [own.pilot for own in log.attempts.values()] == ["Ann", "Ann", "Ann", "Bob"]
    assert [own.episode for own in log.attempts.values()] == [one.name for one in records]
    assert [one.error is None for one in records] == [True, False, False, True]
    assert records[1].error.startswith("left by the pilot after 0.")
    assert 0.4 < records[1].duration < 2.0
    assert records[2].error == "the demo ended in the middle of the flight"
    assert records[2].duration == records[2].tsr == 0.0
    assert stamp.entry.entry_class == "human"
    assert "4 flights" in facts["said"]


def test_the_first_picture_has_the_box_and_no_later_one_any_truth(flown):
    _, facts = flown
    first, later = facts["states"][0], facts["states"][-1]
    left, top, right, bottom = first["box"]
    assert 0.0 < left < right < 1.0
    assert 0.0 < top < bottom < 1.0
    assert later.keys() == {"frame", "sequence", "input", "stage", "time", "words", "picture"}


def test_held_keys_fly_at_the_speeds_of_the_demo(flown):
    folder, _ = flown
    _, records = load_run(folder)
    (x, y), *_, (u, v) = records[0].trace.drone
    assert math.hypot(u - x, v - y) / (2.88 - 0.16) == pytest.approx(20.0, rel=0.2)
    actions = [
        action for own in read_log(folder / FILE).flown.values() for _, action in own.actions
    ]
    assert (20.0, 0.0, 0.0, 0.0) in actions
    assert (0.0, 0.0, 0.0, math.radians(90.0)) in actions


def test_the_same_flights_from_the_log_are_equal_and_the_class_stands_apart(
    flown, tmp_path, monkeypatch
):
    monkeypatch.setenv(KEY_VARIABLE, str(tmp_path / "key"))
    board = tmp_path / "board"
    folder = shutil.copytree(flown[0], board / "people")
    (found,) = verify(board, share=1.0, fresh=40)
    assert found.verdict is EntryVerdict.VERIFIED, found.line
    assert "4 of 4" in found.why
    page.run(board, board / "index.html")
    shown = (board / "index.html").read_text()
    assert "<h3>People</h3>" in shown
    assert "people: 2; 4 flights, 2 left early; gamepad, keyboard; pictures 640 x 480" in shown
    assert "none: people fly once" in shown
    line = (folder / FILE).read_text().replace("20.0", "19.0")
    (folder / FILE).write_text(line)
    (found,) = verify(board, share=1.0)
    assert found.verdict is EntryVerdict.DIFFERENT


def test_an_entry_of_people_can_be_packed(flown):
    folder, _ = flown
    people = read_card(folder).people
    assert people.people == 2
    assert people.attempts == 4
    assert 0.0 < people.picture_ms < 5000.0
    assert 0.0 < people.slowest <= 1.0
    assert "4 episodes of 'paper'" in pack(folder).about


def test_attempts_that_are_left_out_or_chosen_contradict_the_records(flown, tmp_path, caplog):
    whole = (flown[0] / FILE).read_text().splitlines(keepends=True)
    for name, lines in {
        "fewer": whole[:-2],
        "again": [*whole, whole[1].replace('"attempt":1', '"attempt":5')],
        "not left": [line.replace("left by the pilot", "right by the pilot") for line in whole],
    }.items():
        folder = shutil.copytree(flown[0], tmp_path / name / "people")
        (folder / FILE).write_text("".join(lines))
        caplog.clear()
        assert list(submissions_in(tmp_path / name)) == []
        assert "left out" in caplog.text


def test_a_recorded_person_flies_no_other_episode(flown):
    plan = load_run(flown[0])[0].plan
    other = plan.model_copy(update={"policy": str(flown[0] / FILE), "seeds": (5_000_000,)})
    ((record,),) = fly_batch(other, batches(other)[0])
    assert record.error == "this episode has no recorded flight"


def test_what_a_person_cannot_fly_is_refused(tmp_path, eyas_command):
    with pytest.raises(EyasError, match="several drones"):
        plan_for("pair", tmp_path)
    for options, said in (
        (["--record-for", "lung"], "did you mean 'long'"),
        (["--record-for", "long", "--policy", "follow"], "--policy: not together"),
        (["--episodes", "3"], "only with --record-for"),
    ):
        done = eyas_command("demo", "--no-browser", *options)
        assert done.returncode != 0
        assert said in done.stderr


def test_a_file_of_flights_says_what_it_is(flown):
    first = json.loads((flown[0] / FILE).read_text().splitlines()[0])
    assert first["env"]["actions"] == "velocity"
    assert first["env"]["observation"] == {"width": 640, "height": 480}
