"""The demo in Rerun's viewer."""

import pytest

from ..kit.rerun_viewer import rerun_server, rows_of

SMALL = ["--map", "desert-bare", "--set", "camera.width=32", "--set", "camera.height=24"]


@pytest.mark.slow
def test_what_the_camera_sees_is_shown_in_rerun(eyas_command, tmp_path):
    with rerun_server(tmp_path / "seen.rrd") as (_, place):
        done = eyas_command(
            "demo", "--headless", "--seconds", "0.5", *SMALL, "--set", "target=Pedestrian",
            "--rerun-at", place,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "seen.rrd")
    assert rows["/DRONE0/reward"] >= 1
    assert rows["/world/DRONE0/camera/image/boxes"] == rows["/DRONE0/reward"]


def test_flights_for_a_leaderboard_are_not_shown_elsewhere(eyas_command):
    done = eyas_command("demo", "--record-for", "long", "--rerun-at", "127.0.0.1:9876")
    assert done.returncode == 2
    assert "--rerun-at: not together with --record-for" in done.stderr
