"""`eyas drone fit`: the constants of drones that flew with others."""

import json

import numpy as np
import pytest

from eyas.cli.app import run
from eyas.engine.core.errors import DataFileError
from eyas.engine.trackers.config import TrackerConfig
from eyas.robotics.fitting.fit import fit
from eyas.robotics.fitting.log import read_log

from ...kit.flight import Drones

GRAVITY = 9.81
NAMES = (
    *("time", "velocity_x", "velocity_y", "velocity_z"),
    *("orientation_w", "orientation_x", "orientation_y", "orientation_z"),
    *("felt_acceleration_x", "felt_acceleration_y", "felt_acceleration_z"),
    *("rotor_1", "rotor_2", "rotor_3", "rotor_4"),
)


def matrices(quaternions):
    w, x, y, z = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def flight(seconds=10.0, speed=10.0, seed=2, wind=(0.0, 0.0), **options):
    """Rows of a random flight, and the airframe that flew it."""
    config = TrackerConfig(supervised=False, tells_rotors=True, **options)
    drones = Drones(config=config, height=60.0)
    memory, first = drones.memory.flight, drones.rotor.copy()
    memory.wind.mean[0] = wind
    size = speed * np.array([1.0, 1.0, 4e-4, 0.1])
    chosen = np.random.default_rng(seed).uniform(-size, size, (round(seconds * 2.5), 4))
    log = drones.fly(np.repeat(chosen, 200, axis=0))
    change = np.diff(log.velocity[:, 0], axis=0, prepend=np.zeros((1, 3))) / 0.002
    felt = np.einsum(
        "kji,kj->ki", matrices(log.attitude[:, 0]), change + np.array([0.0, 0.0, GRAVITY])
    )
    left = np.exp(-0.002 / memory.frame.motor_time_constant)
    rotors = np.concatenate([first, log.rotor[:, 0]])
    asked = (rotors[1:] - left * rotors[:-1]) / (1.0 - left)
    assert asked[-1] == pytest.approx(drones.memory.asked[0], rel=1e-9)
    time = 0.002 * np.arange(1, len(asked) + 1)
    rows = [time, log.velocity[:, 0], log.attitude[:, 0], felt, asked]
    return np.column_stack(rows), memory.frame


def saved(path, rows, names=NAMES):
    np.savetxt(path, rows, delimiter=",", header=",".join(names), comments="", fmt="%.10g")
    return path


SLOW = {"motor_time_constant": 0.03, "drag_area": 0.05}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "every"),
    [(SLOW, 1), (SLOW, 5), ({"airframe": "5-inch"}, 2), ({"airframe": "20-inch"}, 1)],
)
def test_the_constants_of_a_flight_are_found_again(tmp_path, options, every):
    rows, frame = flight(**options)
    found = fit(read_log(saved(tmp_path / "log.csv", rows[::every])))
    assert found.thrust.value == pytest.approx(frame.thrust_constant / frame.mass, rel=0.01)
    assert found.drag.value == pytest.approx(frame.drag_area / frame.mass, rel=0.04)
    assert found.lag.value == pytest.approx(frame.motor_time_constant, abs=0.0003 + 0.0008 * every)
    assert found.rate == pytest.approx(500.0 / every)
    assert found.error < 0.15 * found.spread
    assert found.speed_error < 0.1
    assert found.thrust.is_determined
    assert found.drag.is_determined
    assert found.lag.is_determined


def test_noise_widens_the_intervals_and_they_hold_the_truth(tmp_path):
    rows, frame = flight(20.0, **SLOW)
    quiet = fit(read_log(saved(tmp_path / "quiet.csv", rows)))
    rng = np.random.default_rng(5)
    rows[:, 8:11] += rng.normal(0.0, 2.0, (len(rows), 3))
    rows[:, 1:4] += rng.normal(0.0, 0.1, (len(rows), 3))
    noisy = fit(read_log(saved(tmp_path / "noisy.csv", rows)))
    for before, after in ((quiet.thrust, noisy.thrust), (quiet.lag, noisy.lag)):
        assert after.high - after.low > 2.0 * (before.high - before.low)
    truth = frame.thrust_constant / frame.mass
    assert noisy.thrust.low < truth < noisy.thrust.high
    assert noisy.lag.low < 0.03 < noisy.lag.high
    assert noisy.drag.low < 0.05 / frame.mass < noisy.drag.high
    assert noisy.error == pytest.approx(2.0 * np.sqrt(3.0), rel=0.05)


def test_velocities_do_where_no_accelerometer_is_and_wind_is_taken_off(tmp_path):
    rows, frame = flight(wind=(6.0, -3.0), **SLOW)
    kept = [at for at, name in enumerate(NAMES) if not name.startswith("felt")]
    table = np.column_stack([rows[:, kept], np.tile([6.0, -3.0, 0.0], (len(rows), 1))])
    names = (*(NAMES[at] for at in kept), "wind_x", "wind_y", "wind_z")
    found = fit(read_log(saved(tmp_path / "log.csv", table, names)))
    assert found.thrust.value == pytest.approx(frame.thrust_constant / frame.mass, rel=0.01)
    assert found.drag.value == pytest.approx(frame.drag_area / frame.mass, rel=0.05)
    still = fit(read_log(saved(tmp_path / "still.csv", table[:, :-3], names[:-3])))
    assert abs(still.drag.value - found.drag.value) > 0.2 * found.drag.value


def test_a_hover_does_not_tell_the_drag(tmp_path):
    rows, frame = flight(speed=0.02, **SLOW)
    found = fit(read_log(saved(tmp_path / "log.csv", rows)))
    assert found.thrust.value == pytest.approx(frame.thrust_constant / frame.mass, rel=0.01)
    assert not found.drag.is_determined


def test_the_command_prints_what_follows_from_a_known_constant(tmp_path, monkeypatch, capsys):
    rows, frame = flight(**SLOW)
    path = saved(tmp_path / "log.csv", rows)
    arguments = ["eyas", "drone", "fit", str(path), "--thrust-constant", "2.55e-5"]
    monkeypatch.setattr("sys.argv", [*arguments, "--json"])
    assert run() == 0
    told = json.loads(capsys.readouterr().out)
    assert told["mass"][0] == pytest.approx(frame.mass, rel=0.01)
    assert told["drag_area"][0] == pytest.approx(0.05, rel=0.03)
    monkeypatch.setattr("sys.argv", arguments)
    assert run() == 0
    assert "time constant of the rotors" in capsys.readouterr().out
    monkeypatch.setattr("sys.argv", [*arguments, "--mass", "3"])
    assert run() == 2
    assert "only one of them" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("rotor_3", "engine"), "tells_rotors"),
        (lambda text: text.replace("velocity_y", "speed"), "'velocity_y'"),
        (lambda text: text.replace(",1,0,0,0,", ",9,0,0,0,"), "no unit quaternions"),
        (lambda text: "\n".join(text.splitlines()[:50]), "49 rows; at least 200"),
        (lambda text: text.replace("0.004,", "nan,", 1), "line 3: 'time' is no number"),
        (lambda text: text.replace("0.004,", "7,", 1), "do not rise"),
        (lambda text: text.replace("rotor_4", "rotor_3"), "'rotor_3' is there twice"),
        (lambda text: text + "1" * 200_000, "not a table: field larger"),
    ],
)
def test_what_is_no_log_is_told_in_one_line(tmp_path, change, said):
    rows = np.tile([0.0, 1.0, 0.0, 0.0, 1.0, *[0.0] * 5, 9.81, *[540.0] * 4], (300, 1))
    rows[:, 0] = 0.002 * np.arange(1, 301)
    path = saved(tmp_path / "log.csv", rows)
    path.write_text(change(path.read_text()))
    with pytest.raises(DataFileError, match=said) as caught:
        fit(read_log(path))
    assert "\n" not in str(caught.value)


def test_a_log_in_other_frames_is_refused(tmp_path):
    rows, _ = flight(seconds=2.0, **SLOW)
    rows[:, [2, 3, 6, 7, 9, 10]] *= -1.0  # the body's frame: forward, right, down
    with pytest.raises(DataFileError, match="body frame of forward, left, up"):
        fit(read_log(saved(tmp_path / "log.csv", rows)))


def test_a_flight_that_tells_nothing_is_refused(tmp_path):
    rows = np.tile([0.0, 0.0, 0.0, 0.0, 1.0, *[0.0] * 5, 9.81, *[540.0] * 4], (300, 1))
    rows[:, 0] = 0.002 * np.arange(1, 301)
    with pytest.raises(DataFileError, match="tells neither thrust nor drag"):
        fit(read_log(saved(tmp_path / "log.csv", rows)))
