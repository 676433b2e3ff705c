"""`eyas track`: box trackers on recorded episodes; GOT-10k's own toolkit checks the figures."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eyas.datasets.tracking.clip import RecordedClip
from eyas.datasets.tracking.one_pass import overlaps
from eyas.datasets.tracking.run import Scoring, run
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import EyasError
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.recording import load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.task.config import StartConfig
from eyas.engine.video import run as video

OWN = "own_box_trackers"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Four flights of a drone that follows like a human."""
    folder = tmp_path_factory.mktemp("track") / "flights"
    config = EyasConfig(
        seed=5,
        camera=CameraConfig(width=96, height=72),
        start=StartConfig(height=15.0),
        video=VideoConfig(channels=4, fps=10.0, total_time=2.0, flight="follow",
                          writers=("jpeg", "labels")),
    )  # fmt: skip
    video.run(config, folder, quiet=True)
    return folder


@pytest.fixture(autouse=True)
def own(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmark"))


def scored(folder, out, tracker, **options):
    return run(Scoring(tracker, folder), out, workers=1, **options)


def as_got10k_data(folder, tmp_path):
    """Export as GOT-10k's validation set, without what the toolkit cannot read."""
    target = tmp_path / "exported"
    export(load(folder), "got10k", target, ExportOptions())
    shutil.move(target / "train", target / "val")
    return target


@pytest.mark.slow
@pytest.mark.parametrize("tracker", ["stay", f"{OWN}:Drifting", f"{OWN}:LosesIt"])
def test_figures_are_those_of_the_toolkit_of_got10k(folder, tmp_path, monkeypatch, tracker):
    experiments = pytest.importorskip("got10k.experiments")
    monkeypatch.chdir(tmp_path)
    results = scored(folder, tmp_path / "out", tracker)
    data = as_got10k_data(folder, tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        experiment = experiments.ExperimentGOT10k(
            str(data), "val", str(tmp_path / "results"), str(tmp_path / "reports")
        )
        for episode in load(folder):
            table = np.loadtxt(tmp_path / "out/boxes" / f"{episode.name}.txt", delimiter=",")
            record = tmp_path / "results/GOT-10k/ours" / episode.name / f"{episode.name}_001.txt"
            experiment._record(str(record), table[:, :4], np.ones(len(table)))
        theirs = experiment.report(["ours"])["ours"]["overall"]
    ours = results["all"]
    assert ours["ao"] == pytest.approx(theirs["ao"], abs=5e-5)
    assert ours["sr50"] == pytest.approx(theirs["sr"], abs=5e-5)
    assert results["curves"]["success"] == pytest.approx(theirs["succ_curve"], abs=5e-5)


def test_any_number_of_processes_and_an_interruption_give_the_same_bytes(folder, tmp_path):
    files = {}
    for workers in (1, 2):
        out = tmp_path / str(workers)
        run(Scoring("stay", folder), out, workers=workers)
        files[workers] = everything(out)
    assert files[1] == files[2]
    (tmp_path / "1/boxes/DRONE2-episode0.txt").unlink()
    (tmp_path / "1/results.json").unlink()
    run(Scoring("stay", folder), tmp_path / "1", workers=1, resume=True)
    assert everything(tmp_path / "1") == files[1]


@pytest.mark.slow
def test_the_order_of_episodes_changes_no_box_of_opencv(folder):
    pytest.importorskip("cv2")
    from eyas.benchmark.policies.box_trackers import box_tracker
    from eyas.datasets.tracking.one_pass import track_clip

    episodes = list(load(folder))
    for name in ("csrt", "kcf", "mosse", "medianflow"):
        make = box_tracker(name)
        there = [track_clip(make, RecordedClip(episode)).boxes for episode in episodes]
        back = [track_clip(make, RecordedClip(episode)).boxes for episode in episodes[::-1]][::-1]
        assert all((one == two).all() for one, two in zip(there, back, strict=True)), name


def everything(out):
    return {
        path.relative_to(out): path.read_bytes()
        for path in out.rglob("*")
        if path.is_file() and path.name != "timing.json"
    }


def test_strata_divide_all_frames_that_count(folder, tmp_path):
    results = scored(folder, tmp_path / "out", "stay")
    whole = results["all"]
    assert 0.0 < whole["ao"] < 1.0
    assert whole["ao_interval"] is None  # of so few episodes none can be had
    for values in results["strata"].values():
        frames = [figures["frames"] for figures in values.values()]
        assert sum(frames) == whole["frames"]
        mean = sum(f["frames"] * f.get("ao", 0.0) for f in values.values()) / whole["frames"]
        assert mean == pytest.approx(whole["ao"], abs=1e-5)
    visible = sum((e.array("visible_fraction")[1:] > 0).sum() for e in load(folder))
    assert whole["frames"] == visible


def test_the_interval_of_an_overlap_is_that_of_independent_episodes():
    from eyas.datasets.tracking.one_pass import figures_of

    rng, held = np.random.default_rng(1), 0
    for _ in range(400):
        levels = rng.uniform(0.2, 0.8, 30)  # all frames of an episode are about alike
        found = figures_of([(np.full(50, level), np.zeros(50)) for level in levels])
        held += found.ao_interval.low <= 0.5 <= found.ao_interval.high
    assert 0.92 <= held / 400 <= 0.98


def test_with_restarts_a_tracker_that_finds_nothing_begins_again_and_again(
    folder, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    scoring = Scoring(f"{OWN}:LosesIt", folder, restarts=True)
    results = run(scoring, tmp_path / "out", workers=1)
    failures = [episode["failures"] for episode in results["episodes"].values()]
    assert max(failures) >= 2
    # Each begins once, and after each failure if the episode is long enough.
    begun = len(Path("begun").read_text())
    assert sum(failures) <= begun <= sum(failures) + len(failures)
    told = [line for path in (tmp_path / "out/boxes").iterdir()
            for line in path.read_text().splitlines() if line.endswith(",1")]  # fmt: skip
    assert len(told) == begun


def test_an_absurd_box_overlaps_nothing(folder, tmp_path):
    results = scored(folder, tmp_path / "out", f"{OWN}:Wild")
    assert results["all"]["ao"] == 0.0
    assert json.loads((tmp_path / "out/results.json").read_text()) == results


@pytest.mark.parametrize(
    ("tracker", "told"),
    [
        ("csrtt", "did you mean 'csrt'"),
        ("own_box_trackers:Nothing", "has no 'Nothing'"),
        ("own_box_trackers:Path", "begin(picture, box)"),
        (f"{OWN}:Fails", "DRONE0-episode0: RuntimeError: no luck at all"),
        ("nano", "EYAS_NANOTRACK"),
    ],
)
def test_a_tracker_that_does_not_work_is_one_line(folder, tmp_path, tracker, told):
    with pytest.raises(EyasError) as error:
        scored(folder, tmp_path / "out", tracker)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_what_is_in_the_folder_is_neither_lost_nor_mixed(folder, tmp_path):
    out = tmp_path / "out"
    scored(folder, out, "stay")
    with pytest.raises(EyasError, match="not empty; continue it with --resume"):
        scored(folder, out, "stay")
    with pytest.raises(EyasError, match="not continued"):
        scored(folder, out, f"{OWN}:Drifting", resume=True)
    scored(folder, out, f"{OWN}:Drifting", overwrite=True)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.tex").write_text("years")
    with pytest.raises(EyasError, match="not of eyas track"):
        scored(folder, tmp_path / "mine", "stay", overwrite=True)


BOXES = st.tuples(*[st.floats(-50, 50)] * 2, *[st.floats(0, 60)] * 2)


@given(BOXES, BOXES)
def test_overlap_is_that_of_shapely(first, second):
    from shapely.geometry import box

    ours = overlaps(np.array([first]), np.array([second]))[0]
    one, two = (box(x, y, x + w, y + h) for x, y, w, h in (first, second))
    union = one.union(two).area
    expected = one.intersection(two).area / union if union > 1e-6 else ours
    assert ours == pytest.approx(expected, abs=1e-6)


def test_the_same_class_flies_closed_loop(tmp_path):
    from eyas.benchmark.flight.policy_runner import fly_batch
    from eyas.benchmark.plan.plan import EvaluationPlan, batches

    plan = EvaluationPlan(policy=f"{OWN}:Drifting", episodes=1, batch=1)
    ((record,),) = fly_batch(plan, batches(plan)[0])
    assert record.reason


def test_truth_is_inside_the_picture(folder):
    for episode in load(folder):
        boxes = RecordedClip(episode).boxes
        assert (boxes[:, :2] + boxes[:, 2:] <= episode.size).all()


def test_opencv_trackers_follow_a_moving_square(tmp_path):
    pytest.importorskip("cv2")
    from eyas.benchmark.policies.box_trackers import box_tracker

    ground = np.random.default_rng(0).integers(0, 255, (120, 160, 3), dtype=np.uint8) // 4
    square = np.random.default_rng(1).integers(128, 255, (24, 24, 3), dtype=np.uint8)

    def picture(number):
        drawn = ground.copy()
        drawn[40:64, 30 + 2 * number : 54 + 2 * number] = square
        return drawn

    for name in ("csrt", "kcf"):
        tracker = box_tracker(name)()
        tracker.begin(picture(0), (30.0, 40.0, 24.0, 24.0))
        for number in range(1, 8):
            box = tracker.update(picture(number))
        truth = np.array([(44.0, 40.0, 24.0, 24.0)])
        assert overlaps(np.array([box]), truth)[0] > 0.3, name


def test_a_process_that_is_killed_is_one_line(folder, tmp_path, monkeypatch):
    (tmp_path / "deadly.py").write_text(
        "import os\n"
        "class Tracker:\n"
        "    def begin(self, picture, box): os._exit(9)\n"
        "    def update(self, picture): ...\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(EyasError, match=r"^--workers: a process was killed"):
        run(Scoring("deadly:Tracker", folder), tmp_path / "out", workers=2)


def test_ctrl_c_is_one_line_that_tells_how_to_go_on(folder, tmp_path):
    (tmp_path / "slow.py").write_text(
        "import time\n"
        "class Tracker:\n"
        "    def begin(self, picture, box): open('begun', 'w').close(); time.sleep(60)\n"
        "    def update(self, picture): ...\n"
    )
    command = [*(sys.executable, "-m", "eyas", "track", folder, "--tracker", "slow:Tracker"),
               *("--workers", "2", "--out", "out", "--quiet")]  # fmt: skip
    paths = os.pathsep.join([".", *sys.path])
    process = subprocess.Popen(
        command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={**os.environ, "PYTHONPATH": paths},
    )  # fmt: skip
    while not (tmp_path / "begun").exists():
        assert process.poll() is None
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes
    _, told = process.communicate(timeout=50)
    line = "eyas: interrupted; every file in out is whole; continue with --resume\n"
    assert (process.returncode, told) == (130, line)
