import os
import subprocess
import sys

import pytest

from eyas.dat.wire.exchange import ExchangeFolders
from eyas.engine.core.errors import DataFileError, OutputError

FILES = "Webots_Simulation/traffic_project/Files2Alg"


def test_the_folder_is_that_of_the_original(tmp_path):
    names = ExchangeFolders(tmp_path).names("DRONE3")
    assert names.action == tmp_path / FILES / "DRONE3_AlgAction.txt"
    assert names.state == tmp_path / FILES / "DRONE3_Ctrl2Global.txt"
    assert names.reward == tmp_path / FILES / "DRONE3_RewardParams.txt"
    assert names.picture == tmp_path / FILES / "DRONE3_VideoFrame.jpeg"


def test_a_root_that_is_no_folder_is_one_line(tmp_path):
    with pytest.raises(DataFileError, match="no such folder; give the one that holds"):
        ExchangeFolders(tmp_path / "nowhere")


def test_it_says_that_it_has_started_as_long_as_it_runs(tmp_path):
    exchange = ExchangeFolders(tmp_path)
    with exchange.opened():
        assert (exchange.files / "start.txt").read_text() == "b'1\\n'\n"
    assert not list(exchange.files.iterdir())


def test_only_files_of_the_protocol_are_deleted(tmp_path):
    exchange = ExchangeFolders(tmp_path)
    exchange.files.mkdir(parents=True)
    ours = (
        *("DRONE0_AlgAction.txt", "CAR12_Ctrl2Global.txt", "DRONE1_RewardParams.txt"),
        *("DRONE0_PointCloud.txt", "DRONE3_VideoFrame.jpeg", "recv_action2.txt", "start.txt"),
        ".DRONE0_Ctrl2Global.txt.part",
    )
    others = ("notes.txt", "DRONE0_AlgAction.txt.bak", "best.jpeg", "DRONE_AlgAction.txt")
    for name in (*ours, *others):
        (exchange.files / name).write_text("mine")
    (exchange.files / "DRONE7_AlgAction.txt").mkdir()
    with exchange.opened() as removed:
        assert removed == len(ours)
        assert {path.name for path in exchange.files.iterdir()} == {
            *others,
            *("DRONE7_AlgAction.txt", "start.txt", ".lock"),
        }


def test_nothing_outside_the_root_is_deleted_through_links(tmp_path):
    root, precious = tmp_path / "dat", tmp_path / "precious"
    precious.mkdir()
    (precious / "start.txt").write_text("mine")
    for inside in (FILES, "Webots_Simulation/traffic_project", "Webots_Simulation"):
        link = root / inside
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(precious)
        with pytest.raises(OutputError, match="a link leads out of"):
            ExchangeFolders(root)
        link.unlink()
        link.parent.rmdir()
    root.mkdir()
    exchange = ExchangeFolders(root)
    exchange.files.mkdir(parents=True)
    links = [exchange.files / f"DRONE{number}_AlgAction.txt" for number in range(2)]
    links[0].symlink_to(precious / "start.txt")
    links[1].symlink_to(precious)
    with exchange.opened():
        assert not any(map(os.path.lexists, links))
    assert (precious / "start.txt").read_text() == "mine"


HOLD = """
import sys
from pathlib import Path
from eyas.dat.wire.exchange import ExchangeFolders
with ExchangeFolders(Path(sys.argv[1])).opened():
    print("open", flush=True)
    sys.stdin.read()
"""


def test_two_servers_never_share_a_folder(tmp_path):
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "open\n"
        line = f"process {other.pid} is serving in it; wait for it to end, or name another folder"
        with pytest.raises(OutputError, match=line), ExchangeFolders(tmp_path).opened():
            raise AssertionError("both serve")
        other.communicate("")
