"""Frames in Rerun's viewer as they are recorded."""

import re
import socket
import sys

import pytest

from eyas.engine.core.errors import ConfigError, MissingExtraError, OutputError
from eyas.engine.recordings import rerun
from eyas.engine.recordings.rerun import LiveView, live_view
from eyas.engine.settings.file import load_settings
from eyas.engine.terminal.options import followed, recorded
from eyas.engine.video import run as video

from ...kit.rerun_viewer import rerun_server, rows_of

SETTINGS = [
    "world.map=desert-bare",
    *recorded(frames=5, episodes=None, drones=1, size="32x24", fps=None),
]
SMALL = ["--map", "desert-bare", "--target", "Pedestrian", "--size", "32x24", "--frames", "5"]


@pytest.mark.slow
def test_what_is_recorded_is_shown_and_has_the_same_bytes(eyas_command, tmp_path):
    with rerun_server(tmp_path / "seen.rrd") as (_, place):
        for folder, live in (("live", ["--rerun-at", place]), ("plain", [])):
            done = eyas_command("video", "--out", tmp_path / folder, "--drones", 2, *SMALL, *live)
            assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "seen.rrd")
    for name in ("DRONE0", "DRONE1"):
        assert rows[f"/{name}/reward"] == 5
        assert rows[f"/world/{name}/camera/image/boxes"] == 5
    live, plain = ((tmp_path / name / "checksums.sha256") for name in ("live", "plain"))
    assert live.read_bytes() == plain.read_bytes()


@pytest.mark.slow
def test_a_recording_outlives_its_viewer_and_says_so_once(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(rerun, "_LOOK", 0.0)
    config = load_settings(None, [*followed("Pedestrian"), *SETTINGS])
    shown = LiveView.show
    with rerun_server(tmp_path / "seen.rrd") as (server, place):

        def show(live, frame, episode):
            if frame.number == 2:
                server.kill()
                server.wait()
            shown(live, frame, episode)

        monkeypatch.setattr(LiveView, "show", show)
        with live_view(wanted=True, at=place) as live:
            video.run(config, tmp_path / "out", live=live)
    said = capfd.readouterr()  # of libraries, too
    assert "5 frames in" in said.out
    assert len(re.findall("takes no more frames", said.err)) == 1
    assert "grpc" not in said.err  # Rerun's own lines


@pytest.mark.parametrize("place", ["here", "localhost:0", ":9876", "localhost:99999", ""])
def test_another_form_of_an_address_is_refused(place):
    pytest.importorskip("rerun")
    with pytest.raises(ConfigError, match=r"^--rerun-at: '.*' is not of the form HOST:PORT"):
        LiveView(place)


def test_an_address_where_nothing_listens_is_refused():
    pytest.importorskip("rerun")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        place = f"127.0.0.1:{free.getsockname()[1]}"
    for wrong in (place, "nowhere.invalid:9876", "\u0130" * 80 + ":9876"):
        with pytest.raises(OutputError, match=r"^--rerun-at: no viewer listens on .* \(.+\)"):
            LiveView(wrong)


def test_a_viewer_that_cannot_open_its_window_is_refused(monkeypatch):
    pytest.importorskip("rerun")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        monkeypatch.setattr(rerun, "_OWN", free.getsockname())
    monkeypatch.setenv("WAYLAND_DISPLAY", "none-of-this-name")
    monkeypatch.setattr(rerun, "_SETTLE", 30.0)  # until it has ended
    with pytest.raises(OutputError, match=r"does not start here \(.+\).*--rerun-at HOST"):
        LiveView()
    monkeypatch.delenv("WAYLAND_DISPLAY")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr(rerun.sys, "platform", "linux")
    with pytest.raises(OutputError, match=r"\(there is no screen\)"):
        LiveView()


def test_a_missing_package_is_said_in_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(MissingExtraError, match=r"^--rerun needs the extra 'exports'"):
        LiveView("127.0.0.1:9876")


def test_several_processes_are_refused(eyas_command, tmp_path):
    with rerun_server(tmp_path / "seen.rrd") as (_, place):
        done = eyas_command("video", "--workers", 2, "--rerun-at", place, "--out", tmp_path / "a")
    assert done.returncode == 2
    assert "eyas: error: --workers: with --rerun" in done.stderr
    assert not (tmp_path / "a").exists()
