import math
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.custom.problems import of_noise, of_trajectory, worst
from eyas.engine.custom.trajectory import Trajectory, read_trajectory


def written(folder: Path, text: str) -> Path:
    path = folder / "track.csv"
    path.write_text(text)
    return path


def test_points_are_passed_at_their_times_and_smoothly(tmp_path: Path):
    lines = "".join(f"{k},{10 * math.cos(k / 10)},{10 * math.sin(k / 10)}\n" for k in range(5, 40))
    track = read_trajectory(written(tmp_path, "t,x,y\n" + lines))
    assert track.time[0] == 0.0  # whatever the clock of the receiver
    place, yaw = track.at(track.time)
    np.testing.assert_allclose(place[:, :2], track.position[:, :2], atol=1e-9)
    between, heading = track.at(np.arange(10, 240) / 10.0)
    radius = np.hypot(between[:, 0], between[:, 1])
    np.testing.assert_allclose(radius, 10.0, atol=0.01)
    angle = np.unwrap(np.arctan2(between[:, 1], between[:, 0])) + math.pi / 2
    np.testing.assert_allclose(np.sin(heading - angle), 0.0, atol=0.02)
    assert len(yaw) == 35


def test_errors_of_a_receiver_are_told():
    time = np.arange(60.0)
    walk = np.column_stack([1.4 * time, 10.0 * np.sin(time / 10.0), np.full(60, np.nan)])
    assert list(of_noise(Trajectory(time, walk, None))) == []
    walk[:, :2] += np.random.default_rng(0).normal(0.0, 1.0, (60, 2))
    (told,) = of_noise(Trajectory(time, walk, None))
    assert "custom.smoothing=2 leaves 0.1 m/s^2, and cuts a sharp turn by up to 2 m" in told.text
    drive = np.column_stack([8.0 * time, 30.0 * np.sin(time / 5.0), np.full(60, np.nan)])
    drive[:, :2] += np.random.default_rng(0).normal(0.0, 2.0, (60, 2))
    (told,) = of_noise(Trajectory(time, drive, None))
    assert "custom.smoothing=1 leaves" in told.text  # more would cut its bends


def test_points_at_uneven_times_give_an_even_motion(tmp_path: Path):
    times = (0.0, 1.0, 1.4, 4.0, 4.3, 7.0)
    lines = "".join(f"{t},{2 * t},{-t}\n" for t in times)
    time = np.arange(0.0, 7.0, 0.1)
    place, yaw = read_trajectory(written(tmp_path, "t,x,y\n" + lines)).at(time)
    np.testing.assert_allclose(place[:, :2], np.outer(time, [2.0, -1.0]), atol=1e-9)
    np.testing.assert_allclose(yaw, math.atan2(-1.0, 2.0), atol=1e-9)


def test_columns_come_in_any_order_and_a_told_heading_counts(tmp_path: Path):
    text = "yaw, y, x, t, z\n3.1,0,0,0,1\n-3.1,0,1,1,2\n-2.9,0,2,2,3\n"
    track = read_trajectory(written(tmp_path, text))
    place, yaw = track.at(np.array([0.5, 2.0]))
    assert place[1].tolist() == [2.0, 0.0, 3.0]
    assert yaw[0] == pytest.approx(math.pi, abs=1e-9)  # over the jump at 180 degrees


def test_who_stands_keeps_the_heading(tmp_path: Path):
    text = "t,x,y\n" + "".join(f"{k},{min(k, 4)},0\n" for k in range(12))
    _, yaw = read_trajectory(written(tmp_path, text)).at(np.arange(0.0, 11.0, 0.1))
    np.testing.assert_allclose(yaw, 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: no column 'x'"),
        ("x,y\n0,0\n1,1\n", "no column 't'; allowed here: t,x,y"),
        ("t,x\n0,0\n", "line 1: no column 'y' in 't,x'; allowed: t,x,y and perhaps z,yaw"),
        ("t,x,y\n0,0,0\n", "1 points; a trajectory has two or more"),
        ("t,x,y\n0,0,0\n1,nan,0\n", "line 3: '1,nan,0' is not allowed: 3 finite numbers"),
        ("t,x,y\n0,0,0\n1,0\n", "line 3: '1,0' is not allowed: 3 finite numbers"),
        ("t,x,y\n0,0,0\n2,0,0\n1,0,0\n", "point 3: t is 1 after 2: time must increase"),
        ("t,x,y\n0,0,0\n1,0,0\n1,1,0\n", "point 3: t is 1 after 1: time must increase"),
    ],
)
def test_what_is_no_trajectory_is_told_in_one_line(tmp_path: Path, text: str, message: str):
    with pytest.raises(DataFileError) as caught:
        read_trajectory(written(tmp_path, text))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_jumps_gaps_and_places_outside_the_map_are_told():
    time = np.array([0.0, 1.0, 2.0, 20.0])
    position = np.array([[0, 0], [1, 0], [400, 0], [401, 0]], np.float64)
    track = Trajectory(time, np.column_stack([position, np.full(4, np.nan)]), None)
    assert track.jumps().tolist() == [2]
    told = list(of_trajectory(track, (600.0, 600.0), "meadow"))
    assert [finding.fatal for finding in told] == [True, False, False]
    assert told[0].text == "point 3: it jumps 399 m in 1 s; allowed: up to 100 m/s"
    assert told[1].text.startswith("2 of 4 points are outside the map 'meadow' (600 x 600 m")
    assert told[2].text.startswith("1 gap of more than 5 s")


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ("0,0,0,0,0\n1,1,0,1e300,0", "line 3: z = 1e\\+300 is not allowed: up to 1e\\+09"),
        ("0,1e300,0,0,0\n1,1,0,0,0", "line 2: x = 1e\\+300 is not allowed"),
        ("0,0,0,0,0\n1,1,0,0,-1e300", "line 3: yaw = -1e\\+300 is not allowed"),
        ("-1.7e308,0,0,0,0\n1.7e308,1,0,0,0", "line 2: t = -1.7e\\+308 is not allowed"),
        ("0,0,0,0,0\n1e9,1,0,0,0", "it lasts 1e\\+09 s; allowed: up to 86400 s"),
        (f"0,0,0,0,0\\n1,1,0,{'9' * 5000},0", "finite numbers"),
    ],
)
def test_absurd_numbers_are_one_short_line(tmp_path, rows, line):
    path = tmp_path / "a.csv"
    path.write_text("t,x,y,z,yaw\n" + rows)
    with pytest.raises(DataFileError, match=line) as caught:
        read_trajectory(path)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("heights", "line"),
    [((0, 500, 0), "point 2: it jumps 500 m in 1 s"), ((2e4,) * 3, "point 1: z = 20000 m is not")],
)
def test_heights_are_bounded_as_places_are(heights, line):
    places = [(k, 0.0, z) for k, z in enumerate(heights)]
    trajectory = Trajectory(np.arange(3.0), np.array(places, np.float64), None)
    assert line in worst(of_trajectory(trajectory, (900.0, 900.0), "citystreet"))
